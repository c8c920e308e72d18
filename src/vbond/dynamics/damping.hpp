#pragma once
#include <vector>

#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// Viscous drag -b v and -b omega over half a step, solved exactly (v decays by exp(-b dt / 2m)): stable
/// for any b, and what it takes out of the kinetic energy is known to the last digit.
class Damping {
 public:
  /// Keeps a reference to the bodies.
  Damping(const Stage& stage, Bodies& bodies);
  /// Slows particles down and returns the energy that goes; supports put their own velocities back after it.
  double slow_down(RowRange rows) const;

 private:
  Bodies& bodies_;
  std::vector<Decay> decay_;  // of each row; empty: no damping
};

}  // namespace vbond
