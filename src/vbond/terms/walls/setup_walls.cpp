#include "vbond/terms/walls/setup_walls.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/nearest.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/setup/mesh_file.hpp"
#include "vbond/setup/text_file.hpp"
#include "vbond/terms/walls/wall_touch.hpp"

namespace vbond {
namespace {

/// The place of a name in a list; if there is none, records it.
template <class Items>
std::optional<std::size_t> look_up(const Placed<std::string>& name, const Items& items, const char* kind,
                                   Problems& problems) {
  std::vector<std::string> known;
  for (const auto& item : items) known.push_back(item.name);
  const auto found = std::find(known.begin(), known.end(), name.value);
  if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
  const auto near = nearest_name(name.value, known);
  problems.add(name.place, fmt::format("there is no {} \"{}\"", kind, name.value),
               known.empty() ? fmt::format("the case has no [[{}]]", kind)
                             : fmt::format("the names of {}s are {}", kind, fmt::join(known, ", ")),
               near ? fmt::format("did you mean \"{}\"?", *near)
                    : fmt::format("use one of them, or define it: [[{}]]", kind));
  return std::nullopt;
}

/// In Model::materials; the first where none is named.
std::uint32_t material_of(const std::optional<Placed<std::string>>& name, const Model& model,
                          Problems& problems) {
  if (!name) return 0;
  return look_up_material(*name, model, problems).value_or(0);
}

/// The shape of a wall and the point that is its centre unless the case names another.
struct ShapeMaker {
  const Case& c;
  const WallSpec& spec;
  Built& built;
  Problems& problems;
  Vec3d centre{};

  Vec3d unit(const Vec3d& v, const char* what) const {
    if (norm(v) > 0.0) return normalised(v);
    problems.add(spec.place, fmt::format("{} of wall \"{}\" is zero", what, spec.name),
                 "it must point somewhere", fmt::format("use for instance {} = [0, 0, 1]", what));
    return {0, 0, 1};
  }
  /// Files do not say what unit their lengths have.
  void check_size(double size, const SourcePlace& place) const {
    constexpr double least = 1e-3;  // of the smallest particle
    const PerParticle<double>& R = built.model.radius;
    const double smallest = R.empty() ? 0.0 : *std::min_element(R.begin(), R.end());
    if (size < least * smallest)
      problems.add(
          place,
          fmt::format("wall \"{}\": the mesh is {:.3g} long, and the smallest particle has radius {:.3g}",
                      spec.name, size, smallest),
          "a mesh is not a thousand times smaller than a particle",
          "look at the unit of the file, and give scale");
  }
  WallShape operator()(const PlaneWallSpec& w) {
    centre = w.point;
    return PlaneWall{w.point, unit(w.normal, "normal")};
  }
  WallShape operator()(const DiscWallSpec& w) {
    centre = w.centre;
    return DiscWall{w.centre, unit(w.normal, "normal"), w.radius};
  }
  WallShape operator()(const CylinderWallSpec& w) {
    centre = w.centre;
    const double length = w.length.value_or(std::numeric_limits<double>::infinity());
    return CylinderWall{w.centre, unit(w.axis, "axis"), w.radius, length, w.side};
  }
  WallShape operator()(const SphereWallSpec& w) {
    centre = w.centre;
    return SphereWall{w.centre, w.radius, w.side};
  }
  WallShape operator()(const BoxWallSpec& w) {
    centre = 0.5 * (w.min + w.max);
    return MeshWall{box_mesh(w.min, w.max)};
  }
  WallShape operator()(const MeshWallSpec& w) {
    MeshFile file = read_mesh_file(beside_case(c.file, w.file.value), w.scale, w.shift, w.file.place);
    built.notes.push_back(
        fmt::format("wall \"{}\": {}: {}", spec.name, w.file.value.filename().string(), file.text()));
    const BoundingBox box = box_around(file.mesh.corners);
    centre = 0.5 * (box.low + box.high);
    check_size(box.diagonal(), w.file.place);
    return MeshWall{std::move(file.mesh)};
  }
};

/// The deepest overlap of a wall with a particle, as a part of the particle's radius.
struct Overlap {
  double part = 0;
  ParticleId particle;
  bool too_large = false;  ///< for the hollow wall
};

Overlap deepest_overlap(const WallSurface& surface, const Model& model) {
  Overlap worst;
  std::vector<WallTouch> touches;
  for (const ParticleId p : model.r_0.ids()) {
    const double R = model.radius[p];
    if (comes_in(model, p) || !surface.may_touch(model.r_0[p], R)) continue;
    touches.clear();
    surface.touches(model.r_0[p], R, touches);
    for (const WallTouch& t : touches) {
      if (t.curvature_1 * R <= -1.0) return {1.0 - t.distance / R, p, true};
      if (1.0 - t.distance / R > worst.part) worst = {1.0 - t.distance / R, p, false};
    }
  }
  return worst;
}

void check_stands_clear(const WallSpec& spec, const Wall& wall, const Model& model, Problems& problems) {
  constexpr double most = 0.5;
  const Overlap worst = deepest_overlap(WallSurface(wall.shape), model);
  const Vec3d& r = model.r_0.empty() ? Vec3d{} : model.r_0[worst.particle];
  if (worst.too_large)
    problems.add(spec.place,
                 fmt::format("wall \"{}\": particle {} with radius {:.6g} does not fit into it", spec.name,
                             worst.particle.value, model.radius[worst.particle]),
                 "particles must be smaller than a hollow wall", "use a larger radius of the wall");
  else if (worst.part > most)
    problems.add(
        spec.place,
        fmt::format("wall \"{}\" stands inside a specimen: it overlaps particle {} at ({:.6g}, {:.6g}, "
                    "{:.6g}) by {:.3g} of its radius",
                    spec.name, worst.particle.value, r.x, r.y, r.z, worst.part),
        fmt::format("at the start a wall overlaps no particle by more than {} of its radius", most),
        "move the wall or the specimen; a plane, cylinder or sphere may face the wrong way");
}

/// Numbers of a material or pair for which the contacts of the case have no form would do nothing.
void check_surface(const Surface& s, const ContactModel& c, const SourcePlace& place, const std::string& who,
                   Problems& problems) {
  const auto check = [&](bool used, const std::optional<double>& number, const char* name, const char* form) {
    if (!used && number.value_or(0.0) > 0.0)
      problems.add(place, fmt::format("{} of {} does nothing", name, who),
                   fmt::format("[contact] has no {}", form),
                   fmt::format("add {} to [contact], or remove it", form));
  };
  check(c.tangential != TangentialForm::none, s.friction, "friction", "tangential");
  check(c.rolling != RollingForm::none, s.rolling_friction, "rolling_friction", "rolling");
  check(c.rolling != RollingForm::none, s.twisting_friction, "twisting_friction", "rolling");
  check(c.adhesion != AdhesionForm::none, s.work_of_adhesion, "work_of_adhesion", "adhesion");
}

/// Forms of the contacts for which neither the case nor a material nor a pair has a number.
void check_forms(const Case& c, Problems& problems) {
  const auto given = [&c](std::optional<double> Surface::*number) {
    const auto has = [&](const auto& x) { return (x.surface.*number).has_value(); };
    return has(c.contact) || std::any_of(c.materials.begin(), c.materials.end(), has) ||
           std::any_of(c.contact_between.begin(), c.contact_between.end(), has);
  };
  const auto check = [&](bool used, bool number, const char* form, const char* name) {
    if (used && !number)
      problems.add({c.file, 0, 0}, fmt::format("contact.{} does nothing", form),
                   fmt::format("no {} is given in [contact], [[material]] or contact.between", name),
                   fmt::format("give {} (0 to go without it on purpose), or remove {}", name, form));
  };
  check(c.contact.tangential != TangentialForm::none, given(&Surface::friction), "tangential", "friction");
  check(c.contact.rolling != RollingForm::none,
        given(&Surface::rolling_friction) || given(&Surface::twisting_friction), "rolling",
        "rolling_friction or twisting_friction");
  check(c.contact.adhesion != AdhesionForm::none, given(&Surface::work_of_adhesion), "adhesion",
        "work_of_adhesion");
}

}  // namespace

std::optional<std::uint32_t> look_up_material(const Placed<std::string>& name, const Model& model,
                                              Problems& problems) {
  const auto found = look_up(name, model.materials, "material", problems);
  return found ? std::optional(static_cast<std::uint32_t>(*found)) : std::nullopt;
}

std::optional<std::size_t> look_up_wall(const Placed<std::string>& name, const Model& model,
                                        Problems& problems) {
  return look_up(name, model.walls, "wall", problems);
}

void add_materials(const Case& c, const std::vector<PlacedSpecimen>& specimens, Model& model,
                   Problems& problems) {
  for (const MaterialSpec& m : c.materials) model.materials.push_back({m.name, m.E, m.nu, m.surface});
  if (!model.materials.empty()) model.contact.E = c.materials[0].E, model.contact.nu = c.materials[0].nu;
  for (const MaterialSpec& m : c.materials)
    check_surface(m.surface, c.contact, m.place, "material \"" + m.name + "\"", problems);
  check_forms(c, problems);
  for (const ContactPairSpec& p : c.contact_between) {
    check_surface(p.surface, c.contact, p.place, "a pair of materials", problems);
    ContactPair pair{{0, 0}, p.surface};
    pair.materials[0] = material_of(p.material, model, problems);
    pair.materials[1] = material_of(p.with, model, problems);
    const auto same = [&pair](const ContactPair& other) {
      return std::is_permutation(pair.materials.begin(), pair.materials.end(), other.materials.begin());
    };
    if (std::any_of(model.contact.between.begin(), model.contact.between.end(), same))
      problems.add(p.place,
                   fmt::format("\"{}\" and \"{}\" are a pair of contact.between twice", p.material.value,
                               p.with.value),
                   "a pair has one entry", "put what both say into one");
    model.contact.between.push_back(pair);
  }
  for (const PlacedSpecimen& s : specimens) {
    const std::uint32_t material = material_of(s.spec->material, model, problems);
    if (model.materials.empty()) continue;
    for (std::size_t k = 0; k < s.points.r.size(); ++k) model.material.push_back(material);
  }
}

void add_walls(const Case& c, Built& built, Problems& problems) {
  const Model& model = built.model;
  if (!c.walls.empty() && model.contact.law == ContactLaw::none)
    problems.add(c.walls.front().place, fmt::format("wall \"{}\" without contacts", c.walls.front().name),
                 "walls push particles by the contact law, and the case has none",
                 "add [contact] with a law, for example law = \"hertz\"");
  for (const WallSpec& spec : c.walls) {
    try {
      ShapeMaker make{c, spec, built, problems};
      Wall wall;
      wall.name = spec.name;
      wall.shape = std::visit(make, spec.shape);
      if (!repeats_with_cell(wall.shape, model.cell))
        problems.add(
            spec.place, fmt::format("wall \"{}\" ends at a face of the cell", spec.name),
            "in a periodic body a wall is a plane along all periodic edges, or an endless cylinder around "
            "the only one",
            "leave the cell open across the wall: open = [\"c\"], or leave the wall out");
      wall.material = material_of(spec.material, model, problems);
      wall.centre = spec.moments_about.value_or(make.centre);
      check_stands_clear(spec, wall, model, problems);
      built.model.walls.push_back(std::move(wall));
    } catch (const CaseError& e) {
      problems.add(e);
    }
  }
}

}  // namespace vbond
