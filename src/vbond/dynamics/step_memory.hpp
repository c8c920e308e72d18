#pragma once
#include <cstdint>

#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Memory that a run takes at least in the time loop; neighbour lists and what a stage adds (local damping,
/// bonds on approach) are extra.  [bytes]
struct MemoryUse {
  double per_particle = 0;
  double per_bond = 0;
};

/// Constants, state and scratch of a run of this body; tops, and images of a periodic body, count per
/// particle, as a mean over all.
MemoryUse memory_use(const Model& model, const State& state);

/// Of a model: mass, inertia, radius, specimen and first place.  [bytes]
inline constexpr double model_bytes_per_particle = 3 * sizeof(double) + sizeof(std::uint32_t) + sizeof(Vec3d);

/// What each rank has from the set-up on: all bonds until a stage begins, or its own alone, or of
/// orientations and velocities, too, those of its own particles and of few others; or so of first places as
/// well.
enum class RanksKeep : std::uint8_t { all_bonds, own_bonds, own_motion, own_first_places };
/// By what a rank has as it is set up.
inline RanksKeep kept_by(const Model& model, const BodyPart& body) {
  if (body.has_all_bonds()) return RanksKeep::all_bonds;
  if (body.state.v.holds_all()) return RanksKeep::own_bonds;
  return model.r_0.holds_all() ? RanksKeep::own_motion : RanksKeep::own_first_places;
}

/// About the most that each of so many ranks, >= 1, takes, with program, MPI and LAMMPS. In the time loop
/// rows of particles, constants and index of bonds are shared out, and bonds, state and model if ranks keep
/// their own alone. As such a body is set up each rank has the places of all particles. The state may be that
/// of one of them. [bytes]
double memory_of_each_rank(const Model& model, const State& state, double bonds, int ranks, RanksKeep keep);

}  // namespace vbond
