#include <cstdint>

#include "input.hpp"
#include "vbond/build/specimens/specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/page/page.hpp"

namespace {

using namespace vbond;

void show_history(const std::filesystem::path& file) {
  try {
    page::Report report;
    report.history = page::read_history(file);
    const std::optional<RunSummary> none;
    report.warnings = page::warnings({.summary = none,
                                      .history = report.history,
                                      .body = report.body,
                                      .units = UnitSystem::si,
                                      .stages = 1,
                                      .resume_command = "",
                                      .step = {},
                                      .files = {}});
    page::PageLimits few;
    few.history_rows = 20;
    page::report_page("<!-- run -->\n", report, few);
  } catch (const IoError&) {
  }
}

void read_points(const std::filesystem::path& file) {
  try {
    read_csv_specimen(file, {"fuzz.toml", 1, 1});
  } catch (const CaseError&) {
  }
}

}  // namespace

/// The first byte says whether the rest is a history.csv or points of a case.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto file =
      fuzz::put(fuzz::folder() / "forged.csv", {reinterpret_cast<const char*>(data) + 1, size - 1});
  (data[0] & 1U) ? show_history(file) : read_points(file);
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (!fuzz::seeds()) return 0;
  fuzz::add_seed(
      "history",
      "1step,time,U_L,balance_error,strained,snapped,\"axial_force.a,\"\"b\",displacement.all.x,"
      "reaction.all.fx,reaction.all.mx,load_factor\n"
      "0,0,1e-3,0,0,0,1,0,0,0,0.1\n10,0.5,2,1e-9,1,0,-1,-0.1,3,4,\n20,1,2,1e-2,1,1,-1,-0.1,3,4,0.2\n");
  fuzz::add_seed("points", "0# points\nx,y,z,radius,mass\n0,0,0,0.5,1\n1, +2e-1,-3,0.5,1\n");
  std::exit(0);
}
