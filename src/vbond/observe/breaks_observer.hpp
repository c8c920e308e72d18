#pragma once
#include <cstdint>
#include <map>
#include <optional>

#include "vbond/observe/breaks.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// Writes breaks.csv and fragments.csv; made only if the plan says that bonds may break.
class BreaksObserver : public TimedObserver {
 public:
  /// resumed: the clock of the checkpoint that a run goes on from; at_rest: within a stage of fracture.
  BreaksObserver(const OutputPlan& plan, const std::optional<Clock>& resumed, bool at_rest = false);
  void observe(const Simulation& run) override;
  std::int64_t steps_to_next_look(const Clock& now) const override;
  void finish(const Simulation& run, StopReason why) override;
  void observe_balance(const BodyView& body, const BalancePoint& balance) override;
  /// The fragments at the end of a stage, of a body or of all parts of it, which call this together.
  void end_stage(const Model& model, const BodyPart& body, std::int64_t stage);
  /// Bonds that a static stage has broken so far, in a state after that; start: the clock as it began. Points
  /// are its steps. Those that were added before are not added again.
  void add_breaks_at_rest(const Clock& start, const State& state, const std::vector<BrokenBond>& breaks);
  /// The stage under way is static, and goes on after so many breaks.
  void go_on_at_rest(std::size_t breaks) { added_at_rest_ = breaks; }
  /// Nothing where others write.
  BreakRecord record() const { return breaks_ ? breaks_->record() : BreakRecord{}; }
  bool begun_anew() const { return breaks_ && breaks_->begun_anew(); }

 private:
  std::optional<Group> loaded_;                  // the first group whose reaction is asked for
  std::map<std::int64_t, double> load_at_rest_;  // its size at the steps of a static stage  [force]
  std::size_t added_at_rest_ = 0;                // breaks of the static stage under way
  std::optional<BreaksWriter> breaks_;
  std::optional<FragmentsWriter> fragments_;
};

}  // namespace vbond
