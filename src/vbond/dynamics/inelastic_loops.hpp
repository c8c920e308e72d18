// Loops over bonds of laws that are more than elastic: that damp, remember or break. For bond_loops.hpp.
#pragma once
#include <cstddef>
#include <cstdint>

#include "vbond/dynamics/pack_lanes.hpp"
#include "vbond/physics/far_from_breaking.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

/// The sum over unbroken bonds, always in this order.
VBOND_HD void add_active(const Real& x, PackLanes in_use, std::size_t l, double& sum) {
  double all = sum;  // in place each addition would wait for the store of the one before
  for (std::size_t k = 0; k < lanes; ++k)
    if (in_use.has(l + k)) all += x.v[k];
  sum = all;
}

/// What these damping loads take at these rates, in the order of DampedPower::causes. Bond after bond: sums
/// of each lane would depend on how many bonds had broken when the packs were made, as of a run that goes on.
template <class L>
VBOND_HD void add_powers(const L& law, const BondPose<Real>& b, const BondAxis<Real>& axis,
                         const BondRates<Real>& rates, const BondLoads<Real>& damping, PackLanes in_use,
                         std::size_t l, DampedPower& sum) {
  if constexpr (requires { damping_powers(law, b, axis, rates); }) {
    const DampingPowers<Real> taken = damping_powers(law, b, axis, rates);
    const Real zero(0.0);
    Halves by_channel = {taken.axial, taken.shear, taken.bending, taken.torsion};
    const Halves nothing = {zero, zero, zero, zero};
    transpose_halves(by_channel);
    Real all[8 / lanes];  // not in place: see add_active()
    for (std::size_t part = 0; part < 8 / lanes; ++part) all[part] = Real::load(sum.of + part * lanes);
    for (std::size_t k = 0; k < lanes; ++k) {
      if (!in_use.has(l + k)) continue;
      Real row[8 / lanes];
      whole_row(by_channel, nothing, k, row);
      for (std::size_t part = 0; part < 8 / lanes; ++part) all[part] = all[part] + row[part];
    }
    for (std::size_t part = 0; part < 8 / lanes; ++part) all[part].store(sum.of + part * lanes);
  } else {
    add_active(power_taken(damping, rates), in_use, l, sum.of[4]);
  }
}

/// Numbers of what the bonds of a pack remember, lanes side by side.
template <class L, class P>
VBOND_HD double* remembered(const PackRun<P>& run, std::size_t pack, std::size_t number, std::size_t l) {
  return run.history + (pack * history_of<L> + number) * pack_bonds + l;
}

/// What the bonds in lanes l, l + 1 .. remember, without a step between.
template <class L, class P>
VBOND_HD LawHistory<L> history_of_lanes(const PackRun<P>& run, std::size_t pack, std::size_t l) {
  LawHistory<L> history;
  for (std::size_t n = 0; n < history_of<L>; ++n)
    history.value[n] = Real::load(remembered<L>(run, pack, n, l));
  return history;
}

VBOND_HD Real total(const BondEnergy<Real>& U) {
  return U.U_L + U.U_B + U.U_T;
}

/// What a step of the history of bonds has dissipated.
template <class L>
VBOND_HD Real dissipated_between(const L& law, const BondPose<Real>& b, const LawHistory<L>& before,
                                 const LawHistory<L>& now) {
  if constexpr (requires { L::dissipated_at; })
    return now.value[L::dissipated_at] - before.value[L::dissipated_at];
  else
    return total(bond_energy(law, b, before)) - total(bond_energy(law, b, now));
}

/// What the bonds remember after a step, which the pack keeps, and their elastic loads then.
template <class L, class P>
VBOND_HD Advanced<L> advance_lanes(const PackRun<P>& run, std::size_t pack, std::size_t l, const L& law,
                                   const BondPose<Real>& b, const BondAxis<Real>& axis,
                                   const BondRates<Real>& rates, BondSweep& sweep) {
  const LawHistory<L> before = history_of_lanes<L>(run, pack, l);
  if constexpr (Remembering<L>) {
    if (sweep.dt != 0.0) {
      const Advanced<L> now = advance_with_loads(law, b, axis, rates, Real(sweep.dt), before);
      for (std::size_t n = 0; n < history_of<L>; ++n)
        now.history.value[n].store(remembered<L>(run, pack, n, l));
      const Real lost = dissipated_between(law, b, before, now.history);
      add_active(lost, run.lanes[pack], l, sweep.dissipated);
      if constexpr (!HasRules<L>) add_active(lost, run.lanes[pack], l, sweep.by_other_laws);
      return now;
    }
  }
  return {before, loads_with(law, b, axis, before)};
}

/// The lanes of unbroken bonds that break by these elastic loads, a bit each.
template <class L>
VBOND_HD unsigned breaking_lanes(const L& law, const BondPose<Real>& b, const BondAxis<Real>& axis,
                                 const BondLoads<Real>& loads, const LawHistory<L>& history,
                                 unsigned active) {
  const Real one(1.0);
  if constexpr (requires { utilisation_bound(law, b, axis, loads, history); })
    if ((lanes_at_least(utilisation_bound(law, b, axis, loads, history), one) & active) == 0) return 0;
  return lanes_at_least(utilisation_with(law, b, axis, loads, history), one) & active;
}

// From here to add_inelastic() what one function has worked out is an argument of the next, never a variable:
// compilers copy structs of packs number by number, and then wait for them. With AVX2 bonds with a strength
// take 0.7 of the time that they take with variables.

/// Adds the loads of damping to rows of their own, which the step adds to the others once they are complete,
/// and what they take. So the elastic loads are out of the way before these are worked out.
template <class L, class P>
VBOND_HD void add_damped_loads(const P& p, PackLanes in_use, std::size_t l, const L& law,
                               const BondPose<Real>& b, const BondAxis<Real>& axis,
                               const BondRates<Real>& rates, const BondLoads<Real>& damping,
                               BondSweep& sweep) {
  if (sweep.damped != nullptr) add_powers(law, b, axis, rates, damping, in_use, l, *sweep.damped);
  add_lanes(p, in_use, l, damping, sweep.damping);
}

/// Adds these elastic loads of the bonds in lanes l, l + 1 .. and their damping. Returns the lanes that
/// break.
template <bool damped, class L, class P>
VBOND_HD unsigned add_lanes_with_loads(const PackRun<P>& run, std::size_t pack, std::size_t l, const L& law,
                                       const BondPose<Real>& b, const BondAxis<Real>& axis,
                                       const BondRates<Real>& rates, const LawHistory<L>& history,
                                       const BondLoads<Real>& loads, BondSweep& sweep) {
  const P& p = run.packs[pack];
  const PackLanes in_use = run.lanes[pack];
  unsigned broken = 0;
  if constexpr (Breakable<L>)
    if (run.type->breakable)
      broken = breaking_lanes(law, b, axis, loads, history, unsigned{in_use.active} >> l) << l;
  add_lanes(p, in_use, l, loads, sweep.load);
  if constexpr (damped)
    add_damped_loads(p, in_use, l, law, b, axis, rates, bond_damping(law, b, axis, rates), sweep);
  return broken;
}

template <bool damped, class L, class P>
VBOND_HD unsigned add_lanes_with_rates(const PackRun<P>& run, std::size_t pack, std::size_t l, const L& law,
                                       const BondPose<Real>& b, const BondAxis<Real>& axis,
                                       const BondRates<Real>& rates, BondSweep& sweep) {
  if constexpr (Remembering<L>) {
    const Advanced<L> now = advance_lanes(run, pack, l, law, b, axis, rates, sweep);
    return add_lanes_with_loads<damped>(run, pack, l, law, b, axis, rates, now.history, now.loads, sweep);
  } else {
    return add_lanes_with_loads<damped>(run, pack, l, law, b, axis, rates, LawHistory<L>{},
                                        bond_loads(law, b, axis), sweep);
  }
}

template <bool damped, class L, class P>
VBOND_HD unsigned add_lanes_with_axis(const PackRun<P>& run, std::size_t pack, std::size_t l, const L& law,
                                      const BondPose<Real>& b, const BondAxis<Real>& axis, BondSweep& sweep) {
  if constexpr (damped || Remembering<L>)
    return add_lanes_with_rates<damped>(run, pack, l, law, b, axis, rates_of(run.packs[pack], sweep.rates, l),
                                        sweep);
  else
    return add_lanes_with_rates<damped>(run, pack, l, law, b, axis, BondRates<Real>{}, sweep);
}

template <bool damped, class L, class P>
VBOND_HD unsigned add_lanes_with_pose(const PackRun<P>& run, std::size_t pack, std::size_t l, const L& law,
                                      const BondPose<Real>& b, BondSweep& sweep) {
  return add_lanes_with_axis<damped>(run, pack, l, law, b, bond_axis(law, b), sweep);
}

template <template <class> class Law, bool damped, class P>
VBOND_HD void add_inelastic(const PackRun<P>& run, std::size_t pack, BondSweep& sweep) {
  const P& p = run.packs[pack];
  unsigned broken = 0;
  for (std::size_t l = 0; l < pack_bonds; l += lanes)
    broken |= add_lanes_with_pose<damped>(run, pack, l, law_of<Law>(p, *run.type, l),
                                          pose_of(p, sweep.pose, l), sweep);
  if (sweep.broken != nullptr) sweep.broken[pack] = static_cast<std::uint8_t>(broken);
}

}  // namespace
}  // namespace vbond::VBOND_KERNEL
