#pragma once
#include <vector>

#include "vbond/core/communicator.hpp"
#include "vbond/dynamics/handover.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

/// Particles of a body in parts, each of which has its own particles and bonds alone, go from part to part.
/// All parts call these functions together. Lists of particles are in increasing order.
namespace vbond {

/// The part that has each of these particles. own: those of this part. No part has a list of all of them:
/// each keeps one of a share of their numbers, in which the others look up what they need. A particle of no
/// part is said to be of the first.
std::vector<int> owners_of(const std::vector<ParticleId>& asked, const std::vector<ParticleId>& own,
                           std::size_t particles, const Communicator& all);

/// Particles that this part had before, and has no longer, go to the part that has them now, with their bonds
/// and with what their contacts remember; others come. State and model have then what belongs to the present
/// own particles, and to absent ones.
void migrate(const std::vector<ParticleId>& before, const std::vector<ParticleId>& now, Model& model,
             State& state, PartHandedOver& part, const Communicator& all);

/// State and model have then in addition what belongs to these particles of other parts, as it is there.
void know_besides(const std::vector<ParticleId>& others, const std::vector<int>& owners,
                  const std::vector<ParticleId>& own, Model& model, State& state, const Communicator& all);

/// Particles of other parts that this part must know: ghosts, second ends of its bonds, broken ones too, and
/// members of grips.
std::vector<ParticleId> others_to_know(const std::vector<ParticleId>& own, const std::vector<ImageOf>& ghosts,
                                       const State& state);

}  // namespace vbond
