#include "failure.hpp"

#include <exception>
#include <new>
#include <stdexcept>

#include "commands.hpp"
#include "vbond/core/error.hpp"
#include "vbond/run/memory_needed.hpp"

namespace vbond::app {
namespace {

std::string out_of_memory() {
  return "memory has run out; there may be " + memory_limit_in_words() +
         "\n  vbond check CASE says what the time loop takes; take fewer particles, or another machine";
}

}  // namespace

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
