#include "vbond/dynamics/damping.hpp"

#include <cmath>

namespace vbond {

Damping::Damping(const Stage& stage, Bodies& bodies) : bodies_(bodies) {
  if (stage.b_translation == 0.0 && stage.b_rotation == 0.0) return;
  decay_.resize(bodies.pose.size());
  for (std::size_t k = 0; k < bodies.order.particle.size(); ++k) {
    const double m = bodies.mass[k], theta = bodies.inertia[k], half = -0.5 * stage.dt;
    Decay& d = decay_[k];
    d.v = std::exp(half * stage.b_translation / m);
    d.omega = std::exp(half * stage.b_rotation / theta);
    d.of_v = 0.5 * m * (1.0 - d.v * d.v);
    d.of_omega = 0.5 * theta * (1.0 - d.omega * d.omega);
  }
}

double Damping::slow_down(RowRange rows) const {
  return decay_.empty() ? 0.0 : step_kernel().slow_down(rows, decay_.data(), bodies_.motion.data());
}

}  // namespace vbond
