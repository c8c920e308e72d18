#include "vbond/report/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "vbond/core/error.hpp"
#include "vbond/report/detail/raw_frame.hpp"

namespace vbond::page {
namespace {

using Per = FrameInput::Per;

constexpr std::uint8_t break_kinds = 6;

double component(const Vec3d& x, std::size_t c) {
  return c == 0 ? x.x : c == 1 ? x.y : x.z;
}

[[noreturn]] void refuse_other_bonds(const std::filesystem::path& path) {
  throw IoError(path.string() + ": its bonds are not those of the frames before it");
}

/// The particles at the ends of bonds, and which images of the second ones they join.
struct Ends {
  std::vector<std::int64_t> particle;         ///< i0, j0, i1, j1, ...
  std::vector<std::array<float, 3>> image{};  ///< of each bond, whole numbers; empty: none joins an image
};

std::array<double, 3> numbers_of(const Image& n) {
  return {double(n.a), double(n.b), double(n.c)};
}

[[noreturn]] void refuse_ends(const std::filesystem::path& path) {
  throw IoError(path.string() + ": is damaged: a bond has impossible ends");
}

/// Images have points behind those of the particles, which tell whose they are. With frames.wrap all that is
/// shown are images.
Ends ends_of_bonds(const FrameInput& particles, const FrameInput& bonds, const std::filesystem::path& path,
                   std::size_t all_particles) {
  Ends to{bonds.integers(Per::end, "connectivity")};
  const auto points = static_cast<std::int64_t>(bonds.points());
  for (const std::int64_t end : to.particle)
    if (end < 0 || end >= points) refuse_ends(path);
  if (!bonds.has(Per::cell, "image_j")) return to;
  const std::vector<std::int64_t> of = bonds.integers(Per::point, "particle");
  for (std::int64_t& end : to.particle) end = of[static_cast<std::size_t>(end)];
  std::vector<Image> shown(all_particles);
  if (particles.has(Per::point, "image")) {
    shown = particles.images(Per::point, "image");
    if (particles.points() != all_particles)
      spread(numbers_of_some(particles, all_particles), all_particles, shown);
  }
  const auto all = static_cast<std::int64_t>(shown.size());
  for (const Image& image_j : bonds.images(Per::cell, "image_j")) {
    const std::size_t b = to.image.size();
    const std::int64_t i = to.particle[2 * b], j = to.particle[2 * b + 1];
    if (i < 0 || i >= all || j < 0 || j >= all) refuse_ends(path);
    const std::array<double, 3> n = numbers_of(image_j), n_i = numbers_of(shown[static_cast<std::size_t>(i)]),
                                n_j = numbers_of(shown[static_cast<std::size_t>(j)]);
    std::array<float, 3>& image = to.image.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) image[k] = static_cast<float>(n[k] + n_i[k] - n_j[k]);
  }
  if (std::all_of(to.image.begin(), to.image.end(),
                  [](const auto& n) { return n == std::array<float, 3>{}; }))
    to.image.clear();
  return to;
}

/// The bonds that were there in the frames before must be there still, and join the same images.
void add_bonds(const FrameInput& in, const FrameInput& file, const std::filesystem::path& path, Body& body) {
  const auto [ends, images] = ends_of_bonds(in, file, path, body.radius.size());
  const auto particles = static_cast<std::int64_t>(body.radius.size());
  if (file.has(Per::cell, "capsule_radius")) {
    const std::vector<double> radius = file.scalars(Per::cell, "capsule_radius");
    for (std::size_t b = body.capsules.size(); b < radius.size(); ++b)
      body.capsules.push_back(as_float(radius[b], path));
  }
  for (std::size_t k = 0; k < ends.size(); ++k) {
    if (ends[k] < 0 || ends[k] >= particles) refuse_ends(path);
    if (k == body.bonds.size()) body.bonds.push_back(static_cast<std::uint32_t>(ends[k]));
    if (body.bonds[k] != static_cast<std::uint32_t>(ends[k])) refuse_other_bonds(path);
  }
  if (images.empty() && body.images.empty()) return;
  const std::size_t bonds = ends.size() / 2, known = body.images.size();
  body.images.resize(std::max(known, 3 * bonds), 0.0f);
  for (std::size_t b = 0; b < bonds; ++b) {
    const std::array<float, 3> now = images.empty() ? std::array<float, 3>{} : images[b];
    const auto at = body.images.begin() + static_cast<std::ptrdiff_t>(3 * b);
    if (3 * b >= known) std::copy(now.begin(), now.end(), at);
    if (!std::equal(now.begin(), now.end(), at)) refuse_other_bonds(path);
  }
}

struct Spans {
  std::array<Span, 3> displacement;
  Span speed;
  std::array<Span, bond_field_count> fields;

  void add(const RawFrame& f) {
    for (const Vec3d& d : f.displacement)
      for (std::size_t c = 0; c < 3; ++c) displacement[c].add(component(d, c));
    for (const double v : f.speed) speed.add(v);
    for (std::size_t k = 0; k < bond_field_count; ++k)
      for (const double x : f.fields[k]) fields[k].add(x);
  }
};

void note_first(const RawFrame& f, double time, const Body& body, std::uint8_t state, BondSighting& first) {
  if (first.bond >= 0) return;
  const auto at = std::find(f.range.begin(), f.range.end(), state);
  if (at == f.range.end()) return;
  const auto k = static_cast<std::size_t>(at - f.range.begin());
  first = {static_cast<std::int64_t>(k), body.bonds[2 * k], body.bonds[2 * k + 1], time};
}

QuantisedFrame quantise(const RawFrame& raw, double time, const Sequence& s) {
  QuantisedFrame q;
  q.step = raw.step;
  q.time = time;
  for (std::size_t c = 0; c < 3; ++c)
    for (const Vec3d& d : raw.displacement)
      q.displacement.push_back(quantised(s.displacement[c], component(d, c)));
  const auto bytes = [](const std::vector<double>& values, const Range& range) {
    std::vector<std::uint8_t> b;
    b.reserve(values.size());
    for (const double x : values) b.push_back(static_cast<std::uint8_t>(quantised(range, x)));
    return b;
  };
  if (s.speed.step > 0.0) q.speed = bytes(raw.speed, s.speed);
  for (std::size_t k = 0; k < bond_field_count; ++k)
    if (s.has_field(k)) q.fields[k] = bytes(raw.fields[k], s.fields[k]);
  q.range = raw.range;
  q.there = raw.there;
  if (!s.may_break) return q;
  q.broken = raw.broken;
  constexpr std::int64_t last = std::numeric_limits<std::uint16_t>::max();
  for (const std::int64_t number : raw.fragment)
    q.fragment.push_back(static_cast<std::uint16_t>(std::clamp<std::int64_t>(number, 0, last)));
  return q;
}

/// Both files of a frame, opened and held against the body.
struct OpenFrame {
  FrameInput particles, bonds;
  OpenFrame(const FrameFiles& files, const Body& body) : particles(files.particles), bonds(files.bonds) {
    bool known = particles.points() <= body.radius.size();
    if (known)
      for (const std::size_t p : numbers_of_some(particles, body.radius.size()))
        known = known && p < body.radius.size();
    if (!known || bonds.points() < particles.points() || particles.step() != bonds.step())
      throw IoError(files.bonds.string() + ": is not of the same body and step as " +
                    files.particles.string());
    if (!bonds.lines()) throw IoError(files.bonds.string() + ": is damaged: its cells are not bonds");
  }
};

/// The positions that displacements are from; a frame tells those of its particles.
std::vector<Vec3d> start_of(const SequenceFiles& files, const FrameFiles& frame) {
  const FrameInput first(frame.particles);
  std::vector<Vec3d> r = first.vectors(Per::point, "Points");
  if (files.kind == SequenceKind::mode) return r;
  const std::vector<Vec3d> moved = first.vectors(Per::point, "displacement");
  for (std::size_t p = 0; p < r.size(); ++p) r[p] = r[p] - moved[p];
  if (!first.cell() || !first.has(Per::point, "image")) return r;
  const auto& [a, b, c] = first.cell()->edges;
  const std::vector<Image> shown = first.images(Per::point, "image");
  for (std::size_t p = 0; p < r.size(); ++p)
    r[p] += double(shown[p].a) * a + double(shown[p].b) * b + double(shown[p].c) * c;
  return r;
}

/// The first frame tells them, but for particles that come in later.
std::vector<Vec3d> start_of(const SequenceFiles& files, std::size_t all) {
  std::vector<Vec3d> start(all);
  std::vector<char> known(all, 0);
  std::size_t left = all;
  for (const FrameFiles& frame : files.frames) {
    const std::vector<Vec3d> r = start_of(files, frame);
    if (r.size() == all && left == all) return r;
    const std::vector<std::size_t> numbers = numbers_of_some(FrameInput(frame.particles), all);
    for (std::size_t k = 0; k < r.size(); ++k) {
      const std::size_t p = numbers.empty() ? k : numbers[k];
      if (p < all && known[p] == 0) start[p] = r[k], known[p] = 1, --left;
    }
    if (left == 0) break;
  }
  return start;
}

/// The cell of a periodic body as the page holds it.
void add_cell(const FrameInput& particles, const std::filesystem::path& file, Sequence& s) {
  const std::optional<FrameCell>& cell = particles.cell();
  if (!cell) return;
  s.periodic = cell->periodic;
  for (const Vec3d& edge : cell->edges)
    for (std::size_t c = 0; c < 3; ++c) s.cell.push_back(as_float(component(edge, c), file));
  for (std::size_t c = 0; c < 3; ++c)
    s.cell.push_back(as_float(component(cell->corner, c) - s.origin[c], file));
}

void check_kinds(const RawFrame& raw, const std::filesystem::path& bonds) {
  const auto above = [](std::uint8_t most) { return [most](std::uint8_t x) { return x > most; }; };
  if (std::any_of(raw.range.begin(), raw.range.end(), above(2)))
    throw IoError(bonds.string() + ": is damaged: a bond is in no range");
  if (std::any_of(raw.broken.begin(), raw.broken.end(), above(break_kinds)))
    throw IoError(bonds.string() + ": is damaged: a bond broke in no way");
}

/// Sets s.may_break and s.flows.
Spans look_through(const SequenceFiles& files, const std::vector<Vec3d>* about, Body& body, Sequence& s) {
  Spans spans;
  s.may_break = s.flows = true;
  std::int64_t last_step = std::numeric_limits<std::int64_t>::min();
  for (const FrameFiles& f : files.frames) {
    const OpenFrame open(f, body);
    if (open.particles.step() < last_step)
      throw IoError(f.particles.string() + ": is of an earlier step than the frame before it");
    last_step = open.particles.step();
    add_bonds(open.particles, open.bonds, f.bonds, body);
    body.bonds_without_length = std::max(body.bonds_without_length, count_without_length(open.bonds));
    const RawFrame raw = read_frame(open.particles, open.bonds, about, body.radius.size());
    check_kinds(raw, f.bonds);
    s.may_break = s.may_break && tells_of_breaks(open.particles, open.bonds);
    s.flows = s.flows && tells_of_flow(open.bonds);
    try {
      spans.add(raw);
    } catch (const std::domain_error& e) {
      throw IoError(f.particles.string() + " or " + f.bonds.filename().string() + ": holds " + e.what());
    }
    if (files.kind == SequenceKind::mode) continue;  // says nothing about the run
    note_first(raw, f.time, body, 1, body.first_strained);
    note_first(raw, f.time, body, 2, body.first_snapped);
  }
  return spans;
}

/// Where particles come in or go no frame need have all of them: of a body without images the frame of bonds
/// has a point for each.
void read_radii(const std::vector<FrameFiles>& frames, Body& body) {
  const auto in_all = [](const FrameFiles& f) {
    return FrameInput(f.particles).points() == FrameInput(f.bonds).points();
  };
  bool some_absent = false;
  std::optional<std::size_t> in_first;
  for (const FrameFiles& f : frames) {
    const FrameInput particles(f.particles);
    const std::vector<double> radii = particles.scalars(Per::point, "radius");
    const std::vector<std::int64_t> ids = particles.integers(Per::point, "id");
    for (std::size_t k = 0; k < ids.size(); ++k) {
      if (ids[k] < 0 || ids[k] > 1'000'000'000)
        throw IoError(f.particles.string() + ": is damaged: a particle has no number");
      const auto p = static_cast<std::size_t>(ids[k]);
      if (p >= body.radius.size()) body.radius.resize(p + 1, 0.0f);
      body.radius[p] = as_float(radii[k], f.particles);
    }
    some_absent =
        some_absent || ids.size() != body.radius.size() || ids.size() != in_first.value_or(ids.size());
    in_first = in_first.value_or(ids.size());
    if (body.radius.size() == ids.size() && in_all(f)) break;
  }
  if (body.radius.empty()) throw IoError(frames.front().particles.string() + ": has no particles");
  // Bonds name particles, too, that came in and went between two frames: they have no radius, and are never
  // there.
  for (const FrameFiles& f : frames)
    if (const FrameInput bonds(f.bonds); some_absent && !bonds.has(Per::cell, "image_j"))
      body.radius.resize(std::max(body.radius.size(), bonds.points()), 0.0f);
}

/// Positions as floats from the middle of the body: far from zero floats have no digits left for its shape.
void put_reference(const std::vector<Vec3d>& start, const std::filesystem::path& file, Sequence& s) {
  for (std::size_t c = 0; c < 3; ++c) {
    Span span;
    for (const Vec3d& r : start) span.add(component(r, c));
    s.origin[c] = span.low + 0.5 * (span.high - span.low);
  }
  s.reference.reserve(3 * start.size());
  for (const Vec3d& r : start)
    for (std::size_t c = 0; c < 3; ++c) s.reference.push_back(as_float(component(r, c) - s.origin[c], file));
}

}  // namespace

std::vector<std::size_t> thinned(std::size_t n, std::size_t stride) {
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < n; k += stride) kept.push_back(k);
  if (n > 0 && kept.back() != n - 1) kept.push_back(n - 1);
  return kept;
}

Sequence read_sequence(const SequenceFiles& files, Body& body) {
  Sequence s{.kind = files.kind,
             .name = files.name,
             .note = files.note,
             .stage = files.stage,
             .origin = {},
             .reference = {},
             .displacement = {},
             .speed = {},
             .fields = {},
             .may_break = false,
             .frames = {}};
  if (files.frames.empty()) return s;
  const std::filesystem::path& first = files.frames[0].particles;
  if (body.radius.empty()) read_radii(files.frames, body);
  const std::vector<Vec3d> start = start_of(files, body.radius.size());
  try {
    put_reference(start, first, s);
  } catch (const std::domain_error& e) {
    throw IoError(first.string() + ": holds " + e.what());
  }

  const std::vector<Vec3d>* about = files.kind == SequenceKind::mode ? &start : nullptr;
  const Spans spans = look_through(files, about, body, s);
  for (std::size_t c = 0; c < 3; ++c)
    s.displacement[c] = range_of(spans.displacement[c], levels_of_16_bits, false);
  s.speed = range_of(spans.speed, levels_of_8_bits, false);
  for (std::size_t k = 0; k < bond_field_count; ++k)
    if (s.has_field(k)) s.fields[k] = range_of(spans.fields[k], levels_of_8_bits, bond_fields[k].is_signed);
  for (const FrameFiles& f : files.frames) {
    const OpenFrame open(f, body);
    s.frames.push_back(
        quantise(read_frame(open.particles, open.bonds, about, body.radius.size()), f.time, s));
    add_cell(open.particles, f.particles, s);
  }
  if (s.cell.size() != 12 * s.frames.size())
    s.cell.clear();  // earlier frames, of an earlier version, had none
  std::vector<std::filesystem::path> walls;
  for (const FrameFiles& f : files.frames) walls.push_back(f.walls);
  s.walls = read_walls(walls, s.origin);
  s.contacts = read_contacts(files.frames);
  return s;
}

std::size_t bytes_of_frame(const FrameFiles& files) {
  const FrameInput particles(files.particles), bonds(files.bonds);
  const bool may_break = tells_of_breaks(particles, bonds);
  const std::size_t all = std::max(particles.points(), bonds.points());
  return (may_break ? 9 : 7) * all +
         ((may_break ? fields_with_breaks + 2 : fields_of_all_runs + 1) +
          (tells_of_flow(bonds) ? bond_field_count - fields_with_breaks : 0)) *
             bonds.cells() +
         bytes_of_contacts(files, all);
}

}  // namespace vbond::page
