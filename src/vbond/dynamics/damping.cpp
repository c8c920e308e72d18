#include "vbond/dynamics/damping.hpp"

#include <cmath>

#include "vbond/model/holds.hpp"

namespace vbond {

Damping::Damping(const Stage& stage, Bodies& bodies)
    : bodies_(bodies),
      half_step_(0.5 * stage.dt),
      b_rotation_(stage.b_rotation),
      local_(stage.local_damping) {
  if (is_local()) {
    held_.resize(bodies.pose.size());
    for (const Hold& h : holds_of(stage.supports)) {
      const std::size_t row = bodies.order.row[h.particle].value;
      for (std::size_t k = 0; k < h.held.size(); ++k) held_[row][k] |= h.held[k];
      if (h.axes == nullptr) continue;
      axes_.resize(held_.size());
      axes_[row] = h.axes;
    }
  }
  if (stage.b_translation == 0.0 && stage.b_rotation == 0.0) return;
  decay_.resize(bodies.pose.size());
  for (std::size_t k = 0; k < bodies.order.own; ++k) {
    const double m = bodies.mass[k], theta = bodies.inertia[k], half = -0.5 * stage.dt;
    Decay& d = decay_[k];
    d.v = std::exp(half * stage.b_translation / m);
    d.omega = bodies.tops.has(k) ? 1.0 : std::exp(half * stage.b_rotation / theta);
    d.of_v = 0.5 * m * (1.0 - d.v * d.v);
    d.of_omega = 0.5 * theta * (1.0 - d.omega * d.omega);
  }
  for (const Support& s : stage.supports)  // slows down as one body
    for (const ParticleId p : s.particles)
      if (is_free_grip(s) && bodies.order.has(p)) decay_[bodies.order.row[p].value] = {1.0, 1.0, 0.0, 0.0};
}

double Damping::do_slow_down(RowRange rows) const {
  return step_kernel().slow_down(rows, decay_.data(), bodies_.motion.data()) +
         bodies_.tops.slow_down(rows, half_step_, b_rotation_, bodies_.turning());
}

void Damping::oppose_motion(RowRange rows, const Tensor* flow) const {
  const auto against = [this](double load, double rate, bool held) {
    return held || rate == 0.0 ? 0.0 : -local_ * std::copysign(std::abs(load), rate);
  };
  const auto oppose = [&](const Vec3d& load, const Vec3d& rate, const HeldDofs& held, std::size_t k) {
    return Vec3d{against(load.x, rate.x, held[k]), against(load.y, rate.y, held[k + 1]),
                 against(load.z, rate.z, held[k + 2])};
  };
  const auto oppose_along = [&](const HeldAxes& axes, const Vec3d& load, const Vec3d& rate,
                                const HeldDofs& held, std::size_t first) {
    Vec3d sum;
    for (std::size_t dof = first; dof < first + 3; ++dof)
      sum += against(dot(load, axes.of(dof)), dot(rate, axes.of(dof)), held[dof]) * axes.of(dof);
    return sum;
  };
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    LoadRow &load = bodies_.load[k], &damping = bodies_.damping[k];
    MotionRow rate = bodies_.motion[k];
    if (flow != nullptr) rate.v -= times(*flow, bodies_.pose[k].r);
    const HeldAxes* axes = axes_.empty() ? nullptr : axes_[k].get();
    const Vec3d F = axes == nullptr ? oppose(load.F, rate.v, held_[k], 0)
                                    : oppose_along(*axes, load.F, rate.v, held_[k], 0);
    const Vec3d M = axes == nullptr ? oppose(load.M, rate.omega, held_[k], 3)
                                    : oppose_along(*axes, load.M, rate.omega, held_[k], 3);
    load.F += F, damping.F += F;
    load.M += M, damping.M += M;
    if (bodies_.local_damping.empty()) continue;
    bodies_.local_damping[k].F = F, bodies_.local_damping[k].M = M;
  }
}

}  // namespace vbond
