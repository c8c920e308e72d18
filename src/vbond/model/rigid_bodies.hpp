#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "vbond/core/communicator.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

/// What rigid supports make one body of. Pairs of its particles are out of contact: what they would do to
/// each other moves nothing. A pair with an image is none of them: that is another body.
namespace vbond {

/// Those of a stage, in the order of particles. Supports that share particles make one body.
std::vector<Carried> carried_by(const std::vector<Support>& supports);

/// The same for many questions.
class RigidBodies {
 public:
  RigidBodies() = default;
  RigidBodies(std::size_t particles, const std::vector<Carried>& carried);

  bool any() const { return !body_.empty(); }
  bool are_one(ParticleId i, ParticleId j, const Image& of_j = {}) const {
    return any() && body_[i] != 0 && body_[i] == body_[j] && i != j && of_j.is_itself();
  }

 private:
  PerParticle<std::int64_t> body_;  // from 1; 0: of none. Empty: there are none
};

/// What take_hold() changes of a state, for a stage that cannot begin.
class BeforeHold {
 public:
  explicit BeforeHold(const State& s);
  void put_back(State& s) &&;

 private:
  std::vector<Carried> carried_;
  std::vector<PairMemory> contact_history_;
  EnergyBooks books_;
  std::array<Loads, 3> loads_;
};

/// The bodies of a stage that begins take the place of those of the stage before. Energy of contacts that are
/// left out or come back by this is booked as work of supports. What a pair remembers is kept while it is out
/// of contact, along the axes of its first particle, so that it turns with the body; the damping of its last
/// step is not. Nothing happens if the state has these bodies already.
std::optional<BeforeHold> take_hold(const Model& model, const std::vector<Support>& supports, State& state);
/// The same of a body in parts, which call this together. Each knows the places of all particles, and what
/// the pairs remember whose lower number is its own (has).
std::optional<BeforeHold> take_hold(const Model& model, const std::vector<Support>& supports, State& state,
                                    const std::function<bool(ParticleId)>& has, const Communicator& all);

}  // namespace vbond
