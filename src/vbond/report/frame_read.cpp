#include "vbond/report/frame_read.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "vbond/core/error.hpp"
#include "vbond/report/detail/scanner.hpp"

namespace vbond {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t most_numbers =
    1'000'000'000;  // of particles: a damaged number asks for no more memory

/// The files that a list of parts names, as VtpFile::write_list has written it.
std::vector<fs::path> listed_parts(const fs::path& path) {
  const std::string text = read_all(path);
  Scanner s(text, path);
  const auto skip_arrays = [&s] {
    while (s.take("      <PDataArray ")) s.until('\n');
  };
  s.expect(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <PPolyData GhostLevel=\"0\">\n    <PPointData>\n");
  skip_arrays();
  s.expect("    </PPointData>\n    <PCellData>\n");
  skip_arrays();
  s.expect("    </PCellData>\n    <PPoints>\n");
  skip_arrays();
  s.expect("    </PPoints>\n");
  std::vector<fs::path> parts;
  while (s.take("    <Piece Source=\"")) {
    const fs::path file = s.until('"');
    if (file.empty() || file.filename() != file) s.refuse();  // all lie beside the list
    parts.push_back(path.parent_path() / file);
    s.expect("/>\n");
  }
  s.expect("  </PPolyData>\n</VTKFile>\n");
  if (!s.at_end() || parts.empty()) s.refuse();
  return parts;
}

}  // namespace

FrameInput::FrameInput(const fs::path& path) : path_(path) {
  if (path.extension() != ".pvtp") {
    files_.emplace_back(path);
    return;
  }
  std::set<fs::path> known;
  for (const fs::path& part : listed_parts(path)) {
    if (!known.insert(part).second) refuse("it names " + part.filename().string() + " twice");
    files_.emplace_back(part);
  }
  for (const VtpInput& f : files_)
    if (f.step() != step() || f.time() != time() || f.lines() != lines() || f.triangles())
      refuse("its parts are not of one frame");
  if (lines()) {
    // a bond's end may be a particle of another part; of periodic bodies points of images have numbers as
    // well
    const bool periodic = !files_.empty() && files_.front().has(Per::point, "point");
    points_ = places(Per::point, periodic ? "point" : "particle", false);
    cells_ = places(Per::cell, "id", true);
  } else {
    points_ = cells_ = places(Per::point, "id", true);  // each point is a cell
    for (const VtpInput& f : files_)
      if (f.points_of_all_parts().value_or(points_->count) != points_->count)
        refuse("particles are missing, as if a part were of another frame");
    for (const VtpInput& f : files_)
      if (f.cells() != f.points()) refuse("a part has particles that are not points");
  }
}

void FrameInput::refuse(const std::string& what) const {
  throw IoError(path_.string() + ": is damaged: " + what);
}

/// once: no two parts have the same number; what has numbers then follows in their order, and where bonds are
/// numbered there is no gap. Else numbers are places, of which some may be taken by nobody.
FrameInput::Places FrameInput::places(Per per, const char* numbers, bool once) const {
  std::vector<std::vector<std::int64_t>> all;
  std::size_t values = 0;
  for (const VtpInput& f : files_) values += all.emplace_back(f.integers(per, numbers)).size();
  Places to;
  std::size_t most = values;
  if (per == Per::point)  // particles that are not there leave gaps
    for (const std::vector<std::int64_t>& of_part : all)
      for (const std::int64_t id : of_part)
        if (id >= 0 && id < most_numbers) most = std::max(most, static_cast<std::size_t>(id) + 1);
  std::vector<char> taken(most, 0);
  for (const std::vector<std::int64_t>& of_part : all) {
    std::vector<std::size_t>& of = to.of.emplace_back();
    of.reserve(of_part.size());
    for (const std::int64_t id : of_part) {
      const auto k = static_cast<std::size_t>(id);
      if (id < 0 || k >= taken.size()) refuse("it has no place for the number " + std::to_string(id));
      if (once && taken[k] != 0) refuse("two of its parts have the number " + std::to_string(id));
      taken[k] = 1;
      to.count = std::max(to.count, k + 1);
      of.push_back(k);
    }
  }
  const auto numbered = std::count(taken.begin(), taken.end(), 1);
  if (per == Per::cell && numbered != static_cast<std::ptrdiff_t>(to.count))
    refuse("numbers are missing, as if a part were of another frame");
  if (!once || numbered == static_cast<std::ptrdiff_t>(to.count)) return to;
  std::vector<std::size_t> place(taken.size());
  to.count = 0;
  for (std::size_t k = 0; k < taken.size(); ++k) place[k] = to.count, to.count += taken[k] != 0;
  for (std::vector<std::size_t>& of_part : to.of)
    for (std::size_t& k : of_part) k = place[k];
  return to;
}

/// get: the values that the file of this index has, as many for each point or cell.
template <class Get>
auto FrameInput::put_together(Per per, const Get& get) const {
  if (!points_) return get(0);
  const Places& places = per == Per::point ? *points_ : *cells_;
  decltype(get(0)) all;
  for (std::size_t f = 0; f < files_.size(); ++f) {
    const auto values = get(f);
    const std::vector<std::size_t>& of = places.of[f];
    if (of.empty()) continue;
    const std::size_t each = values.size() / of.size();  // two for each bond, of its ends
    all.resize(each * places.count);
    for (std::size_t k = 0; k < values.size(); ++k) all[each * of[k / each] + k % each] = values[k];
  }
  return all;
}

bool FrameInput::has(Per per, const std::string& name) const {
  return std::all_of(files_.begin(), files_.end(), [&](const VtpInput& f) { return f.has(per, name); });
}

std::vector<double> FrameInput::scalars(Per per, const std::string& name) const {
  return put_together(per, [&](std::size_t f) { return files_[f].scalars(per, name); });
}
std::vector<Vec3d> FrameInput::vectors(Per per, const std::string& name) const {
  return put_together(per, [&](std::size_t f) { return files_[f].vectors(per, name); });
}
std::vector<Image> FrameInput::images(Per per, const std::string& name) const {
  return put_together(per, [&](std::size_t f) { return files_[f].images(per, name); });
}
std::vector<std::int64_t> FrameInput::integers(Per per, const std::string& name) const {
  return put_together(per, [&](std::size_t f) {
    std::vector<std::int64_t> values = files_[f].integers(per, name);
    if (!points_ || per != Per::end) return values;
    const std::vector<std::size_t>& ids = points_->of[f];
    for (std::int64_t& x : values) {
      if (x < 0 || static_cast<std::size_t>(x) >= ids.size()) refuse("a bond has impossible ends");
      x = static_cast<std::int64_t>(ids[static_cast<std::size_t>(x)]);
    }
    return values;
  });
}
std::vector<std::uint8_t> FrameInput::bytes(Per per, const std::string& name) const {
  return put_together(per, [&](std::size_t f) { return files_[f].bytes(per, name); });
}

}  // namespace vbond
