#pragma once
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/handover.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// What one process steps of a body that is spread over several, and how long it may do so.
struct Share {
  Order order;
  /// Once two particles of different parts have come nearer to each other by twice as much, particles are to
  /// be spread anew: ghosts may be missing of what may meet.  [length]
  double farthest = 0;
  /// The boxes that the particles of other parts are in, one each, where no cell has images of them: whoever
  /// is far from all of them may go farther.
  std::vector<BoundingBox> others = {};
  /// Not once one has gone farther than this: it could not be found again. Such a body diverges.  [length]
  double lost_beyond = 0;
  bool begins = false;  ///< with it the stage begins, or goes on after a checkpoint
  /// If the state has own bonds alone already.
  std::optional<BondsFromSetUp> bonds = {};
  /// If given, state and model are those of a part already.
  std::optional<PartHandedOver> part = {};
  /// If given, that of the simulation. It has then the particles of this part alone until somebody asks for
  /// the whole state.
  Model* model = nullptr;
};

/// What the processes must know of each other's particles in a stage: those that are nearer than this may
/// touch or be bonded, capsules apart (0: none  [length]); and whether each must know all, because bonds
/// touch as capsules, or may be made so.
struct Acquaintance {
  double reach = 0;
  bool knows_all = false;
  bool operator==(const Acquaintance&) const = default;
};
Acquaintance acquaintance(const Model& model, const Stage& stage, const State& state);
/// The second of these. Else the state of a process has its own bonds alone.
bool knows_all(const Model& model, const Stage& stage, const State& state);

/// Spreads the particles of a body over processes, which exchange what they need of each other. All processes
/// call these functions at the same time, with the same whole state unless it says so.
class Partition : public Exchange {
 public:
  /// Before a body has bonds: the own particles of this process, in increasing order, if the next stage
  /// begins in this state with so many bonds of each first particle; longest: of these  [length].
  virtual std::vector<ParticleId> spread_first(const Model& /*model*/, const State& /*state*/,
                                               const PerParticle<std::uint32_t>& /*bonds*/,
                                               double /*longest*/) {
    throw std::logic_error("these processes do not spread a body before it has bonds");
  }
  /// As a stage begins or goes on; after spread_first the state has own bonds alone. reach: particles that
  /// are nearer than this may touch or be bonded; 0: none  [length]. knows_all: each process must know all
  /// particles.
  virtual Share spread(const Model& model, const State& state, double reach, bool knows_all) = 0;
  /// The same body, whose particles have moved since.
  virtual Share spread_anew(const Model& model, const State& state) = 0;
  /// The same, of which each process has its part, and perhaps more: particles go from one to another, and
  /// state and model have then what belongs to the new parts. Also as a stage begins after another one in
  /// which as much was to be known.
  virtual Share migrate(Model& model, State& state, PartHandedOver part) = 0;
  std::int64_t steps_between_meetings() const override { return 64; }
};

}  // namespace vbond
