#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/by_block.hpp"
#include "vbond/dynamics/grips.hpp"
#include "vbond/model/holds.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// The value of a stage's time functions at the three instants of a step.
class Factors {
 public:
  /// Times are products, as the clock's are: the end of a step is the start of the next to the last bit.
  void set_times(std::int64_t stage_step, double dt) {
    const auto n = static_cast<double>(stage_step);
    for (std::size_t k = 0; k < functions_.size(); ++k)
      values_[k] = {(*functions_[k])(n * dt), (*functions_[k])((n + 0.5) * dt),
                    (*functions_[k])((n + 1.0) * dt)};
  }
  void add(const TimeFunction& f) { functions_.push_back(&f), values_.push_back({}); }
  double at(std::size_t function, Instant i) const { return values_[function][static_cast<std::size_t>(i)]; }

 private:
  std::vector<const TimeFunction*> functions_;
  std::vector<std::array<double, 3>> values_;
};

/// Degrees of freedom held at rest or at a prescribed velocity, and the work that this takes: kinetic energy
/// changes by no other hand than theirs and the loads'. Each function returns that work.  [energy]
class Supports {
 public:
  /// Keeps references to stage and bodies.
  Supports(const Stage& stage, Bodies& bodies, const Team& team);
  Supports(const Stage&&, Bodies&, const Team&) = delete;

  void set_times(std::int64_t stage_step, double dt) {
    factors_.set_times(stage_step, dt);
    if (grips_.any()) grips_.set_times(stage_step);
  }

  /// Gives held rates their prescribed value of that instant.
  double hold(const Block& block, Instant at) {
    return (held_.empty() ? 0.0 : do_hold(block, at)) + (grips_.any() ? grips_.hold(block, at) : 0.0);
  }
  /// The same after a kick over h, which the supports have borne: the impulse that they add, times the mean
  /// prescribed velocity, is their work.
  double hold_after_kick(const Block& block, Instant from, Instant to, double h) {
    return (held_.empty() ? 0.0 : do_hold_after_kick(block, from, to, h)) +
           (grips_.any() ? grips_.hold_after_kick(block, from, to, h) : 0.0);
  }

  /// Whether they hold any particle of the block.
  bool hold_any(const Block& block) const {
    return grips_.any() || (!held_.empty() && held_.begin_of(block.index) != held_.end_of(block.index));
  }

  /// Each degree of freedom that is held, once, of particles that are moved here.
  const std::vector<Hold>& holds() const { return holds_; }
  Grips& grips() { return grips_; }
  const Grips& grips() const { return grips_; }

 private:
  double energy_of_tops(const Block& block, Tops::Turns least) const;
  double do_hold(const Block& block, Instant at) const;
  double do_hold_after_kick(const Block& block, Instant from, Instant to, double h) const;
  template <class F>
  void for_each_held(const Block& block, F f) const;

  const Stage& stage_;
  Bodies& bodies_;
  Factors factors_;
  std::vector<Hold> holds_;
  ByBlock held_;  // indices of those in holds_ that grips do not move
  Grips grips_;
};

/// Point loads and gravity.
class AppliedLoads {
 public:
  AppliedLoads(const Stage& stage, Bodies& bodies, const Team& team);
  AppliedLoads(const Stage&&, Bodies&, const Team&) = delete;

  void set_times(std::int64_t stage_step, double dt) { factors_.set_times(stage_step, dt); }
  /// Adds them to the loads of a block.
  void add(const Block& block, Instant at) const {
    if (any_) do_add(block, at);
  }
  /// Their work over a step of dt during which rates are constant, once the block has moved.  [energy]
  double work(const Block& block, double dt) const {
    return any_ ? do_work(block, dt, Instant::middle) : 0.0;
  }
  /// The same of half a step, with what they are as particles stand at this end of it.
  double work_of_half(const Block& block, double half, Instant end) const {
    return any_ ? do_work(block, half, end) : 0.0;
  }

 private:
  void do_add(const Block& block, Instant at) const;
  double do_work(const Block& block, double dt, Instant at) const;
  double power_of_follower(const ByBlock::Entry& e, double dt, Instant at) const;

  const Stage& stage_;
  Bodies& bodies_;
  Factors factors_;
  ByBlock loaded_;
  bool any_;
};

}  // namespace vbond
