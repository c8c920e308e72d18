#include "commands.hpp"
#include "fit_command.hpp"
#include "vbond/core/error.hpp"

namespace vbond::app {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& case_file, const char* rule) {
  throw CaseError(Problem{{case_file.string(), 0, 0},
                          "this vbond was built without statics",
                          rule,
                          "build with VBOND_STATICS=ON: docs/install.md"});
}

constexpr const char* constants = "elastic constants are found by its solvers";

}  // namespace

int homogenise(const RunOptions& options, const HomogeniseOptions&) {
  refuse(options.case_file, constants);
}

int calibrate_body(const RunOptions& options, const CalibrateOptions&, const std::string&) {
  refuse(options.case_file, constants);
}

int fit(const FitOptions& options) {
  refuse(options.case_file, "fits are searched by Ceres, which is built with it");
}

}  // namespace vbond::app
