#pragma once
#include <array>
#include <cstddef>
#include <string_view>

#include "vbond/physics/flow.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/ruled.hpp"
#include "vbond/physics/section.hpp"

namespace vbond {

/// Where a flowing bond keeps what it remembers: the numbers of Flowing::history.
namespace memory {
inline constexpr std::size_t stretch = 0, crept = 1;  // what the length at rest has grown by  [length]
inline constexpr std::size_t turn_i = 2, turn_j = 5;  // of the frames: rotation_by_quarter, in their own axes
inline constexpr std::size_t axial = 8, shear = 9, bending = 10, torsion = 11;  // sums of all amounts of flow
inline constexpr std::size_t bent = 12, twisted = 14;  // bending and twist that have flowed, with their signs
inline constexpr std::size_t damage = 15;              // 0 to 1
inline constexpr std::size_t dissipated = 16;          // [energy]
inline constexpr std::size_t count = 17;
}  // namespace memory

/// A law with rules whose state of rest moves: its length at rest grows, its frames turn, and damage takes
/// away from its energy. The energy itself stays that of the law with rules: see docs/theory.md.
template <class Law, template <class> class ElasticLaw, template <class> class RuledLaw, Scalar T>
struct Flowing : Ruled<Law, ElasticLaw, T> {
  using Inner = RuledLaw<T>;
  static constexpr std::array<std::string_view, memory::count> history{
      "stretch",    "creep",      "turn_i_1",      "turn_i_2",   "turn_i_3",     "turn_j_1",
      "turn_j_2",   "turn_j_3",   "axial_flow",    "shear_flow", "bending_flow", "torsion_flow",
      "plastic_b2", "plastic_b3", "plastic_twist", "damage",     "dissipated"};
  static constexpr std::size_t dissipated_at = memory::dissipated;

  /// The law about its present rest, between the bonded points.
  VBOND_HD Inner about(const T& rest_length) const {
    Inner law{};
    law.a = rest_length, law.R_i = T(0.0), law.R_j = T(0.0);
    law.B1 = this->B1, law.B2 = this->B2, law.B3 = this->B3, law.B4 = this->B4;
    law.rules = this->rules;
    return law;
  }
};

template <Scalar T>
struct FlowingVModel : Flowing<FlowingVModel<T>, VModel, RuledVModel, T> {
  static constexpr std::string_view name = "v-model-with-flow", title = "V-model";
};
template <Scalar T>
struct FlowingEvm : Flowing<FlowingEvm<T>, Evm, RuledEvm, T> {
  static constexpr std::string_view name = "evm-with-flow", title = "enhanced vector model (EVM)";
};

template <class Law>
concept FlowingLaw = HasRules<Law> && Remembering<Law>;

/// The frames of a bond as flow has turned them against its particles.
template <Scalar T>
struct FlowTurns {
  Quat<T> i, j;
};
/// Three numbers of the memory, as a vector.
template <FlowingLaw Law>
VBOND_HD auto vector_at(const LawHistory<Law>& h, std::size_t k) {
  return Vec3<typename Law::Number>{h.value[k], h.value[k + 1], h.value[k + 2]};
}
template <FlowingLaw Law>
VBOND_HD auto turns_of(const LawHistory<Law>& h) {
  return FlowTurns<typename Law::Number>{rotation_by_quarter(vector_at<Law>(h, memory::turn_i)),
                                         rotation_by_quarter(vector_at<Law>(h, memory::turn_j))};
}

/// Axes x, y, z turned by q, which is given in these axes.
template <Scalar T>
VBOND_HD void turn_axes(const Quat<T>& q, const Axes<T>& n, Vec3<T> (&to)[3]) {
  const Axes<T> R = axes(q);
  to[0] = R.x.x * n.x + R.x.y * n.y + R.x.z * n.z;
  to[1] = R.y.x * n.x + R.y.y * n.y + R.y.z * n.z;
  to[2] = R.z.x * n.x + R.z.y * n.y + R.z.z * n.z;
}
/// The frames of a pose, both right-handed.
template <Scalar T>
VBOND_HD Axes<T> frame_of_i(const BondPose<T>& b) {
  return {b.n_i[0], b.n_i[1], b.n_i[2]};
}
template <Scalar T>
VBOND_HD Axes<T> frame_of_j(const BondPose<T>& b) {
  return {-b.n_j[0], b.n_j[1], b.n_j[2]};
}

/// The pose of the bond itself: between its bonded points, where the particles hold it, with turned frames.
/// What follows of it is for R_i = R_j = 0.
template <Scalar T>
VBOND_HD BondPose<T> turned_pose(const BondPose<T>& b, const Vec3<T>& D_ij, const FlowTurns<T>& turns) {
  BondPose<T> p;
  p.r_ij = D_ij;
  turn_axes(turns.i, frame_of_i(b), p.n_i);
  turn_axes(turns.j, frame_of_j(b), p.n_j);
  p.n_j[0] = -p.n_j[0];
  return p;
}

template <FlowingLaw Law, Scalar T>
VBOND_HD T rest_length(const Law& m, const LawHistory<Law>& h) {
  return m.a + (h.value[memory::stretch] + h.value[memory::crept]);
}

/// The pose by which the range of a bond is judged: elastic angles, and the length less what has flowed.
template <FlowingLaw Law, Scalar T>
VBOND_HD BondPose<T> elastic_pose(const Law& m, const BondPose<T>& b, const LawHistory<Law>& h) {
  const Vec3<T> D_ij = bonded_points(b, m.R_i, m.R_j);
  const T flowed = h.value[memory::stretch] + h.value[memory::crept];
  return turned_pose(b, D_ij - (flowed / norm(D_ij)) * D_ij, turns_of<Law>(h));
}

// ---- energy and loads ------------------------------------------------------------------------------

/// Damage weakens all but compression along the axis.
template <FlowingLaw Law, Scalar T>
VBOND_HD T tension(const Law& m, const T& D, const LawHistory<Law>& h) {
  const T N = tension(m.about(rest_length<Law, T>(m, h)), D);
  return where_greater(N, T(0.0), N - h.value[memory::damage] * N, N);
}
template <FlowingLaw Law, Scalar T>
VBOND_HD T stretch_energy(const Law& m, const T& D, const LawHistory<Law>& h) {
  const T a = rest_length<Law, T>(m, h), U = stretch_energy(m.about(a), D);
  const T stored = T(0.5 * m.rules->yield.kinematic.axial) * sq(h.value[memory::stretch]);
  return where_greater(D, a, U - h.value[memory::damage] * U, U) + stored;
}

template <FlowingLaw Law, Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Law& m, const BondPose<T>& b, const LawHistory<Law>& h) {
  const Vec3<T> D_ij = bonded_points(b, m.R_i, m.R_j);
  const BondEnergy<T> U =
      bond_energy(m.about(rest_length<Law, T>(m, h)), turned_pose(b, D_ij, turns_of<Law>(h)));
  const FlowLimits& back = m.rules->yield.kinematic;
  const T whole = T(1.0) - h.value[memory::damage];
  const T bent2 = sq(h.value[memory::bent]) + sq(h.value[memory::bent + 1]);
  return {stretch_energy(m, norm(D_ij), h), whole * U.U_B + T(0.5 * back.bending) * bent2,
          whole * U.U_T + T(0.5 * back.torsion) * sq(h.value[memory::twisted])};
}

/// Elastic loads about the bonded points, without damage.
template <FlowingLaw Law, Scalar T>
VBOND_HD BondLoads<T> undamaged_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                      const T& rest_length, const FlowTurns<T>& turns) {
  return bond_loads(m.about(rest_length), turned_pose(b, axis.D * axis.d, turns), axis);
}

template <FlowingLaw Law, Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const LawHistory<Law>& h) {
  const T damage = h.value[memory::damage], whole = T(1.0) - damage, zero(0.0);
  const BondLoads<T> l = undamaged_loads(m, b, axis, rest_length<Law, T>(m, h), turns_of<Law>(h));
  const T N = dot(l.F, axis.d);
  const Vec3<T> F = whole * l.F + where_greater(zero, N, damage * N, zero) * axis.d;
  return {F, whole * l.M_ij + m.R_i * cross(b.n_i[0], F), whole * l.M_ji - m.R_j * cross(b.n_j[0], F)};
}

// the same for a bond that remembers nothing yet
template <FlowingLaw Law, Scalar T>
VBOND_HD T stretch_energy(const Law& m, const T& D) {
  return stretch_energy(m, D, LawHistory<Law>{});
}
template <FlowingLaw Law, Scalar T>
VBOND_HD T tension(const Law& m, const T& D) {
  return tension(m, D, LawHistory<Law>{});
}
template <FlowingLaw Law, Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Law& m, const BondPose<T>& b) {
  return bond_energy(m, b, LawHistory<Law>{});
}
template <FlowingLaw Law, Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return bond_loads(m, b, axis, LawHistory<Law>{});
}

template <FlowingLaw Law, Scalar T>
VBOND_HD Failure<T> bond_failure(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const BondLoads<T>& loads, const LawHistory<Law>& h) {
  const T one(1.0);
  Failure<T> f = failure(m.rules->strength, stiffness(m), b, m.R_i, m.R_j, axis, loads, axis.D / m.a - one,
                         one + m.weakness);
  if (!m.rules->softening.any()) return f;
  f.tension = larger(f.tension, h.value[memory::damage]);
  f.utilisation = larger(f.utilisation, h.value[memory::damage]);
  return f;
}
template <FlowingLaw Law, Scalar T>
VBOND_HD T utilisation(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis, const BondLoads<T>& loads,
                       const LawHistory<Law>& h) {
  return bond_failure(m, b, axis, loads, h).utilisation;
}

// ---- flow in a step --------------------------------------------------------------------------------

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
