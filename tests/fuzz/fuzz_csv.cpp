#include <cstdint>

#include "input.hpp"
#include "vbond/core/error.hpp"
#include "vbond/report/page.hpp"
#include "vbond/setup/specimens/specimen.hpp"

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

/// named: the case names the columns and has units for them.
void read_points(const std::filesystem::path& file, bool named) {
  CsvSpecimen spec{{file, {"fuzz.toml", 1, 1}}, {}, {}, 1, {}};
  if (named) {
    spec.columns[0] = "Points:0", spec.columns[1] = "Points:1", spec.columns[2] = "Points:2";
    spec.units[0] = ColumnUnit{"mm", 1e-3};
  }
  try {
    read_csv_specimen(spec);
  } catch (const CaseError&) {
  }
}

}  // namespace

/// The first byte says whether the rest is a history.csv or points of a case, which may name its columns.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto file =
      fuzz::put(fuzz::folder() / "forged.csv", {reinterpret_cast<const char*>(data) + 1, size - 1});
  (data[0] & 1U) ? show_history(file) : read_points(file, (data[0] & 2U) != 0);
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
  fuzz::add_seed("named",
                 "2\xEF\xBB\xBF\"Points:0\";\"Points:1\";\"Points:2\";\"a \"\"b\"\"\"\r\n0;1;2;\"x\ny\"\r\n");
  fuzz::add_seed("motion", "0x,y,z,vx,vy,vz,wx,wy,wz,qw,qx,qy,qz\n0,0,0,1,0,0,0,0,2,0.6,0,0.8,0\n");
  std::exit(0);
}
