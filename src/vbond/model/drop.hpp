#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/model/bond_event.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// A particle that a run cannot go on with; or of a pair that have passed through one another, either.
struct LostParticle {
  ParticleId p;                          ///< of a pair the one that is rather to go
  std::optional<ParticleId> other = {};  ///< of a pair
  std::string why = {};                  ///< of one alone, e.g. "its centre has passed through ..."
};

/// The run went unphysical by single particles: its state is finite, and sound without them.
class ParticlesLost : public Diverged {
 public:
  /// told: of the first of them.
  ParticlesLost(const Diverged& told, std::vector<LostParticle> particles)
      : Diverged(told), lost(std::move(particles)) {}
  std::vector<LostParticle> lost;
};

/// What cannot be of the particles that a state calls dropped: they are those of the state, in increasing
/// order, and have no bonds.
std::optional<std::string> mistake_in_dropped(const State& state);

/// Whether a stage can do without the particle: no support holds it, and no distance to it ends the stage.
bool can_do_without(const Stage& stage, ParticleId p);

/// Which particles to drop so that none of these is left, in increasing order, each with the reason; of a
/// pair one, none if the other goes anyway. Nothing if the stage cannot do without one of them.
std::optional<std::vector<std::pair<ParticleId, std::string>>> to_be_dropped(
    const Stage& stage, const std::vector<LostParticle>& lost);

/// Takes these particles out of the computation: they stop where they are, their bonds are broken, and what
/// they and others remember of touching is forgotten. Loads at the present positions are to be worked out
/// anew. Returns the bonds that broke by this, in their order. The energy that goes with them is for the
/// caller to book (Simulation::take_over).
std::vector<BondEvent> drop(const std::vector<ParticleId>& particles, State& state);

}  // namespace vbond
