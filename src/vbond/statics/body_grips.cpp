// Grips: rigid supports, which move their particles as told, or as one body where they are free in part.
#include <algorithm>
#include <optional>

#include "vbond/statics/detail/body.hpp"

namespace vbond {

void StaticBody::take_hold() {
  for (const Support& s : stage_.supports) {
    if (!s.rigid) continue;
    Vec3d pivot;
    double weight = 0.0;
    for (const ParticleId p : s.particles) {
      const double w = is_free_grip(s) ? model_.mass[p] : 1.0;
      pivot += w * state_.r[p], weight += w;
    }
    pivot = s.pivot ? *s.pivot + load_factor_ * s.velocity : pivot / weight;
    Grip grip{&s, {pivot, s.velocity, s.angular_velocity}, {}, pivot, {1, 0, 0, 0}};
    for (const ParticleId p : s.particles) grip.as_held.push_back({state_.r[p] - pivot, state_.q[p]});
    grips_.push_back(std::move(grip));
  }
  set_turns_before(stage_.grip_turns_at_start);
}

void StaticBody::place(const Grip& g, const Vec3d& pivot, const Quatd& turn, State& state) {
  for (std::size_t k = 0; k < g.as_held.size(); ++k) {
    const ParticleId p = g.support->particles[k];
    state.r[p] = pivot + rotate(turn, g.as_held[k].arm);
    state.q[p] = normalised(turn * g.as_held[k].q);
  }
}

/// Particles of grips that hold all to where these are at the load factor.
void StaticBody::carry() {
  const double since = load_factor_ - held_at_;
  for (const Grip& g : grips_)
    if (!is_free_grip(*g.support)) place(g, g.motion.pivot_at(since), g.motion.turn(since), state_);
}

/// Particles of the other grips, from where these stood, by these unknowns and this change of the load
/// factor.
void StaticBody::carry_free(const Vector& x, double load_factor_change) {
  for (const Grip& g : grips_) {
    const Support& s = *g.support;
    if (!is_free_grip(s)) continue;
    const Movement m = unknowns_.along_own(s.particles.front(), x);
    const bool turns_as_told = s.held[3] && s.held[4] && s.held[5];
    place(g, g.pivot + m.shift + load_factor_change * s.velocity,
          turns_as_told ? g.motion.turn(load_factor_ - held_at_)
                        : normalised(rotation_of(m.turn / unknowns_.length()) * g.turn),
          state_);
  }
}

/// Where grips stand, and how their particles lie about the pivots.
void StaticBody::look_at_grips() {
  const double since = load_factor_ - held_at_;
  for (Grip& g : grips_) {
    g.pivot = g.motion.pivot_at(since);
    g.turn = g.motion.turn(since);
    if (!is_free_grip(*g.support)) continue;
    const ParticleId first = g.support->particles.front();
    g.turn = normalised(state_.q[first] * conjugate(g.as_held[0].q));
    g.pivot = state_.r[first] - rotate(g.turn, g.as_held[0].arm);
    for (std::size_t k = 0; k < g.as_held.size(); ++k)
      unknowns_.set_arm(g.support->particles[k], rotate(g.turn, g.as_held[k].arm));
  }
}

bool StaticBody::has_free_grips() const {
  return std::any_of(grips_.begin(), grips_.end(), [](const Grip& g) { return is_free_grip(*g.support); });
}

Vec3d StaticBody::seat(ParticleId p, const Placement& at) const {
  if (unknowns_.arm(p) == nullptr) return at.r[p];
  const auto grip = std::find_if(grips_.begin(), grips_.end(), [&](const Grip& g) {
    return g.support->particles.front() == unknowns_.carrier(p);
  });
  const ParticleId first = unknowns_.carrier(p);
  const GrippedPose& held = grip->as_held[0];
  return at.r[first] - rotate(normalised(at.q[first] * conjugate(held.q)), held.arm);
}

/// Forces on particles of a rigid support turn it by their arms, which turn with it. Those between its
/// particles turn as well.
void StaticBody::add_arms() const {
  const double L = unknowns_.length();
  for (const Grip& g : grips_) {
    if (!is_free_grip(*g.support)) continue;
    Assembly::Block K = Assembly::Block::Zero();
    for (const ParticleId p : g.support->particles) {
      const Loaded& l = loads_at_hand();
      const Vec3d d = *unknowns_.arm(p) / L, F = (l.loads.F[p] - l.inside[p]) / L;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          K(3 + a, 3 + b) += (a == b ? dot(d, F) : 0.0) - component(d, a) * component(F, b);
    }
    const ParticleId first = g.support->particles.front();
    stiffness_.assembly.add_own(first, 0.5 * (K + K.transpose()));
    if (flows()) stiffness_.full.add_own(first, K);
  }
}

/// Of one that turns freely about one axis with its sign.
double StaticBody::angle_of(const Grip& g) const {
  const HeldDofs& held = g.support->held;
  if (held[3] && held[4] && held[5]) return load_factor_ * norm(g.support->angular_velocity);
  const Vec3d turn = rotation_vector(g.turn * g.before);
  for (int k = 0; k < 3; ++k)
    if (held[3 + static_cast<std::size_t>(k + 1) % 3] && held[3 + static_cast<std::size_t>(k + 2) % 3])
      return component(turn, k);
  return norm(turn);
}

std::vector<Quatd> StaticBody::turns_of_grips() const {
  std::vector<Quatd> turns;
  for (const Grip& g : grips_) turns.push_back(normalised(g.turn * g.before));
  return turns;
}

std::vector<Quatd> StaticBody::turns_before() const {
  std::vector<Quatd> turns;
  for (const Grip& g : grips_) turns.push_back(g.before);
  return turns;
}

void StaticBody::set_turns_before(const std::vector<Quatd>& turns) {
  for (std::size_t k = 0; k < std::min(turns.size(), grips_.size()); ++k) grips_[k].before = turns[k];
}

std::vector<GripView> StaticBody::grips() const {
  const Loads& loads = loads_at_hand().loads;
  std::vector<GripView> all;
  for (const Grip& g : grips_) {
    GripView view{g.support->group, {}, {}, angle_of(g), std::nullopt};
    for (const ParticleId p : g.support->particles) {
      view.force -= loads.F[p];
      view.moment -= loads.M[p] + cross(state_.r[p] - g.pivot, loads.F[p]);
    }
    for (int k = 0; k < 3; ++k) {  // along and about what is free: rounding
      if (!g.support->held[static_cast<std::size_t>(k)]) component(view.force, k) = 0.0;
      if (!g.support->held[static_cast<std::size_t>(k + 3)]) component(view.moment, k) = 0.0;
    }
    all.push_back(std::move(view));
  }
  return all;
}

}  // namespace vbond
