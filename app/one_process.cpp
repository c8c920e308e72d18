#include "processes.hpp"

namespace vbond::app {

const char* const program_name = "vbond";
const char* const program_note = "";

std::unique_ptr<Processes> start_processes(int& /*argc*/, char**& /*argv*/) {
  return nullptr;
}

}  // namespace vbond::app
