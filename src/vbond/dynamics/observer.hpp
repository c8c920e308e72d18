#pragma once

namespace vbond {

class Simulation;

/// Looks at a run after every step, and once at the start of each stage; never changes it.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void observe(const Simulation& run) = 0;
  /// The stage is over, or the run has been interrupted or has failed: write what is pending.
  virtual void finish(const Simulation& /*run*/) {}
};

}  // namespace vbond
