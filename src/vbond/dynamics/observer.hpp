#pragma once

namespace vbond {

class Simulation;

/// Why a stage ended. `diverged` is never returned by run(), which throws; it is for those who catch.
enum class StopReason { running, duration, distance, peak, rest, interrupted, diverged };

/// Looks at a run after every step, and once at the start of each stage; never changes it.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void observe(const Simulation& run) = 0;
  /// Called once when run() returns. After StopReason::interrupted the stage will be resumed, so
  /// nothing may be written here that an uninterrupted run would not have written.
  virtual void finish(const Simulation& /*run*/, StopReason /*why*/) {}
};

}  // namespace vbond
