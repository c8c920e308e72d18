#pragma once
#include <cstdint>

#include "vbond/model/state.hpp"

namespace vbond {

class Simulation;

/// Why a stage ended. `diverged` is never returned by run(), which throws; it is for those who catch.
enum class StopReason { running, duration, distance, peak, rest, breaks, interrupted, diverged };

/// Looks at a run at the start of each stage and after the steps it asks for; never changes it.
class Observer {
 public:
  virtual ~Observer() = default;
  /// May be called more often than asked for: when another observer wants to look.
  virtual void observe(const Simulation& run) = 0;
  /// After how many steps from now, at least one, it must look again. Asked after each call of observe.
  virtual std::int64_t steps_to_next_look(const Clock& /*now*/) const { return 1; }
  /// Called once when run() returns. After StopReason::interrupted the stage will be resumed, so
  /// nothing may be written here that an uninterrupted run would not have written.
  virtual void finish(const Simulation& /*run*/, StopReason /*why*/) {}
};

}  // namespace vbond
