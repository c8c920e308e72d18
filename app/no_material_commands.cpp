#include "commands.hpp"
#include "vbond/core/error.hpp"

namespace vbond::app {
namespace {

[[noreturn]] void refuse(const RunOptions& options) {
  throw CaseError(Problem{{options.case_file.string(), 0, 0},
                          "this vbond was built without statics",
                          "elastic constants are found by its solvers",
                          "build with VBOND_STATICS=ON: docs/install.md"});
}

}  // namespace

int homogenise(const RunOptions& options, const HomogeniseOptions&) {
  refuse(options);
}

int calibrate_body(const RunOptions& options, const CalibrateOptions&, const std::string&) {
  refuse(options);
}

}  // namespace vbond::app
