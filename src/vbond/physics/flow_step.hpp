#pragma once
#include "vbond/physics/flowing.hpp"

/// What a step does to the memory of a flowing bond: creep, yield, damage, in this order.
namespace vbond {

/// Adds to a number of the memory.
template <FlowingLaw Law, Scalar T>
VBOND_HD void add_to(LawHistory<Law>& h, std::size_t k, const T& x) {
  h.value[k] = h.value[k] + x;
}

/// Speed of creep over N.
template <Scalar T>
VBOND_HD T creep_per_force(const Creep& rule, const T& N) {
  const T size = larger(N, -N);
  T g(rule.rate);
  for (std::size_t k = 1; k < rule.exponent; ++k) g = g * size;
  return g;
}
/// Creep along the axis. What it dissipates is the mean tension times what it adds.
template <FlowingLaw Law, Scalar T>
VBOND_HD void creep(const Law& m, const T& D, const T& D_before, const T& dt, LawHistory<Law>& h) {
  const Creep& rule = m.rules->creep;
  const T half(0.5), c = m.B1, N_0 = tension(m, D_before, h), N_trial = tension(m, D, h);
  const T N_half = half * (N_0 + N_trial);
  const T u_half = crept(creep_per_force(rule, N_0), c, N_0, N_half, half * dt);
  const T u = crept(creep_per_force(rule, N_half - c * u_half), c, N_0, N_trial, dt);
  add_to<Law>(h, memory::crept, u);
  add_to<Law>(h, memory::dissipated, half * (N_0 + tension(m, D, h)) * u);
}

/// The mean of a limit while it grows, times the amount of flow: what is dissipated.
template <Scalar T>
VBOND_HD T dissipated_by(const T& limit, double growth, const T& x) {
  return (limit + T(0.5 * growth) * x) * x;
}

template <FlowingLaw Law, Scalar T>
VBOND_HD void yield_along_axis(const Law& m, const T& D, LawHistory<Law>& h) {
  const Yield& rule = m.rules->yield;
  const double grow = rule.isotropic.axial, back = rule.kinematic.axial;
  const T zero(0.0), one(1.0), a = rest_length<Law, T>(m, h), shift = T(back) * h.value[memory::stretch];
  const T over = tension(m.about(a), D) - shift, sign = where_greater(over, zero, one, -one);
  const T limit =
      where_greater(over, zero, T(rule.limit.axial), T(rule.compression)) + T(grow) * h.value[memory::axial];
  FlowAmount<T> flow(m.B1 + T(grow + back), m.a);
  for (int k = 0; k < most_flow_corrections; ++k) {
    const T f = sign * (tension(m.about(a + sign * flow.x), D) - shift) - limit - T(grow + back) * flow.x;
    if (!any_greater(flow.off(f), T(flow_tolerance) * limit)) break;
    flow.correct(f, T(flow_tolerance) * limit);
  }
  add_to<Law>(h, memory::stretch, sign * flow.x);
  add_to<Law>(h, memory::axial, flow.x);
  add_to<Law>(h, memory::dissipated, dissipated_by(limit, grow, flow.x));
}

/// Shear force, bending moment and torque at the middle of a bond, without damage.
template <Scalar T>
struct MiddleLoads {
  Vec3<T> V, M_b;
  T M_t;
};
template <FlowingLaw Law, Scalar T>
VBOND_HD MiddleLoads<T> middle_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                     const FlowTurns<T>& turns) {
  const BondLoads<T> l = undamaged_loads(m, b, axis, axis.D, turns);
  const Vec3<T> M = T(0.5) * (l.M_ij - l.M_ji);
  const T M_t = dot(M, axis.d);
  return {across(l.F, axis.d), M - M_t * axis.d, M_t};
}
/// a / |a|, or nothing of nothing.
template <Scalar T>
VBOND_HD Vec3<T> direction_of(const Vec3<T>& a) {
  const T zero(0.0), size = norm(a);
  return (T(1.0) / where_greater(size, zero, size, T(1.0))) * a;
}

/// A small rotation vector of the world, in these axes.
template <Scalar T>
VBOND_HD Quat<T> small_turn(const Axes<T>& n, const Vec3<T>& turn) {
  return rotation_by_quarter(T(0.25) * Vec3<T>{dot(n.x, turn), dot(n.y, turn), dot(n.z, turn)});
}
/// Frames turned on by s + k/2 (i) and s - k/2 (j).
template <Scalar T>
VBOND_HD FlowTurns<T> turned_on(const BondPose<T>& b, const FlowTurns<T>& turns, const Vec3<T>& k,
                                const Vec3<T>& s) {
  const T half(0.5);
  return {small_turn(frame_of_i(b), s + half * k) * turns.i,
          small_turn(frame_of_j(b), s - half * k) * turns.j};
}

/// A way of flowing across the axis: its limit, and how much it flows.
template <Scalar T>
struct FlowChannel {
  bool flows;
  double grow, all;  ///< growth of the limit per flow, and with the shift
  T limit;
  FlowAmount<T> flow;

  VBOND_HD FlowChannel(double given, double isotropic, double kinematic, const T& amount, const T& slope,
                       const T& longest)
      : flows(given > 0.0),
        grow(isotropic),
        all(isotropic + kinematic),
        limit(T(given) + T(isotropic) * amount),
        flow(slope + T(isotropic + kinematic), longest) {}
  /// By how much the load is over its limit.
  VBOND_HD T over(const T& load) const { return load - limit - T(all) * flow.x; }
  VBOND_HD bool is_off(const T& f) const {
    return flows && any_greater(flow.off(f), T(flow_tolerance) * limit);
  }
  VBOND_HD void correct(const T& f) {
    if (flows) flow.correct(f, T(flow_tolerance) * limit);
  }
  VBOND_HD T dissipated() const { return dissipated_by(limit, grow, flow.x); }
};

/// Puts a turn into the memory of those that flowed.
template <FlowingLaw Law, Scalar T>
VBOND_HD void keep_turn(LawHistory<Law>& h, std::size_t k, const T& flow, const Quat<T>& q) {
  const T zero(0.0);
  const Vec3<T> turn = quarter_of_rotation(q);
  h.value[k] = where_greater(flow, zero, turn.x, h.value[k]);
  h.value[k + 1] = where_greater(flow, zero, turn.y, h.value[k + 1]);
  h.value[k + 2] = where_greater(flow, zero, turn.z, h.value[k + 2]);
}

/// Flow in bending, torsion and shear, each along the direction in which its load is over its limit at first.
template <FlowingLaw Law, Scalar T>
VBOND_HD void yield_across_axis(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                LawHistory<Law>& h) {
  const Yield& rule = m.rules->yield;
  const T one(1.0), quarter(0.25);  // rad, in a correction
  const FlowTurns<T> before = turns_of<Law>(h);
  MiddleLoads<T> l = middle_loads(m, b, axis, before);

  // moments that kinematic hardening has shifted the limits by; bending in axes that go with both particles
  const BondPose<T> turned = turned_pose(b, axis.D * axis.d, before);
  const Vec3<T> e_2 = direction_of(across(turned.n_i[1] + turned.n_j[1], axis.d)), e_3 = cross(axis.d, e_2);
  const Vec3<T> shift_b =
      T(rule.kinematic.bending) * (h.value[memory::bent] * e_2 + h.value[memory::bent + 1] * e_3);
  const T shift_t = T(rule.kinematic.torsion) * h.value[memory::twisted];
  const Vec3<T> e_b = direction_of(l.M_b - shift_b), e_v = direction_of(l.V);
  const T sign = where_greater(l.M_t, shift_t, one, -one);

  const BondStiffness<T> c = stiffness(m);
  const FlowLimits &limit = rule.limit, &grow = rule.isotropic, &back = rule.kinematic;
  FlowChannel<T> bend(limit.bending, grow.bending, back.bending, h.value[memory::bending], c.c_B, quarter);
  FlowChannel<T> twist(limit.torsion, grow.torsion, back.torsion, h.value[memory::torsion], c.c_T, quarter);
  FlowChannel<T> slide(limit.shear, grow.shear, 0.0, h.value[memory::shear], c.c_D, quarter * axis.D);
  FlowTurns<T> now = before;
  for (int k = 0; k < most_flow_corrections; ++k) {
    const T f_b = bend.over(dot(l.M_b - shift_b, e_b)), f_t = twist.over(sign * (l.M_t - shift_t)),
            f_v = slide.over(dot(l.V, e_v));
    if (!bend.is_off(f_b) && !twist.is_off(f_t) && !slide.is_off(f_v)) break;
    bend.correct(f_b), twist.correct(f_t), slide.correct(f_v);
    now = turned_on(b, before, bend.flow.x * e_b + (sign * twist.flow.x) * axis.d,
                    (slide.flow.x * axis.per_D) * cross(axis.d, e_v));
    l = middle_loads(m, b, axis, now);
  }

  const T x_b = bend.flow.x, x_t = twist.flow.x, x_v = slide.flow.x;
  keep_turn<Law>(h, memory::turn_i, x_b + x_t + x_v, now.i);
  keep_turn<Law>(h, memory::turn_j, x_b + x_t + x_v, now.j);
  add_to<Law>(h, memory::bending, x_b);
  add_to<Law>(h, memory::torsion, x_t);
  add_to<Law>(h, memory::shear, x_v);
  add_to<Law>(h, memory::bent, x_b * dot(e_b, e_2));
  add_to<Law>(h, memory::bent + 1, x_b * dot(e_b, e_3));
  add_to<Law>(h, memory::twisted, sign * x_t);
  add_to<Law>(h, memory::dissipated, bend.dissipated() + twist.dissipated() + slide.dissipated());
}

/// Damage by stretching to the length axis.D. Along the axis it dissipates the triangle between the secants
/// before and after; of the other energies what it takes of their mean over the step.
template <FlowingLaw Law, Scalar T>
VBOND_HD void soften(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis, const BondRates<T>& rates,
                     const T& dt, LawHistory<Law>& h) {
  const Softening& rule = m.rules->softening;
  const T zero(0.0), half(0.5), one(1.0), before = h.value[memory::damage];
  const T a = rest_length<Law, T>(m, h), u = axis.D - a, c = m.B1, factor = one + m.weakness;
  const T N_c = T(rule.force) / factor, u_c = N_c / c, u_f = T(rule.length) * factor, k = N_c / (u_f - u_c);
  const T left = larger(u_f - u, zero), size = where_greater(u, u_c, u, u_c);
  const T now = larger(before, where_greater(u, u_c, one - k * left / (c * size), zero)), more = now - before;
  if (!any_greater(more, zero)) return;
  h.value[memory::damage] = now;
  const T u_before = k * u_f / (k + c * (one - before)), u_now = u_f - left;
  const FlowTurns<T> turns = turns_of<Law>(h);
  const BondEnergy<T> U = bond_energy(m.about(a), turned_pose(b, axis.D * axis.d, turns));
  const BondLoads<T> l = undamaged_loads(m, b, axis, a, turns);
  const Vec3<T> V = across(l.F, axis.d);
  const BondLoads<T> others{V, l.M_ij + m.R_i * cross(b.n_i[0], V), l.M_ji - m.R_j * cross(b.n_j[0], V)};
  const T mean = U.U_B + U.U_T - half * dt * power_taken(others, rates);
  add_to<Law>(h, memory::dissipated, more * (half * c * u_before * u_now + mean));
}

template <FlowingLaw Law, Scalar T>
VBOND_HD LawHistory<Law> advance(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const BondRates<T>& rates, const T& dt, const LawHistory<Law>& before) {
  LawHistory<Law> h = before;
  const BondRules& rules = *m.rules;
  if (rules.creep.rate > 0.0)
    creep(m, axis.D, axis.D - dt * section_rates(b, m.R_i, m.R_j, axis, rates).v_n, dt, h);
  if (rules.yield.stretches()) yield_along_axis(m, axis.D, h);
  if (rules.yield.turns()) yield_across_axis(m, b, axis, h);
  if (rules.softening.any()) soften(m, b, axis, rates, dt, h);
  return h;
}

}  // namespace vbond
