#include "vbond/observe/frame_files.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/detail/values_of.hpp"
#include "vbond/observe/frame_names.hpp"
#include "vbond/observe/in_cell.hpp"
#include "vbond/observe/vtp.hpp"
#include "vbond/physics/section.hpp"

namespace vbond {
namespace {

namespace fs = std::filesystem;

bool is_in(Only cases, const FrameFormat& format) {
  return cases == Only::everywhere || (cases == Only::breaks && format.breaks) ||
         (cases == Only::stress && format.stress) || (cases == Only::capsules && format.capsules) ||
         (cases == Only::flow && format.flow) || (cases == Only::cell && format.cell) ||
         (cases == Only::wrap && format.wrap && format.cell);
}

template <class IdType>
std::vector<IdType> all_of(std::size_t n) {
  std::vector<IdType> ids;
  ids.reserve(n);
  for (const IdType id : IdRange<IdType>(n)) ids.push_back(id);
  return ids;
}

std::vector<Vec3d> positions_of(const std::vector<ParticleId>& particles, const State& state) {
  std::vector<Vec3d> r;
  r.reserve(particles.size());
  for (const ParticleId p : particles) r.push_back(state.r[p]);
  return r;
}

/// These particles. Stress is looked for in the whole body. fragments: where bonds may break.
VtpFile file_of_particles(const std::vector<ParticleId>& particles, const Model& model, const State& state,
                          const Fragments* fragments, FrameFormat format) {
  PerParticle<Image> images;  // that stand in the cell
  if (format.wrap) images = images_in_cell(model, state);
  std::vector<Vec3d> places = positions_of(particles, state);
  if (format.wrap)
    for (std::size_t k = 0; k < places.size(); ++k) places[k] += to_image(state.cell, images[particles[k]]);
  VtpFile f = VtpFile::of_points(places, format);
  f.set_unit_of_points(unit::length.in(model.units));
  if (const auto cell = frame_cell(model, state)) f.set_cell(*cell);
  PerParticle<Tensor> stress;
  if (format.stress) stress = stress_times_volume(model, state);
  const auto view = [&](std::size_t k) {
    ParticleView of{model, state, particles[k], fragments};
    if (format.wrap) of.image = images[of.id];
    if (format.stress) of.stress = symmetric_part(1.0 / sphere_volume(model, of.id) * stress[of.id]);
    return of;
  };
  for (const ParticleQuantity& q : particle_quantities()) {
    if (!is_in(q.cases, format)) continue;
    std::visit(
        [&](const auto value) {
          f.add_point_data(q.name, values_of(particles.size(), view, value), q.unit.in(model.units));
        },
        q.value);
  }
  return f;
}

/// What a frame has of one quantity of bonds.
struct BondArray {
  const BondQuantity* of;
  std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::uint8_t>, std::vector<Image>>
      values;
};

/// Views take more room than all of a frame: they are made of some bonds at a time.
std::vector<BondArray> arrays_of(const std::vector<BondId>& bonds, const BodyPart& body, FrameFormat format) {
  constexpr std::size_t at_once = 1 << 12;
  std::vector<BondArray> arrays;
  for (const BondQuantity& q : bond_quantities()) {
    if (!is_in(q.cases, format)) continue;
    arrays.push_back({&q, {}});
    std::visit(
        [&]<class T>(T (*)(const BondView&)) {
          arrays.back().values.emplace<std::vector<T>>().reserve(bonds.size());
        },
        q.value);
  }
  std::vector<BondView> views;
  for (std::size_t first = 0; first < bonds.size(); first += at_once) {
    views.clear();
    for (std::size_t k = first; k < std::min(first + at_once, bonds.size()); ++k) {
      views.push_back(bond_view(bonds[k], body.state, format.breaks));
      views.back().id = body.name(bonds[k]);
    }
    for (BondArray& array : arrays)
      std::visit(
          [&]<class T>(T (*value)(const BondView&)) {
            auto& values = std::get<std::vector<T>>(array.values);
            for (const BondView& view : views) values.push_back(value(view));
          },
          array.of->value);
  }
  return arrays;
}

/// These bonds between points, which are these particles, in increasing order.
VtpFile file_of_bonds(const std::vector<BondId>& bonds, const std::vector<ParticleId>& points,
                      const BodyPart& body, UnitSystem units, FrameFormat format) {
  const State& state = body.state;
  const auto point_of = [&points](ParticleId p) -> std::int64_t {
    if (p.value < points.size() && points[p.value] == p) return p.value;
    return std::lower_bound(points.begin(), points.end(), p) - points.begin();
  };
  std::vector<std::int64_t> ends;
  std::vector<Vec3d> places = positions_of(points, state);
  std::vector<std::int64_t> of;  // particles, of the places of a periodic body
  if (!state.cell.empty())
    for (const ParticleId p : points) of.push_back(p.value);
  ends.reserve(2 * bonds.size());
  for (const BondId k : bonds) {
    const Bond& b = state.bonds[k];
    ends.push_back(point_of(b.i));
    if (image_of_j(b).is_itself()) {
      ends.push_back(point_of(b.j));
    } else {  // a line to the image, which stands behind the particles
      ends.push_back(static_cast<std::int64_t>(places.size()));
      places.push_back(state.r[b.i] + between(state, b));
      of.push_back(b.j.value);
    }
  }
  VtpFile f = VtpFile::of_lines(places, ends, format);
  f.set_unit_of_points(unit::length.in(units));
  if (!state.cell.empty()) f.add_point_data("particle", of);
  for (BondArray& array : arrays_of(bonds, body, format))
    std::visit(
        [&]<class T>(std::vector<T>& values) {
          f.add_cell_data(array.of->name, std::exchange(values, {}), array.of->unit.in(units));
        },
        array.values);
  return f;
}

/// The numbers that the points of images have in a frame of the whole body, behind the particles: in the
/// order of bonds.
std::vector<std::int64_t> numbers_of_images(const std::vector<BondId>& bonds, const BodyPart& body) {
  if (body.state.cell.empty()) return {};
  std::vector<BondId> here;
  for (const BondId k : bonds)
    if (!image_of_j(body.state.bonds[k]).is_itself()) here.push_back(body.name(k));
  std::vector<BondId> all = body.all.gather(here);
  std::sort(all.begin(), all.end());
  std::vector<std::int64_t> numbers;
  const auto first = static_cast<std::int64_t>(body.state.r.size());
  for (const BondId k : here)
    numbers.push_back(first + (std::lower_bound(all.begin(), all.end(), k) - all.begin()));
  return numbers;
}

/// The same of a part of a body, with the numbers that its points have in a frame of the whole body: those of
/// images are given.
VtpFile file_of_bonds_of_part(const std::vector<BondId>& bonds, std::vector<ParticleId> points,
                              const std::vector<std::int64_t>& of_images, const BodyPart& body,
                              UnitSystem units, FrameFormat format) {
  const State& state = body.state;
  for (const BondId k : bonds) points.push_back(state.bonds[k].j);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  VtpFile f = file_of_bonds(bonds, points, body, units, format);
  std::vector<std::int64_t> numbers;
  for (const ParticleId p : points) numbers.push_back(p.value);
  numbers.insert(numbers.end(), of_images.begin(), of_images.end());
  f.add_point_data(state.cell.empty() ? "particle" : "point", numbers);
  return f;
}

/// Numbers of one kind have one type in all parts, however large they are.
FrameFormat of_parts(FrameFormat format) {
  format.long_integers = true;
  return format;
}

}  // namespace

BondView bond_view(BondId id, const State& state, bool may_break) {
  const Bond& b = state.bonds[id];
  const BondPose<double> pose = bond_pose(b, state);
  const BondLoads<double> loads = bond_loads(state, id);
  const SectionLoads<double> section = section_loads(b, pose, loads);
  return {.bond = b,
          .id = id,
          .shape = bond_shape(state, id),
          .U = bond_energy(state, id),
          .axial_force = section.N,
          .shear_force = section.V,
          .moment_i = norm(loads.M_ij),
          .moment_j = norm(loads.M_ji),
          .bending_moment = section.M_b,
          .torque = section.M_t,
          .utilisation = may_break && !b.broken && can_break(b)
                             ? b.law->failure(b, pose, history_of_bond(state, id)).utilisation
                             : 0.0,
          .flowed = b.law->has_rules && b.law->remembers() && b.law->crack == nullptr
                        ? history_of_bond(state, id)
                        : no_history};
}

void write_particles_vtp(const fs::path& path, const Model& model, const State& state,
                         std::optional<double> load_factor, FrameFormat format) {
  std::vector<ParticleId> shown;
  const std::vector<ParticleId> all = all_of<ParticleId>(model.particles()), without = left_out(state);
  std::set_difference(all.begin(), all.end(), without.begin(), without.end(), std::back_inserter(shown));
  std::optional<Fragments> fragments;
  if (format.breaks) fragments = find_fragments(model, state, without);
  file_of_particles(shown, model, state, fragments ? &*fragments : nullptr, format)
      .write(path, state.clock.time(), state.clock.step, load_factor);
}

void write_bonds_vtp(const fs::path& path, const State& state, UnitSystem units,
                     std::optional<double> load_factor, FrameFormat format) {
  file_of_bonds(all_of<BondId>(state.bonds.size()), all_of<ParticleId>(state.r.size()), state, units, format)
      .write(path, state.clock.time(), state.clock.step, load_factor);
}

void write_part(const fs::path& folder, int part, const Simulation& run, FrameFormat format) {
  const BodyPart own = run.part(Show::ends_of_broken);
  const State& state = own.state;
  const auto is_here = [&own](ParticleId p) { return own.has(p) && !is_absent(own.state, p); };
  std::vector<ParticleId> particles;
  for (const ParticleId p : state.r.ids())
    if (is_here(p)) particles.push_back(p);
  std::vector<BondId> bonds;
  for (const BondId k : state.bonds.ids())
    if (is_here(state.bonds[k].i)) bonds.push_back(k);
  const double time = state.clock.time();
  const std::int64_t step = state.clock.step;
  // before any file is made: a part that cannot do that would have the others wait
  std::optional<Fragments> fragments;
  if (format.breaks) fragments = find_fragments(run.model(), own, left_out(state));
  const std::vector<std::int64_t> of_images = numbers_of_images(bonds, own);
  {
    VtpFile file =
        file_of_particles(particles, run.model(), state, fragments ? &*fragments : nullptr, of_parts(format));
    file.set_points_of_all_parts(static_cast<std::int64_t>(present(state)));
    file.write(folder / name_of_part("particles", step, part), time, step);
  }
  file_of_bonds_of_part(bonds, particles, of_images, own, run.model().units, of_parts(format))
      .write(folder / name_of_part("bonds", step, part), time, step);
  if (format.cell && part == 0)
    write_cell_vtp(folder / frame_name("cell", step), run.model(), state, {}, format);
}

void write_lists_of_parts(const fs::path& folder, int parts, const Model& model, std::int64_t step,
                          FrameFormat format) {
  format = of_parts(format);
  const auto write = [&](const VtpFile& empty, const char* kind) {
    std::vector<std::string> files;
    for (int part = 0; part < parts; ++part)
      files.push_back(fs::path(name_of_part(kind, step, part)).filename().string());
    empty.write_list(folder / name_of_parts(kind, step), files);
  };
  write(file_of_particles({}, model, {}, nullptr, format), "particles");
  State empty;
  empty.cell = cell_at_start(model);
  write(file_of_bonds_of_part({}, {}, {}, empty, model.units, format), "bonds");
}

}  // namespace vbond
