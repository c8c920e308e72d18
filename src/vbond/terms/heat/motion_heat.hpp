#pragma once
#include <cstddef>
#include <vector>

#include "vbond/dynamics/motion_term.hpp"

namespace vbond {

/// Temperatures of a stage of motion. Bonds that expand get other lengths at the start of a step, so that its
/// loads belong to the temperatures at its end. What this does to the energy of the bonds is work of imposed
/// strain: dU/dg times the change of the growth g, the mean of before and after the step.
class MotionHeat final : public MotionTerm {
 public:
  explicit MotionHeat(const BodyInMotion& on) : on_(on) {}

  bool is_there() const override { return !on_.stage.heating.empty(); }
  /// The temperatures with which the stage begins, or goes on after an edit: the energy changes while nothing
  /// moves, and bonds flow that this brings beyond their limits.
  void begin_stage() override;
  void begin_step() override;
  void books_closed() override { book(); }

 private:
  /// A bond that grows by this part of its lengths at temperature 0, in the step under way.
  struct Growing {
    std::size_t warm_bond;
    double growth;
  };

  bool set_temperatures(double time);
  void jump_to(double time);
  void book();

  const BodyInMotion on_;
  std::vector<Growing> growing_;
  bool known_ = false;  // that temperatures of the state are those of the stage
};

}  // namespace vbond
