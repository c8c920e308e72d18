#pragma once
#include <cstdint>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Makes the steps of a Simulation in its place: by many processes, say. The Simulation then only shows the
/// body to its observers.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Takes over the body as a stage begins or goes on. Model and stage live as long as the stage.
  virtual void begin(const Model& model, const Stage& stage, const State& state) = 0;
  /// Makes steps, `most` of them unless others have been told of fewer or bonds break, and brings the state
  /// up to date: clock and energy books. The particles, too, for who has observers; for all processes if
  /// `all_look`, if bonds break, or if the stage ends here. Returns the bonds that break in the last step.
  /// Throws Diverged.
  virtual std::vector<BondId> advance(std::int64_t most, bool all_look, State& state) = 0;
};

}  // namespace vbond
