#pragma once
#include <cstdint>

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
  /// Makes steps, `most` of them unless others have been told of fewer, and brings the state up to date:
  /// clock and energy books always, the particles if `state_is_needed` or if the stage ends here. Throws
  /// Diverged.
  virtual void advance(std::int64_t most, bool state_is_needed, State& state) = 0;
};

}  // namespace vbond
