#include "vbond/observe/frames.hpp"

#include <fmt/format.h>
#include <sys/types.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frame_names.hpp"
#include "vbond/observe/in_cell.hpp"
#include "vbond/terms/walls/output_wall_triangles.hpp"

namespace vbond {
namespace {

namespace fs = std::filesystem;

constexpr const char* pvd_head =
    "<?xml version=\"1.0\"?>\n"
    "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n";
constexpr const char* pvd_tail = "  </Collection>\n</VTKFile>\n";

/// The entries of a .pvd of ours up to a step, and the last step among them.
struct Entries {
  std::string lines;
  std::int64_t last_step = -1;
};
Entries entries_until(const fs::path& pvd, std::int64_t resume_step) {
  const std::string content = read_all(pvd);
  if (content.compare(0, std::string_view(pvd_head).size(), pvd_head) != 0)
    throw IoError(pvd.string() + ": was not written by vbond, so it cannot be continued");
  Entries kept;
  constexpr std::string_view file_is = "file=\"";
  std::size_t at = std::string_view(pvd_head).size();
  for (std::size_t end; (end = content.find('\n', at)) != std::string::npos; at = end + 1) {
    const std::string_view line = std::string_view(content).substr(at, end - at);
    const std::size_t name = line.find(file_is);
    if (name == std::string_view::npos) break;  // the tail
    const std::string_view rest = line.substr(name + file_is.size());
    const auto step = step_of_frame(fs::path(rest.substr(0, rest.find('"'))).filename().string());
    if (!step) throw IoError(pvd.string() + ": is damaged at \"" + std::string(line) + '"');
    if (*step > resume_step) break;
    kept.lines += std::string(line) + '\n';
    kept.last_step = *step;
  }
  return kept;
}

void remove_frames_after(const fs::path& folder, std::int64_t resume_step) {
  std::error_code error;
  std::vector<fs::path> late;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const auto step = step_of_frame(entry.path().filename().string());
    if (step && *step > resume_step) late.push_back(entry.path());
  }
  for (const fs::path& path : late)
    if (!fs::remove(path, error) || error)
      throw IoError("cannot remove " + path.string() + ": " + error.message());
}

constexpr std::string_view dump_item = "ITEM: TIMESTEP\n";

/// The step of the frame whose item begins at this place of a text; nothing if its line is not whole.
std::optional<std::int64_t> step_at(std::string_view text, std::size_t item) {
  text.remove_prefix(item + dump_item.size());
  std::int64_t step = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), step);
  if (error != std::errc{} || end == text.data() + text.size() || *end != '\n') return std::nullopt;
  return step;
}

std::string read_part(std::FILE* f, std::uintmax_t from, std::uintmax_t to, const fs::path& path) {
  std::string part(static_cast<std::size_t>(to - from), '\0');
  if (fseeko(f, static_cast<off_t>(from), SEEK_SET) != 0 ||
      std::fread(part.data(), 1, part.size(), f) != part.size()) {
    require_read(f, path);
    throw IoError("cannot read " + path.string() + ": it is shorter than it was");
  }
  return part;
}

/// Where the first frame after a step begins: sought from the end, block by block, since a dump may be larger
/// than memory. Without such a frame it is where the last line ends: a line cut short by a kill belongs to a
/// frame that is later than any checkpoint.
std::uintmax_t end_of_dump(const fs::path& dump, std::uintmax_t size, std::int64_t resume_step) {
  constexpr std::uintmax_t block = 1 << 20;
  constexpr std::uintmax_t overlap = 64;  // an item and its number, which two blocks may share
  const File f = open_file(dump, "rb");
  std::optional<std::uintmax_t> late, last_line;
  for (std::uintmax_t to = size, from = size; from > 0; to = from) {
    from = to > block ? to - block : 0;
    const std::string text = read_part(f.get(), from, std::min(to + overlap, size), dump);
    if (const std::size_t n = text.rfind('\n'); !last_line && n != std::string::npos)
      last_line = from + n + 1;
    std::size_t at = text.size();
    while (at > 0 && (at = text.rfind(dump_item, at - 1)) != std::string::npos) {
      const std::optional<std::int64_t> step = step_at(text, at);
      if (step && *step <= resume_step) return late.value_or(last_line.value_or(0));
      late = from + at;
    }
  }
  return 0;  // not one frame is early enough
}

void cut_dump(const fs::path& dump, std::int64_t resume_step) {
  std::error_code error;
  if (!fs::exists(dump, error)) return;
  const std::uintmax_t size = fs::file_size(dump, error);
  if (error) throw IoError("cannot read " + dump.string() + ": " + error.message());
  if (const std::uintmax_t end = end_of_dump(dump, size, resume_step); end < size) cut_file(dump, end);
}

}  // namespace

std::string pvd_list(const std::string& entries) {
  return pvd_head + entries + pvd_tail;
}

std::string pvd_entry(double time, const std::string& file) {
  return fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", time, file);
}

FrameWriter::FrameWriter(const fs::path& folder, bool lammps_dump, std::optional<std::int64_t> resume_step,
                         FrameFormat format, bool writes_all)
    : folder_(folder), format_(format), dumps_(lammps_dump), writes_all_(writes_all) {
  if (!writes_all_) return;
  const fs::path dump = folder_ / "dump.lammpstrj";
  std::error_code e;
  make_folder(folder_ / "frames");
  if (resume_step && fs::exists(folder_ / "particles.pvd", e)) {  // else frames were asked for later on
    keep_until(*resume_step);
  } else {
    write_lists();
  }
  if (resume_step) cut_dump(dump, *resume_step);
  if (lammps_dump) dump_.emplace(dump, resume_step ? GrowingFile::Begin::at_end : GrowingFile::Begin::anew);
}

void FrameWriter::keep_until(std::int64_t resume_step) {
  Entries particles = entries_until(folder_ / "particles.pvd", resume_step);
  Entries bonds = entries_until(folder_ / "bonds.pvd", resume_step);
  if (particles.last_step != bonds.last_step)
    throw IoError((folder_ / "particles.pvd").string() + " and bonds.pvd do not list the same frames");
  particle_entries_ = std::move(particles.lines);
  bond_entries_ = std::move(bonds.lines);
  std::error_code e;  // a run of an earlier version has no list of walls
  if (fs::exists(folder_ / "walls.pvd", e))
    wall_entries_ = entries_until(folder_ / "walls.pvd", resume_step).lines;
  if (fs::exists(folder_ / "contacts.pvd", e))
    contact_entries_ = entries_until(folder_ / "contacts.pvd", resume_step).lines;
  if (fs::exists(folder_ / "cell.pvd", e))
    cell_entries_ = entries_until(folder_ / "cell.pvd", resume_step).lines;
  last_step_ = particles.last_step;
  write_lists();  // before the frames go: no list ever names a frame that is not there
  remove_frames_after(folder_ / "frames", resume_step);
}

void FrameWriter::write_lists() const {
  replace_file(folder_ / "particles.pvd", pvd_list(particle_entries_), Sync::none);
  replace_file(folder_ / "bonds.pvd", pvd_list(bond_entries_), Sync::none);
  if (format_.walls) replace_file(folder_ / "walls.pvd", pvd_list(wall_entries_), Sync::none);
  if (format_.contacts) replace_file(folder_ / "contacts.pvd", pvd_list(contact_entries_), Sync::none);
  if (format_.cell) replace_file(folder_ / "cell.pvd", pvd_list(cell_entries_), Sync::none);
}

void FrameWriter::write(const Model& model, const State& state, std::optional<double> load_factor) {
  if (!writes_all_) return;
  const Clock& clock = state.clock;
  write_particles_vtp(folder_ / frame_name("particles", clock.step), model, state, load_factor, format_);
  std::optional<State> wrapped;
  if (format_.wrap && !state.cell.empty()) wrapped = shown_by_images(state, images_in_cell(model, state));
  write_bonds_vtp(folder_ / frame_name("bonds", clock.step), wrapped ? *wrapped : state, model.units,
                  load_factor, format_);
  if (format_.walls)
    write_walls_vtp(folder_ / frame_name("walls", clock.step), model, state, load_factor, format_);
  if (format_.contacts)
    write_contacts_vtp(folder_ / frame_name("contacts", clock.step), model, state, load_factor, format_);
  if (format_.cell)
    write_cell_vtp(folder_ / frame_name("cell", clock.step), model, state, load_factor, format_);
  if (dump_) dump_->append(lammps_frame(model, state, format_));
  add_to_lists(clock, frame_name);
}

void FrameWriter::write(const Simulation& run) {
  const Communicator& all = run.processes();
  if (all.ranks() == 1 || dumps_ || format_.stress || format_.contacts || format_.wrap)
    return write(run.model(), run.state());
  const Clock& clock = run.clock();
  all.together([&] { write_part(folder_, all.rank(), run, format_); });
  const BoundingBox body = format_.walls ? body_at_start(run.model(), all) : BoundingBox{};
  if (!writes_all_) return;
  write_lists_of_parts(folder_, all.ranks(), run.model(), clock.step, format_);
  if (format_.walls) {
    State walls;
    walls.clock = clock;
    walls.walls = run.walls();
    write_walls_vtp(folder_ / frame_name("walls", clock.step), run.model(), walls, {}, format_, body);
  }
  add_to_lists(clock, name_of_parts);
}

void FrameWriter::add_to_lists(const Clock& clock, std::string (*name)(const char* kind, std::int64_t step)) {
  particle_entries_ += pvd_entry(clock.time(), name("particles", clock.step));
  bond_entries_ += pvd_entry(clock.time(), name("bonds", clock.step));
  if (format_.walls) wall_entries_ += pvd_entry(clock.time(), frame_name("walls", clock.step));
  if (format_.contacts) contact_entries_ += pvd_entry(clock.time(), frame_name("contacts", clock.step));
  if (format_.cell) cell_entries_ += pvd_entry(clock.time(), frame_name("cell", clock.step));
  write_lists();
  last_step_ = clock.step;
}

}  // namespace vbond
