#include "failure.hpp"

#include <exception>
#include <new>
#include <stdexcept>

#include "commands.hpp"
#include "memory.hpp"
#include "vbond/core/error.hpp"

namespace vbond::app {

Failure failure_under_way() {
  try {
    throw;
  } catch (const CaseError& e) {
    return {bad_input, e.what()};
  } catch (const std::invalid_argument& e) {  // the command line, or the environment: VBOND_SIMD
    return {bad_input, e.what()};
  } catch (const Diverged& e) {
    return {failed, std::string("the run went unphysical at ") + e.what()};
  } catch (const NoEquilibrium& e) {
    return {failed, e.what()};
  } catch (const IoError& e) {
    return {bad_io, e.what()};
  } catch (const std::bad_alloc&) {
    return {failed, out_of_memory(), true};
  } catch (const std::length_error&) {
    return {failed, out_of_memory(), true};
  } catch (const std::exception& e) {
    return {failed, std::string("internal error: ") + e.what(), true};
  }
}

}  // namespace vbond::app
