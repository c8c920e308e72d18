#include <cstdint>

#include "body.hpp"
#include "input.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/page/page.hpp"
#include "vbond/observe/vtp.hpp"

namespace {

using namespace vbond;
using fuzz::folder;

page::FrameFiles good_frame(std::int64_t step) {
  fuzz::SmallBody body;
  body.state.clock.step = body.state.clock.stage_step = step;
  page::FrameFiles f{0.1 * static_cast<double>(step), folder() / ("p" + std::to_string(step) + ".vtp"),
                     folder() / ("b" + std::to_string(step) + ".vtp")};
  write_particles_vtp(f.particles, body.model, body.state);
  write_bonds_vtp(f.bonds, body.state, UnitSystem::reduced);
  return f;
}

/// Reads two frames and makes their page, as `vbond report` does.
void show(const std::vector<page::FrameFiles>& frames, page::SequenceKind kind) {
  try {
    page::Report report;
    report.sequences.push_back(page::read_sequence({kind, "Run", "", "", frames}, report.body));
    report.stage_of_frame.assign(frames.size(), "");
    page::report_page("<!-- run -->\n", report, {});
  } catch (const IoError&) {
  }
}

}  // namespace

/// The first byte says which file of which frame, of a run or of a mode, the rest takes the place of.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const std::vector<page::FrameFiles> good{good_frame(0), good_frame(4)};
  std::vector<page::FrameFiles> frames = good;
  page::FrameFiles& forged = frames[data[0] >> 1U & 1U];
  ((data[0] & 1U) ? forged.bonds : forged.particles) =
      fuzz::put(folder() / "forged.vtp", {reinterpret_cast<const char*>(data) + 1, size - 1});
  show(frames, (data[0] & 4U) ? page::SequenceKind::mode : page::SequenceKind::run);
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (!fuzz::seeds()) return 0;
  for (const unsigned char which : {0, 1, 2, 3, 7}) {
    const page::FrameFiles f = good_frame((which & 2U) ? 4 : 0);
    fuzz::add_seed(
        "frame_" + std::to_string(which),
        std::string(1, static_cast<char>(which)) + fuzz::content_of((which & 1U) ? f.bonds : f.particles));
  }
  VtpFile elsewhere = VtpFile::of_lines(std::vector<Vec3d>(3), {0, 1, 1, 2});
  elsewhere.add_point_data("U_T", std::vector<double>(3));  // three values for two bonds
  for (const char* name : {"elongation", "length_at_rest", "bend", "twist", "U_L", "U_B"})
    elsewhere.add_cell_data(name, std::vector<double>(2));
  elsewhere.add_cell_data("range", std::vector<std::uint8_t>(2));
  elsewhere.write(folder() / "elsewhere.vtp", 0.4, 4);
  fuzz::add_seed("elsewhere", '\3' + fuzz::content_of(folder() / "elsewhere.vtp"));
  std::exit(0);
}
