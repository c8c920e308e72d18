#pragma once
#include "vbond/dynamics/motion_term.hpp"

namespace vbond {

/// The strain that a stage imposes on a group now and then, before a step: particles jump. What this does to
/// the energy of the body is work of imposed strain, but for what applied loads do on the way.
class MotionStrain final : public MotionTerm {
 public:
  explicit MotionStrain(const BodyInMotion& on) : on_(on) {}

  bool is_there() const override { return on_.stage.strain.has_value(); }
  void begin_step() override;

 private:
  double let_bonds_flow();

  const BodyInMotion on_;
};

}  // namespace vbond
