#include "processes.hpp"

namespace vbond::app {

const char* const program_name = "vbond";
const char* const program_note = "";
const bool has_ranks = false;

std::unique_ptr<Processes> start_processes(int& /*argc*/, char**& /*argv*/) {
  return std::make_unique<Processes>();
}

}  // namespace vbond::app
