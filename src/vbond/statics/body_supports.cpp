// What acts on a body from outside: supports and loads.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/kinds.hpp"

namespace vbond {

void StaticBody::set_held_rates() {
  for (const Hold& h : holds_) held_rate_[h.particle] = {};
  for (const Hold& h : holds_) {
    const Support& s = stage_.supports[h.support];
    const Movement rate{rate_of(s, h.particle), unknowns_.length() * s.angular_velocity};
    if (is_free_grip(s)) {
      held_rate_[h.particle] = rate;
      continue;
    }
    for (int dof = 0; dof < 6; ++dof)
      if (h.held[static_cast<std::size_t>(dof)])
        unknowns_.add(h.particle, dof, unknowns_.along(h.particle, dof, rate), held_rate_[h.particle]);
  }
}

Vec3d StaticBody::rate_of(const Support& s, ParticleId p) const {
  if (!s.rigid) return s.velocity;
  if (is_free_grip(s)) return s.velocity + cross(s.angular_velocity, *unknowns_.arm(p));
  const auto grip =
      std::find_if(grips_.begin(), grips_.end(), [&](const Grip& g) { return g.support == &s; });
  return grip->motion.rate_at(load_factor_ - held_at_, state_.r[p]);
}

void StaticBody::add_applied(double load_factor, Loads& loads) const {
  for (const PointLoad& l : stage_.loads)
    for (const ParticleId p : l.particles) {
      const double factor = l.constant ? 1.0 : load_factor;
      const auto along = [&](const Vec3d& v) { return l.follower ? rotate(state_.q[p], v) : v; };
      loads.F[p] += factor * along(l.force_on(model_.mass[p]));
      loads.M[p] += factor * along(l.moment_on(model_.mass[p]));
    }
  const double gravity = stage_.constant_gravity ? 1.0 : load_factor;
  for (const ParticleId p : loads.F.ids()) loads.F[p] += gravity * model_.mass[p] * stage_.gravity;
}

/// Loads at the load factor, moments on particles of a rigid support that is free in part where its unknowns
/// are. Its forces act there with their arms, which turn with it: they have a potential.
Loads StaticBody::moments_at_carriers() const {
  Loads applied = applied_loads(load_factor_);
  for (const ParticleId p : applied.M.ids())
    if (const ParticleId c = unknowns_.carrier(p); c != p)
      applied.M[c] += std::exchange(applied.M[p], Vec3d{});
  if (!relief_.turns || load_factor_ >= 1.0) return applied;
  for (const ParticleId p : applied.M.ids())
    if (unknowns_.carrier(p) == p)
      applied.M[p] -= (1.0 - load_factor_) * unknowns_.length() * unknowns_.along_own(p, relief_.forces).turn;
  return applied;
}

/// How a load that turns with a particle changes as it turns: its part of the tangent, along world axes.
Assembly::Block StaticBody::follower_block(const PointLoad& l, ParticleId p) const {
  const double L = unknowns_.length(), factor = l.constant ? 1.0 : load_factor_;
  const Vec3d F = factor / L * rotate(state_.q[p], l.force_on(model_.mass[p]));
  const Vec3d M = factor / sq(L) * rotate(state_.q[p], l.moment_on(model_.mass[p]));
  Assembly::Block K = Assembly::Block::Zero();
  for (const auto& [row, v] : {std::pair{0, F}, std::pair{3, M}})
    K.block<3, 3>(row, 3) << 0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0;
  return K;
}

void StaticBody::add_followers() const {
  for (const PointLoad& l : stage_.loads) {
    if (!l.follower) continue;
    for (const ParticleId p : l.particles) {
      const Assembly::Block in_world = follower_block(l, p);
      Eigen::Matrix<double, 12, 1> rate = Eigen::Matrix<double, 12, 1>::Zero();
      for (int k = 0; k < 3; ++k) rate[3 + k] = component(held_rate_[p].turn, k);
      const Eigen::Matrix<double, 12, 1> pushed = -in_world * rate;
      unknowns_.add_load(p, {{pushed[0], pushed[1], pushed[2]}, {pushed[3], pushed[4], pushed[5]}},
                         stiffness_.load_direction);
      const Assembly::Block K = stiffness_.assembly.in_axes(p, p, in_world);
      stiffness_.assembly.add_own(p, 0.5 * (K + K.transpose()));
      if (flows()) stiffness_.full.add_own(p, K);
    }
  }
}

/// Of the parts of followers in the tangent what has no potential: the antisymmetric part.
void StaticBody::for_followers(const std::function<void(int row, int column, double K)>& entry) const {
  for (const PointLoad& l : stage_.loads) {
    if (!l.follower) continue;
    for (const ParticleId p : l.particles) {
      const Assembly::Block K = stiffness_.assembly.in_axes(p, p, follower_block(l, p));
      const ParticleId c = unknowns_.carrier(p);
      for (int a = 0; a < 6; ++a)
        for (int b = 0; b < 6; ++b) {
          const int row = unknowns_.of(c, a), column = unknowns_.of(c, b);
          if (row != Unknowns::held && column != Unknowns::held)
            entry(row, column, 0.5 * (K(a, b) - K(b, a)));
        }
    }
  }
}

/// The moment that acts on a particle from outside and has no potential: applied, or the reaction of a held
/// turn; along the axes of its turns. Zero with fewer than two free turns, which then have nothing to be
/// antisymmetric with. A rigid support that holds one turn does so where nothing turns it.
Vec3d StaticBody::outside_moment(ParticleId p, const Loads& applied) const {
  constexpr double most_bonds = 16.0;  // of a particle, whose rounding may add up
  int free = 0;
  for (int dof = 3; dof < 6; ++dof) free += unknowns_.of(p, dof) != Unknowns::held;
  if (free < 2) return {};
  const auto about = [&](int k, const Vec3d& m) { return unknowns_.along(p, 3 + k, {{}, m}); };
  Vec3d m{about(0, applied.M[p]), about(1, applied.M[p]), about(2, applied.M[p])};
  if (free == 3 || unknowns_.arm(p) != nullptr) return m;
  const Loaded& l = loads_at_hand();
  const double rounding = unknowns_.length() * std::max(1e-9 * l.largest, most_bonds * rounding_of_force_);
  for (int k = 0; k < 3; ++k) {
    const double reaction = about(k, l.loads.M[p]);
    const bool more_than_rounding = std::abs(reaction) > rounding;
    if (unknowns_.of(p, 3 + k) == Unknowns::held && more_than_rounding) component(m, k) -= reaction;
  }
  return m;
}

Loads StaticBody::applied_loads(double load_factor) const {
  const std::size_t n = model_.particles();
  Loads applied{PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)};
  add_applied(load_factor, applied);
  return applied;
}

Vector StaticBody::applied(double load_factor) const {
  Loads loads = applied_loads(load_factor);
  for (const RestTerm* t : terms_.all()) t->add_applied(load_factor, loads);
  return on_unknowns(loads);
}

double StaticBody::work_of_loads(const Placement& from, const Placement& to, double load_factor) const {
  const Loads applied = applied_loads(load_factor);
  double work = 0.0;
  for (const ParticleId p : from.r.ids())
    work += dot(applied.F[p], to.r[p] - from.r[p]) +
            dot(applied.M[p], rotation_vector(to.q[p] * conjugate(from.q[p])));
  for (const RestTerm* t : terms_.all()) work += t->work(from, to, load_factor);
  return work;
}

double StaticBody::work_of_relief(const Placement& from, const Placement& to, double load_factor) const {
  if (relief_.forces.size() == 0) return 0.0;
  double work = 0.0;
  for (const ParticleId p : from.r.ids()) {
    const Movement relief = unknowns_.along_own(p, relief_.forces);
    work -= (1.0 - load_factor) *
            (dot(relief.shift, seat(p, to) - seat(p, from)) +
             unknowns_.length() * dot(relief.turn, rotation_vector(to.q[p] * conjugate(from.q[p]))));
  }
  return work;
}

/// Of what a support holds of a particle along these axes.
void StaticBody::add_power(const Support& support, ParticleId p, const HeldDofs& held, const HeldAxes* axes,
                           double& power) const {
  const Loads& loads = loads_at_hand().loads;
  const Vec3d rate = rate_of(support, p);
  if (is_free_grip(support)) {  // what its particles do to each other does no work
    power -= dot(loads.F[p], rate) + dot(loads.M[p], support.angular_velocity);
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &along = axis_of(axes, k), &about = axis_of(axes, k + 3);
    if (held[k]) power -= dot(loads.F[p], along) * dot(rate, along);
    if (held[k + 3]) power -= dot(loads.M[p], about) * dot(support.angular_velocity, about);
  }
}

double StaticBody::power_of(const Support& support) const {
  double power = 0.0;
  for (const ParticleId p : support.particles)
    add_power(support, p, support.held, support.axes ? &*support.axes : nullptr, power);
  return power;
}

double StaticBody::reaction_along_motion(const Support& support) const {
  if (support.velocity == Vec3d{} || support.angular_velocity == Vec3d{})
    return power_of(support) / way_of(support);
  Support shifted = support;  // of what both do the part of the displacement: turning about a pivot is none
  shifted.angular_velocity = {}, shifted.rigid = false;
  return power_of(shifted) / way_of(shifted);
}

double StaticBody::power_of_supports() const {
  std::vector<double> power(stage_.supports.size(), 0.0);
  for (const Hold& h : holds_)
    add_power(stage_.supports[h.support], h.particle, h.held, h.axes.get(), power[h.support]);
  return std::accumulate(power.begin(), power.end(), 0.0);
}

double StaticBody::share_held(const Support& s) const {
  constexpr double rounding = 1e3;
  const Loaded& l = loads_at_hand();
  double largest = 0.0;
  for (const ParticleId p : s.particles)
    for (int dof = 0; dof < 6; ++dof)
      if (s.held[static_cast<std::size_t>(dof)]) {
        const Movement load{l.loads.F[p], l.loads.M[p] / unknowns_.length()};
        const HeldAxes* axes = s.axes ? &*s.axes : nullptr;
        const Vec3d& axis = axis_of(axes, static_cast<std::size_t>(dof));
        largest = larger(largest, std::abs(dot(dof < 3 ? load.shift : load.turn, axis)));
      }
  return largest <= rounding * rounding_of_force_ ? 0.0 : largest / l.largest;
}

Reaction StaticBody::reaction(const std::vector<ParticleId>& particles) const {
  const Loads& loads = loads_at_hand().loads;
  const std::vector<HeldPart> floating =
      floating_held(stage_);  // which bear what fades, and nothing of a support
  const auto floats = [&floating](ParticleId p, int dof) {
    return std::any_of(floating.begin(), floating.end(),
                       [=](const HeldPart& part) { return part.particle == p && part.dof == dof; });
  };
  Reaction r;
  for (const ParticleId p : particles) {
    const Movement load{loads.F[p], loads.M[p]};
    Movement held;
    for (int dof = 0; dof < 6; ++dof)
      if (unknowns_.arm(p) != nullptr || (unknowns_.of(p, dof) == Unknowns::held && !floats(p, dof)))
        unknowns_.add(p, dof, -unknowns_.along(p, dof, load), held);
    const Vec3d &F = held.shift, &M = held.turn;
    r.force += F;
    r.moment += M + cross(state_.r[p], F);
  }
  return r;
}

}  // namespace vbond
