#pragma once
#include <memory>
#include <vector>

#include "vbond/core/tensor.hpp"
#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// Viscous drag and local damping. Drag is -b v and -b omega over half a step, solved exactly (v decays by
/// exp(-b dt / 2m)): stable for any b, and what it takes out of the kinetic energy is known to the last
/// digit.
class Damping {
 public:
  /// Keeps a reference to the bodies.
  Damping(const Stage& stage, Bodies& bodies);
  /// Slows particles down and returns the energy that goes; supports put their own velocities back after it.
  double slow_down(RowRange rows) const { return decay_.empty() ? 0.0 : do_slow_down(rows); }
  /// Cundall's local damping: adds to complete loads, and to the part of them that damps (and to that of
  /// local damping alone, where it is kept), what opposes the rates of the last half step. Held degrees of
  /// freedom are left out. flow: of a cell that moves, which is not opposed.
  bool is_local() const { return local_ > 0.0; }
  bool is_drag() const { return !decay_.empty(); }
  void oppose_motion(RowRange rows, const Tensor* flow = nullptr) const;

 private:
  double do_slow_down(RowRange rows) const;

  Bodies& bodies_;
  std::vector<Decay> decay_;  // of each row; empty: no drag
  double half_step_, b_rotation_;
  double local_;
  std::vector<HeldDofs> held_;                         // of each row, in its axes, for local damping
  std::vector<std::shared_ptr<const HeldAxes>> axes_;  // of each row; empty: all have those of the world
};

}  // namespace vbond
