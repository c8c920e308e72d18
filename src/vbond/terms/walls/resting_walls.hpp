#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/terms/walls/wall_touch.hpp"

namespace vbond {

/// A place where a particle touches a wall, as both stand.
struct RestingTouch {
  ParticleId p;
  std::uint32_t wall = 0;
  Vec3d normal;               ///< unit vector from the wall to the particle
  double distance = 0;        ///< of the particle's centre  [length]
  double overlap = 0;         ///< > 0; NaN if the particle does not fit into the hollow wall  [length]
  double force = 0;           ///< on the particle along the normal  [force]
  double energy = 0;          ///< [energy]
  bool hollow = false;        ///< the wall is, here
  double reduced_radius = 0;  ///< of the two; NaN if the particle does not fit  [length]
};

/// Force on a particle and its derivatives by the particle's place, row by row.
struct ForceSlope {
  Vec3d force;                               ///< [force]
  std::array<std::array<double, 3>, 3> d{};  ///< [force/length]
};

/// What walls do to particles by the positions of both alone: the repulsion of [contact] along the normal,
/// without friction, damping and memory. Surfaces, radii and forces are those of dynamics.
class RestingWalls {
 public:
  /// Keeps a reference to the model.
  explicit RestingWalls(const Model& model);
  RestingWalls(const Model&&) = delete;

  bool any() const { return !surfaces_.empty(); }
  bool has_two_sides(std::size_t wall) const { return surfaces_[wall].has_two_sides(); }
  /// All touches, particle by particle, and for each wall by wall.
  std::vector<RestingTouch> touches(const State& state) const;
  /// The same, and what would be touches if all particles were larger by this; these have no force.
  std::vector<RestingTouch> near(const State& state, double farther) const;
  /// Places of one wall nearer than this to a point, in the world.
  std::vector<WallTouch> near(const State& state, std::uint32_t wall, const Vec3d& r, double reach) const;
  /// What one wall does to a particle that touches it.
  ForceSlope slope(const State& state, ParticleId p, std::uint32_t wall) const;
  double energy(const State& state) const;  ///< [energy]

 private:
  const Model& model_;
  std::vector<WallSurface> surfaces_;
  TouchForms forms_;
  std::vector<std::vector<TouchNumbers<double>>> numbers_;  // of each wall, with each material
};

/// What the state remembers of a touch, of the same place: a memory is of the positions of now.
PairHistory memory_of(const State& state, const RestingTouch& touch);

/// Where a wall is: as the state says, or as at the start if that says nothing.
inline WallState wall_of(const State& state, std::size_t wall) {
  return wall < state.walls.size() ? state.walls[wall] : WallState{};
}

}  // namespace vbond
