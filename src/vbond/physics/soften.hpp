#pragma once
#include "vbond/physics/flow.hpp"
#include "vbond/physics/section.hpp"
#include "vbond/physics/with_flow.hpp"

/// Damage of bonds that soften, for tensions of any shape.
namespace vbond {

/// The elongation x > 0 of a bond from rest at which `whole` times its tension is N_0 - k x; it is below
/// `most`. Closed for laws that stretch linearly; of others by the Illinois form of the false position: at
/// most 19 evaluations where the slope grows to 150 times that at rest. A lane that is done does not change
/// any more.
template <RuledLaw Law, Scalar T>
VBOND_HD T meets_line(const Law& about, const T& whole, const T& N_0, const T& k, const T& most) {
  const T x_0 = N_0 / (k + axial_stiffness(about) * whole);
  if constexpr (tension_is_linear<typename Law::Elastic>) {
    return x_0;
  } else {
    const auto above = [&](const T& x) { return whole * tension(about, about.a + x) + k * x - N_0; };
    const T zero(0.0), half(0.5), one(1.0), within = T(flow_tolerance) * N_0;
    T low = zero, high = most, f_low = -N_0, f_high = above(most), side = zero;
    T x = where_greater(most, x_0, x_0, most), f = above(x);
    for (int n = 0; n < most_meetings; ++n) {
      const T off = larger(f, -f);
      if (!any_greater(off, within)) return x;
      f_low = where_greater(f, zero, where_greater(side, zero, half * f_low, f_low), f);
      f_high = where_greater(f, zero, f, where_greater(zero, side, half * f_high, f_high));
      low = where_greater(f, zero, low, x), high = where_greater(f, zero, x, high);
      side = where_greater(f, zero, one, -one);
      x = where_greater(off, within, low - f_low * (high - low) / (f_high - f_low), x);
      f = above(x);
    }
    return known_flow(x, larger(f, -f) - T(flow_lost) * N_0);
  }
}

/// What stretching dissipates per unit of damage between the elongations `before` and `now`, on the line on
/// which the tension of a damaged bond falls by k to zero at u_f. Of laws that stretch linearly it is a
/// triangle between two secants.
template <RuledLaw Law, Scalar T>
VBOND_HD T stretching_lost(const Law& about, const T& k, const T& u_f, const T& before, const T& now,
                           const T& damage_before, const T& damage_now) {
  const T zero(0.0), half(0.5), one(1.0);
  if constexpr (tension_is_linear<typename Law::Elastic>) {
    return half * axial_stiffness(about) * before * now;
  } else {
    const T stored_before = (one - damage_before) * stretch_energy(about, about.a + before),
            stored_now = (one - damage_now) * stretch_energy(about, about.a + now);
    const T more = damage_now - damage_before, work = half * k * (sq(u_f - before) - sq(u_f - now));
    return (stored_before + work - stored_now) / where_greater(more, zero, more, one);
  }
}

/// Damage by stretching to the length axis.D, so that the tension falls along a line. Of the energies of
/// bending, shear and torsion it dissipates its part of their mean over the step.
template <FlowingLaw Law, Scalar T>
VBOND_HD void soften(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis, const BondRates<T>& rates,
                     const T& dt, LawHistory<Law>& h) {
  const Softening& rule = m.rules->softening;
  const T zero(0.0), half(0.5), one(1.0), before = h.value[memory::damage];
  const T a = rest_length<Law, T>(m, h), u = axis.D - a, factor = one + m.weakness;
  const auto about = m.about(a);
  const T N_c = T(rule.force) / factor, u_f = T(rule.length) * factor;
  const T u_c = meets_line(about, one, N_c, zero, u_f);
  const T k = N_c / (u_f - u_c), left = larger(u_f - u, zero);
  const T N = tension(about, where_greater(u, u_c, axis.D, a + u_c));
  // asked so that an unknown u_c gives no number, which ends the run, and not no damage
  const T now = larger(before, where_greater(u_c, u, zero, one - k * left / N)), more = now - before;
  h.value[memory::damage] = now;
  if (!any_greater(more, zero)) return;
  const T u_before = meets_line(about, one - before, k * u_f, k, u_f), u_now = u_f - left;
  const FlowTurns<T> turns = turns_of<Law>(h);
  const BondEnergy<T> U = bond_energy(about, turned_pose(b, axis.D * axis.d, turns));
  const BondLoads<T> l = undamaged_loads(m, b, axis, a, turns);
  const Vec3<T> V = across(l.F, axis.d);
  const BondLoads<T> others{V, l.M_ij + m.R_i * cross(b.n_i[0], V), l.M_ji - m.R_j * cross(b.n_j[0], V)};
  const T mean = U.U_B + U.U_T - half * dt * power_taken(others, rates);
  add_to<Law>(h, memory::dissipated,
              more * (stretching_lost(about, k, u_f, u_before, u_now, before, now) + mean));
}

}  // namespace vbond
