#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "vbond/model/body_view.hpp"

namespace vbond {

class Simulation;

/// Why a stage ended. `diverged` is never returned by run(), which throws; it is for those who catch.
enum class StopReason { running, duration, distance, peak, rest, breaks, interrupted, diverged };

/// Looks at a run at the start of each stage in motion and after the steps it asks for, and at each balance
/// of a static stage; never changes it.
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
  /// A balance of a static stage, in which finish() is not called. A stage that is interrupted begins again
  /// from its start, and shows its balances again. All processes that share a run are shown the whole body.
  virtual void observe_balance(const BodyView& /*body*/, const BalancePoint& /*balance*/) {}
};

/// Those who look at a run, in the order in which they are shown it.
using Observers = std::vector<std::shared_ptr<Observer>>;
/// Tells them that a stage in motion ends here.
void finish(const Observers& observers, const Simulation& run, StopReason why);

}  // namespace vbond
