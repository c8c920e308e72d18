#pragma once
#include <cstddef>

#include "vbond/dynamics/bodies.hpp"

namespace vbond {

/// The force of a term on the particle of a row, from its place or those of others. Its work in a step is the
/// mean of the forces at both ends of the step, times the way: just what the two kicks give.
struct WorkingLoad {
  std::size_t row = 0;
  Vec3d force = {};  ///< since add()
  Vec3d force_before = {}, place_before = {};

  /// To be called before the particle moves.
  void begin_step(const Bodies& bodies) { force_before = force, place_before = bodies.pose[row].r; }
  void add(const Vec3d& F, Bodies& bodies) {
    force = F;
    bodies.load[row].F += F;
  }
  double work(const Bodies& bodies) const {
    return 0.5 * dot(force_before + force, between(place_before, bodies.pose[row].r));
  }
};

}  // namespace vbond
