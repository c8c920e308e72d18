#pragma once
#include <cstdint>

#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Decides when something is to be written: as a stage begins, every so many of its steps, and as it
/// ends, but never twice at one step (the end of a stage and the start of the next are one step).
/// It depends on nothing but the clock and the last step written, so a resumed run decides alike.
class Due {
 public:
  /// every: [time], > 0. last_step: the last step already written, -1 for none.
  explicit Due(double every, std::int64_t last_step = -1) : every_(every), last_step_(last_step) {}

  bool now(const Clock& c) const { return c.step > last_step_ && c.stage_step % steps_in(every_, c.dt) == 0; }
  bool at_stage_end(const Clock& c) const { return c.step > last_step_; }
  void written(std::int64_t step) { last_step_ = step; }

 private:
  double every_;
  std::int64_t last_step_;
};

}  // namespace vbond
