#include "vbond/observe/frame_files.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "vbond/core/id_list.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/bond_look.hpp"
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

/// Views take more room than all of a frame: they are made of some things at a time.
constexpr std::size_t at_once = 1 << 12;

/// The arrays of a file that quantities are, one value of each per point or cell.
template <class Quantity>
class Columns {
 public:
  Columns(std::span<const Quantity> quantities, const FrameFormat& format, UnitSystem units, VtpFile& file,
          bool per_point) {
    for (const Quantity& q : quantities) {
      if (!is_in(q.cases, format)) continue;
      std::visit(
          [&]<class T, class View>(T (*)(const View&)) {
            const char* unit = q.unit.in(units);
            columns_.push_back({&q, per_point ? &file.begin_point_data<T>(q.name, unit)
                                              : &file.begin_cell_data<T>(q.name, unit)});
          },
          q.value);
    }
  }
  template <class View>
  void append(const std::vector<View>& views) {
    for (const Column& c : columns_)
      std::visit(
          [&]<class T>(T (*value)(const View&)) {
            std::vector<T> values;
            values.reserve(views.size());
            for (const View& view : views) values.push_back(value(view));
            c.array->append(values);
          },
          c.quantity->value);
  }

 private:
  struct Column {
    const Quantity* quantity;
    VtpArray* array;
  };
  std::vector<Column> columns_;
};

/// Calls `use` with some ids of the list after the other.
template <class IdType, class Use>
void some_at_a_time(const IdList<IdType>& ids, const Use& use) {
  for (std::size_t first = 0; first < ids.size(); first += at_once) {
    std::vector<IdType> some;
    for (std::size_t k = first; k < std::min(first + at_once, ids.size()); ++k) some.push_back(ids[k]);
    use(some);
  }
}

/// Long integers where one of its numbers might need them.
FrameFormat with_room_for_numbers(FrameFormat format, const State& state) {
  constexpr auto most = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  format.long_integers = format.long_integers || state.r.size() + 2 * state.bonds.size() > most;
  return format;
}

/// These particles. Stress is looked for in the whole body. fragments: where bonds may break. beside: where
/// the file is going to be.
VtpFile file_of_particles(const IdList<ParticleId>& particles, const Model& model, const State& state,
                          const Fragments* fragments, const FrameFormat& format, const fs::path& beside) {
  PerParticle<Image> images;  // that stand in the cell
  if (format.wrap) images = images_in_cell(model, state);
  PerParticle<Tensor> stress;
  if (format.stress) stress = stress_times_volume(model, state);
  VtpFile f(VtpFile::Topology::verts, with_room_for_numbers(format, state), beside);
  f.set_unit_of_points(unit::length.in(model.units));
  if (const auto cell = frame_cell(model, state)) f.set_cell(*cell);
  Columns columns(particle_quantities(), format, model.units, f, true);
  std::int64_t points = 0;
  some_at_a_time(particles, [&](const std::vector<ParticleId>& some) {
    std::vector<Vec3d> places;
    std::vector<std::int64_t> each;
    std::vector<ParticleView> views;
    for (const ParticleId p : some) {
      ParticleView& of = views.emplace_back(ParticleView{model, state, p, fragments});
      if (format.wrap) of.image = images[p];
      if (format.stress) of.stress = symmetric_part(1.0 / sphere_volume(model, p) * stress[p]);
      places.push_back(format.wrap ? state.r[p] + to_image(state.cell, of.image) : state.r[p]);
      each.push_back(points++);
    }
    f.add_points(places);
    f.add_cells(each);
    columns.append(views);
  });
  return f;
}

/// These bonds between points, which are these particles, in increasing order. of_images: of a part of a body
/// the numbers that points of images have in a frame of the whole body; nullptr: this is the whole body.
VtpFile file_of_bonds(const IdList<BondId>& bonds, const IdList<ParticleId>& points, const BodyPart& body,
                      UnitSystem units, const FrameFormat& format, const fs::path& beside,
                      const std::vector<std::int64_t>* of_images = nullptr) {
  const State& state = body.state;
  VtpFile f(VtpFile::Topology::lines, with_room_for_numbers(format, state), beside);
  f.set_unit_of_points(unit::length.in(units));
  VtpArray* of = nullptr;  // particles, of the places of a periodic body
  if (!state.cell.empty()) of = &f.begin_point_data<std::int64_t>("particle");
  VtpArray* numbers = nullptr;  // of points
  if (of_images != nullptr) numbers = &f.begin_point_data<std::int64_t>(of == nullptr ? "particle" : "point");
  const auto add_points = [&](const std::vector<Vec3d>& places, const std::vector<std::int64_t>& particles) {
    f.add_points(places);
    if (of != nullptr) of->append(particles);
  };
  some_at_a_time(points, [&](const std::vector<ParticleId>& some) {
    std::vector<Vec3d> places;
    std::vector<std::int64_t> particles;
    for (const ParticleId p : some) places.push_back(state.r[p]), particles.push_back(p.value);
    add_points(places, particles);
    if (numbers != nullptr) numbers->append(particles);
  });
  if (numbers != nullptr) numbers->append(*of_images);

  const auto point_of = [&points](ParticleId p) -> std::int64_t {
    if (p.value < points.size() && points[p.value] == p) return p.value;
    return std::lower_bound(points.begin(), points.end(), p) - points.begin();
  };
  Columns columns(bond_quantities(), format, units, f, false);
  auto next_point = static_cast<std::int64_t>(points.size());  // images stand behind the particles
  some_at_a_time(bonds, [&](const std::vector<BondId>& some) {
    std::vector<std::int64_t> ends, particles;
    std::vector<Vec3d> images;
    std::vector<BondView> views;
    for (const BondId k : some) {
      const Bond& b = state.bonds[k];
      const bool to_an_image = !image_of_j(b).is_itself();
      ends.push_back(point_of(b.i));
      ends.push_back(to_an_image ? next_point++ : point_of(b.j));
      if (to_an_image) images.push_back(state.r[b.i] + between(state, b)), particles.push_back(b.j.value);
      views.push_back(bond_view(k, state, format.breaks));
      views.back().id = body.name(k);
    }
    add_points(images, particles);
    f.add_cells(ends);
    columns.append(views);
  });
  return f;
}

/// The numbers that the points of images have in a frame of the whole body, behind the particles: in the
/// order of bonds.
std::vector<std::int64_t> numbers_of_images(const IdList<BondId>& bonds, const BodyPart& body) {
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

/// These bonds of a part of a body, whose particles are these, with the numbers that its points have in a
/// frame of the whole body: those of images are given.
VtpFile file_of_bonds_of_part(const IdList<BondId>& bonds, const IdList<ParticleId>& particles,
                              const std::vector<std::int64_t>& of_images, const BodyPart& body,
                              UnitSystem units, const FrameFormat& format, const fs::path& beside) {
  std::vector<ParticleId> others, points;
  for (const BondId k : bonds) {
    const ParticleId j = body.state.bonds[k].j;
    if (!std::binary_search(particles.begin(), particles.end(), j)) others.push_back(j);
  }
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  points.reserve(particles.size() + others.size());
  std::merge(particles.begin(), particles.end(), others.begin(), others.end(), std::back_inserter(points));
  return file_of_bonds(bonds, points, body, units, format, beside, &of_images);
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
  const std::vector<ParticleId> without = left_out(state);
  IdList<ParticleId> shown;
  for (const ParticleId p : IdRange<ParticleId>(model.particles()))
    if (!std::binary_search(without.begin(), without.end(), p)) shown.push_back(p);
  std::optional<Fragments> fragments;
  if (format.breaks) fragments = find_fragments(model, state, without);
  file_of_particles(shown, model, state, fragments ? &*fragments : nullptr, format, path)
      .write(path, state.clock.time(), state.clock.step, load_factor);
}

void write_bonds_vtp(const fs::path& path, const State& state, UnitSystem units,
                     std::optional<double> load_factor, FrameFormat format) {
  file_of_bonds(IdList<BondId>::consecutive({}, state.bonds.size()),
                IdList<ParticleId>::consecutive({}, state.r.size()), state, units, format, path)
      .write(path, state.clock.time(), state.clock.step, load_factor);
}

void write_part(const fs::path& folder, int part, const Simulation& run, FrameFormat format) {
  const BodyPart own = run.part(Show::ends_of_broken);
  const State& state = own.state;
  const auto is_here = [&own](ParticleId p) { return own.has(p) && !is_absent(own.state, p); };
  IdList<ParticleId> particles;
  for (const ParticleId p : state.r.ids())
    if (is_here(p)) particles.push_back(p);
  IdList<BondId> bonds;
  for (const BondId k : state.bonds.ids())
    if (is_here(state.bonds[k].i)) bonds.push_back(k);
  const double time = state.clock.time();
  const std::int64_t step = state.clock.step;
  // before any file is made: a part that cannot do that would have the others wait
  std::optional<Fragments> fragments;
  if (format.breaks) fragments = find_fragments(run.model(), own, left_out(state));
  const std::vector<std::int64_t> of_images = numbers_of_images(bonds, own);
  const fs::path of_particles = folder / name_of_part("particles", step, part),
                 of_bonds = folder / name_of_part("bonds", step, part);
  {
    VtpFile file = file_of_particles(particles, run.model(), state, fragments ? &*fragments : nullptr,
                                     of_parts(format), of_particles);
    file.set_points_of_all_parts(static_cast<std::int64_t>(present(state)));
    file.write(of_particles, time, step);
  }
  file_of_bonds_of_part(bonds, particles, of_images, own, run.model().units, of_parts(format), of_bonds)
      .write(of_bonds, time, step);
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
  write(file_of_particles({}, model, {}, nullptr, format, {}), "particles");
  State empty;
  empty.cell = cell_at_start(model);
  write(file_of_bonds_of_part({}, {}, {}, empty, model.units, format, {}), "bonds");
}

}  // namespace vbond
