#pragma once
#include <cstdint>

#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

class Simulation;

/// Makes the steps of a Simulation in its place: by many processes, say, each of which steps a part of the
/// body by a Simulation of its own. The one that is stepped for then only shows the body to its observers.
class Stepper {
 public:
  /// What steps have come to.
  struct Leap {
    StopReason why = StopReason::running;
    bool bonds_changed = false;  ///< State::bonds is not what it was
    Simulation* part = nullptr;  ///< that of this process
  };
  /// The most steps until it brings the body up to date, as an interruption waits for that.
  static constexpr std::int64_t at_once = 256;
  virtual ~Stepper() = default;
  /// Takes over the body as a stage begins or goes on. Model and stage live as long as the stage. reach:
  /// particles that are nearer than this may touch or be bonded; 0: none; infinite: each part must know all.
  /// [length]
  virtual void begin(const Model& model, const Stage& stage, const State& state, double reach) = 0;
  /// Makes steps until the stage ends or observers must look, `most` of them unless others have been told of
  /// fewer, and brings the state up to date: for the process that has observers, and for all when the stage
  /// ends. Throws Diverged.
  virtual Leap advance(std::int64_t most, State& state) = 0;
};

}  // namespace vbond
