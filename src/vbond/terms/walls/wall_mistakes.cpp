#include "vbond/terms/walls/wall_mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/model/periodic_cell.hpp"

namespace vbond {
namespace {

bool is_direction(const Vec3d& e) {
  return std::abs(norm(e) - 1.0) <= 1e-6;
}
bool is_size(double x) {
  return x > 0.0 && std::isfinite(x);
}

/// The first thing that is wrong with a shape; empty if nothing is.
struct ShapeMistake {
  std::string operator()(const PlaneWall& w) const {
    return of(w.point, w.normal, 1.0, "the normal must be a unit vector");
  }
  std::string operator()(const DiscWall& w) const {
    return of(w.centre, w.normal, w.radius, "the normal must be a unit vector");
  }
  std::string operator()(const CylinderWall& w) const {
    if (!(w.length > 0.0)) return fmt::format("the length is {}: it must be > 0, or infinite", w.length);
    return of(w.centre, w.axis, w.radius, "the axis must be a unit vector");
  }
  std::string operator()(const SphereWall& w) const { return of(w.centre, {0, 0, 1}, w.radius, ""); }
  std::string operator()(const MeshWall& w) const {
    const std::vector<Vec3d>& r = w.mesh.corners;
    if (w.mesh.triangles.empty()) return "the mesh has no triangles";
    if (!std::all_of(r.begin(), r.end(), [](const Vec3d& x) { return is_finite(x); }))
      return "the corners of the mesh must be finite";
    for (std::size_t k = 0; k < w.mesh.triangles.size(); ++k) {
      const auto& [a, b, c] = w.mesh.triangles[k];
      if (std::max({a, b, c}) >= r.size())
        return fmt::format("triangle {} has corners {}, {}, {}, and there are {}, counted from 0", k, a, b, c,
                           r.size());
      if (!has_area(r[a], r[b], r[c])) return fmt::format("triangle {} has no area", k);
    }
    return "";
  }

 private:
  static std::string of(const Vec3d& place, const Vec3d& e, double radius, const char* rule) {
    if (!is_finite(place)) return "its place must be finite";
    if (!is_direction(e)) return rule;
    return is_size(radius) ? "" : fmt::format("the radius is {}: it must be > 0", radius);
  }
};

class Lines {
 public:
  void require(bool holds, const std::string& who, const std::string& mistake) {
    if (!holds) list_.push_back(who + ": " + mistake);
  }
  std::vector<std::string> take() && { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

}  // namespace

std::vector<std::string> mistakes_in_walls(const Model& model) {
  Lines found;
  const std::size_t materials = std::max<std::size_t>(model.materials.size(), 1);
  for (const ContactMaterial& m : model.materials) {
    const std::string who = "material \"" + m.name + "\"";
    found.require(is_size(m.E), who, fmt::format("E is {}: it must be > 0", m.E));
    found.require(m.nu > -1.0 && m.nu <= 0.5, who, fmt::format("nu is {}: -1 < nu <= 0.5", m.nu));
  }
  if (!model.material.empty()) {
    found.require(
        model.material.size() == model.particles(), "the materials of particles",
        fmt::format("{} for {} particles: one for each, or none", model.material.size(), model.particles()));
    const auto most = *std::max_element(model.material.begin(), model.material.end());
    found.require(most < materials, "the materials of particles",
                  fmt::format("one is number {}, and there are {}, counted from 0", most, materials));
  }
  for (const Wall& w : model.walls) {
    const std::string who = "wall \"" + w.name + "\"";
    const std::string mistake = std::visit(ShapeMistake{}, w.shape);
    found.require(mistake.empty(), who, mistake);
    found.require(is_finite(w.centre), who, "its centre must be finite");
    found.require(
        w.material < materials, who,
        fmt::format("its material is number {}, and there are {}, counted from 0", w.material, materials));
    found.require(model.contact.law != ContactLaw::none, who,
                  "walls push by contacts, and contact.law is none");
  }
  return std::move(found).take();
}

namespace {

/// Calls look(drive, who, found) for each that is of a wall of the model.
template <class Look>
std::vector<std::string> look_at_drives(const Model& model, const std::vector<WallDrive>& drives,
                                        Look&& look) {
  Lines found;
  std::vector<char> driven(model.walls.size(), 0);
  for (const WallDrive& d : drives) {
    const std::string who = "the drive of wall \"" + d.wall + "\"";
    if (d.index >= driven.size()) {
      found.require(
          false, who,
          fmt::format("it is for wall {}, and there are {}, counted from 0", d.index, driven.size()));
      continue;
    }
    found.require(!std::exchange(driven[d.index], char{1}), who, "the wall has another drive in this stage");
    for (const Vec3d& x : {d.velocity, d.angular_velocity, d.pivot.value_or(Vec3d{}), d.amplitude})
      found.require(is_finite(x), who, "velocities, pivot and amplitude must be finite");
    look(d, who, found);
  }
  return std::move(found).take();
}

/// Of a periodic body: walls that are not the same through the faces of the cell, or that stand still while
/// it moves.
void look_at_walls_in_cell(const Model& model, const StageTerms& stage, bool cell_moves, Mistakes& found) {
  if (!model.cell.any()) return;
  found.require(!cell_moves || model.walls.empty(), "walls would stand still while the cell moves");
  for (const WallDrive& d : stage.walls)
    found.require(d.index >= model.walls.size() || may_turn_in_cell(model.walls[d.index].shape, d),
                  "wall \"" + d.wall + "\" turns, not about the axis that it is endless along");
}

}  // namespace

void WallsTerm::look_at_rest(const Model& model, const StaticStage& stage, Mistakes& found) {
  const bool moves = stage.kind == StageKind::equilibrium || stage.kind == StageKind::fracture;
  found.add(look_at_drives(model, stage.walls, [&](const WallDrive& d, const std::string& who, Lines& wrong) {
    wrong.require(moves, who, "walls move in stages of equilibrium and of fracture");
    wrong.require(d.factor.points.empty() && d.frequency == 0.0 && !d.servo, who,
                  "factor, oscillation and servo are for stages of motion");
  }));
  look_at_walls_in_cell(model, stage, stage.cell.any(), found);
}

void WallsTerm::look_at_motion(const Model& model, const Stage& stage, Mistakes& found) {
  found.add(look_at_drives(model, stage.walls, [](const WallDrive& d, const std::string& who, Lines& wrong) {
    wrong.require(d.frequency >= 0.0 && std::isfinite(d.frequency), who,
                  fmt::format("the frequency is {}: it must be >= 0", d.frequency));
    if (!d.servo) return;
    const WallDrive::Servo& s = *d.servo;
    wrong.require(is_direction(s.direction), who, "the direction of the servo must be a unit vector");
    wrong.require(std::isfinite(s.force), who, "the force of the servo must be finite");
    wrong.require(is_size(s.mass), who, fmt::format("the mass of the servo is {}: it must be > 0", s.mass));
    wrong.require(s.damping >= 0.0 && std::isfinite(s.damping), who,
                  fmt::format("the damping of the servo is {}: it must be >= 0", s.damping));
    wrong.require(s.fastest > 0.0, who, fmt::format("the largest speed is {}: it must be > 0", s.fastest));
  }));
  look_at_walls_in_cell(model, stage, stage.cell.any(), found);
  for (const WallDrive& d : stage.walls) {
    found.require_factor(d.factor, "the drive of wall \"" + d.wall + "\"");
    if (d.servo) found.require_factor(d.servo->factor, "the servo of wall \"" + d.wall + "\"");
  }
}

}  // namespace vbond
