#pragma once
#include <vector>

#include "vbond/dynamics/order.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Particles and where they are.
struct Places {
  std::vector<ParticleId> of;
  std::vector<Vec3d> r;
};
/// All that are present.
Places present_places(const State& state);

/// Of the bonds that are not broken: how far second ends may be.  [length]
double longest_bond(const State& state);

/// What a rank with these particles must know beside them: the second ends of their bonds, and of those in
/// `among`, its own and all others that may be near, particles and images within reach of them, or all
/// particles of the state besides. reach: 0: none.  [length]
/// Each once, in order of particles and images.
std::vector<ImageOf> ghosts_of(const std::vector<ParticleId>& own, Places among, const Model& model,
                               const State& state, double reach, bool all);

/// Puts ghosts, with their owners, in the order of rows: messages then go through memory in its order.
void put_in_rows(const Order& order, std::vector<ImageOf>& ghosts, std::vector<int>& owners);

/// Adds those of a rank's own particles that are bonded to ghosts.
void add_bonded_to_ghosts(const std::vector<ParticleId>& own, const State& state,
                          std::vector<ParticleId>& to);

}  // namespace vbond
