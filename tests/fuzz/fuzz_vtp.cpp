#include <cstdint>

#include "body.hpp"
#include "input.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/vtp.hpp"
#include "vbond/report/frame_read.hpp"
#include "vbond/report/page.hpp"

namespace {

using namespace vbond;
using fuzz::folder;

page::FrameFiles good_frame(std::int64_t step, bool periodic = false) {
  fuzz::SmallBody body;
  FrameFormat format;
  if (periodic) {
    body.model.cell = {{Vec3d{4, 0, 0}, {1, 4, 0}, {0, 0, 4}}, {true, true, false}, {-1, -1, -1}, true};
    body.state.cell = cell_at_start(body.model);
    set_image_of_j(body.state.bonds[BondId{0}], {0, 1, 0});
    format.cell = format.wrap = true;
  }
  body.state.clock.step = body.state.clock.stage_step = step;
  const std::string name = (periodic ? "periodic" : "") + std::to_string(step) + ".vtp";
  page::FrameFiles f{0.1 * static_cast<double>(step), folder() / ("p" + name), folder() / ("b" + name)};
  f.contacts = folder() / ("c" + name);
  write_particles_vtp(f.particles, body.model, body.state, {}, format);
  write_bonds_vtp(f.bonds, body.state, UnitSystem::reduced, {}, format);
  VtpFile contacts = VtpFile::of_lines({body.state.r[ParticleId{0}], body.state.r[ParticleId{1}]}, {0, 1});
  for (const char* name : {"i", "j"}) contacts.add_cell_data(name, std::vector<std::int64_t>{name[0] - 'i'});
  contacts.add_cell_data("normal_force", std::vector<double>{1.5});
  contacts.write(f.contacts, f.time, step);
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

/// What the Python module reads, of a file that may be taken for one of particles or of bonds.
void read_all_of(const std::filesystem::path& file) {
  using Per = FrameInput::Per;
  for (const Per per : {Per::point, Per::cell, Per::end}) try {
      const FrameInput in(file);
      in.integers(per, per == Per::end ? "connectivity" : "id");
      if (in.has(per, "bend")) in.scalars(per, "bend");
    } catch (const IoError&) {
    }
}

}  // namespace

/// A list of parts that names this file alone.
std::filesystem::path list_of(const std::filesystem::path& part) {
  VtpFile::of_points({}).write_list(folder() / "forged.pvtp", {part.filename().string()});
  return folder() / "forged.pvtp";
}

/// The first byte says which file of which frame, of a run or of a mode, the rest takes the place of, as it
/// is or as a part; contacts as it is; whether the body is periodic.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const std::vector<page::FrameFiles> good{good_frame(0), good_frame(4)},
      periodic{good_frame(0, true), good_frame(4, true)};
  std::vector<page::FrameFiles> frames = (data[0] & 32U) ? periodic : good;
  page::FrameFiles& frame = frames[data[0] >> 1U & 1U];
  const auto forged = fuzz::put(folder() / "forged.vtp", {reinterpret_cast<const char*>(data) + 1, size - 1});
  if (data[0] & 16U)
    frame.contacts = forged;
  else
    ((data[0] & 1U) ? frame.bonds : frame.particles) = (data[0] & 8U) ? list_of(forged) : forged;
  if (!(data[0] & 16U)) read_all_of((data[0] & 1U) ? frame.bonds : frame.particles);
  show(frames, (data[0] & 4U) ? page::SequenceKind::mode : page::SequenceKind::run);
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (!fuzz::seeds()) return 0;
  for (const unsigned char which : {0, 1, 2, 3, 7, 8, 10}) {
    const page::FrameFiles f = good_frame((which & 2U) ? 4 : 0);
    fuzz::add_seed(
        "frame_" + std::to_string(which),
        std::string(1, static_cast<char>(which)) + fuzz::content_of((which & 1U) ? f.bonds : f.particles));
  }
  fuzz::add_seed("periodic_particles", ' ' + fuzz::content_of(good_frame(0, true).particles));
  fuzz::add_seed("periodic_bonds", '!' + fuzz::content_of(good_frame(0, true).bonds));
  fuzz::add_seed("contacts", '\20' + fuzz::content_of(good_frame(0).contacts));
  VtpFile part = VtpFile::of_lines(std::vector<Vec3d>(3), {0, 1, 1, 2}), elsewhere = part;
  part.add_point_data("particle", std::vector<std::int64_t>{1, 0, 2});
  part.add_cell_data("id", std::vector<std::int64_t>{1, 0});
  for (const char* name : {"elongation", "length_at_rest", "bend", "twist", "U_L", "U_B", "U_T"})
    part.add_cell_data(name, std::vector<double>(2));
  part.add_cell_data("range", std::vector<std::uint8_t>(2));
  part.write(folder() / "part.vtp", 0.4, 4);
  fuzz::add_seed("part", '\13' + fuzz::content_of(folder() / "part.vtp"));
  elsewhere.add_point_data("U_T", std::vector<double>(3));  // three values for two bonds
  for (const char* name : {"elongation", "length_at_rest", "bend", "twist", "U_L", "U_B"})
    elsewhere.add_cell_data(name, std::vector<double>(2));
  elsewhere.add_cell_data("range", std::vector<std::uint8_t>(2));
  elsewhere.write(folder() / "elsewhere.vtp", 0.4, 4);
  fuzz::add_seed("elsewhere", '\3' + fuzz::content_of(folder() / "elsewhere.vtp"));
  std::exit(0);
}
