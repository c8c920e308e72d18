#pragma once
#include <cstdint>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// A contact as it stands: of two particles, of two fibres, or of a particle and a wall.
struct ListedContact {
  std::int64_t i = 0;      ///< particle; of a fibre the lower end of its bond
  std::int64_t j = -1;     ///< the other one; -1: it is a wall
  std::int64_t wall = -1;  ///< -1: none
  Vec3d from, to;          ///< centres, points on the axes of fibres, of a wall where it is touched  [length]
  double overlap = 0;      ///< that is felt; negative where adhesion holds on  [length]
  double radius = 0;       ///< of the area that touches: a = sqrt(R* overlap), or JKR's  [length]
  double normal_force = 0;  ///< damping included, repulsion positive  [force]
  double friction = 0;      ///< size of the force across the normal, damping included  [force]
  double slip = 0;  ///< that the spring of friction has taken up: its force over its stiffness  [length]
  Vec3d force;      ///< on i, all of it  [force]
  Image of_j{};     ///< which image of particle j
};

/// All contacts, by what state holds: those of particles in order of (i, j), then of fibres, then of walls in
/// order of (i, wall). Damping and friction are those of the last step; at rest there is none. For looks now
/// and then, not for a time loop.
std::vector<ListedContact> list_contacts(const Model& model, const State& state, bool at_rest = false);

}  // namespace vbond
