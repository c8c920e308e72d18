#pragma once
#include <cstdint>
#include <limits>

#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// What an observer answers that need not look again in this stage.
inline constexpr std::int64_t no_next_look = std::numeric_limits<std::int64_t>::max();

/// Steps from now, at least one, to the next multiple of `every` steps of the stage. every >= 1.
inline std::int64_t steps_to_multiple(const Clock& now, std::int64_t every) {
  return every - now.stage_step % every;
}

/// Decides when something is to be written: as a stage begins, every so many of its steps, and as it
/// ends, but never twice at one step (the end of a stage and the start of the next are one step).
/// It depends on nothing but the clock and the last step written, so a resumed run decides alike.
class Due {
 public:
  /// every: [time], > 0. last_step: the last step already written, -1 for none.
  explicit Due(double every, std::int64_t last_step = -1) : every_(every), last_step_(last_step) {}

  bool now(const Clock& c) const { return c.step > last_step_ && c.stage_step % interval(c) == 0; }
  /// Steps from now, at least one, until it is due again, should the stage last that long.
  std::int64_t steps_to_next(const Clock& c) const { return steps_to_multiple(c, interval(c)); }
  bool at_stage_end(const Clock& c) const { return c.step > last_step_; }
  void written(std::int64_t step) { last_step_ = step; }

 private:
  /// In steps; worked out when the step changes, which it does only between stages.
  std::int64_t interval(const Clock& c) const {
    if (c.dt != dt_) dt_ = c.dt, interval_ = steps_in(every_, c.dt);
    return interval_;
  }

  double every_;
  std::int64_t last_step_;
  mutable double dt_ = -1;  // no stage so far
  mutable std::int64_t interval_ = 1;
};

}  // namespace vbond
