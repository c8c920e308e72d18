// The loops over bonds of one law, for the sources that are compiled once per instruction set: see kernel.cpp
// on what they may contain.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>

#include "vbond/dynamics/kernel.hpp"
#include "vbond/dynamics/kernel_rows.hpp"
#include "vbond/dynamics/stretch_lanes.hpp"
#include "vbond/physics/far_from_breaking.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/with_offsets.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

VBOND_HD Quat<Real> quat(const double (&q)[4][pack_bonds], std::size_t l) {
  return {Real::load(q[0] + l), Real::load(q[1] + l), Real::load(q[2] + l), Real::load(q[3] + l)};
}

/// The laws of the bonds in lanes l, l + 1 .. of a pack.
template <template <class> class Law, std::size_t... k>
VBOND_HD Law<Real> law_of(const CompactPack& p, const BondType& t, std::size_t l, std::index_sequence<k...>) {
  const Real scale = Real::load(p.scale + l);
  Law<Real> law;
  law.a = Real::load(p.a + l), law.R_i = Real(t.R_i), law.R_j = Real(t.R_j);
  ((law.*coefficient<Law<Real>, k> = scale * Real(t.coefficients[k])), ...);
  if constexpr (HasRules<Law<Real>>) law.rules = t.rules;
  return law;
}
template <template <class> class Law, std::size_t... k>
VBOND_HD Law<Real> law_of(const FullPack& p, const BondType& t, std::size_t l, std::index_sequence<k...>) {
  Law<Real> law;
  law.a = Real::load(p.a + l), law.R_i = Real::load(p.R_i + l), law.R_j = Real::load(p.R_j + l);
  ((law.*coefficient<Law<Real>, k> = Real::load(p.coefficients[k] + l)), ...);
  if constexpr (HasRules<Law<Real>>) law.rules = t.rules;
  return law;
}
template <template <class> class Law, class P>
VBOND_HD Law<Real> law_of(const P& p, const BondType& t, std::size_t l) {
  return law_of<Law>(p, t, l, std::make_index_sequence<coefficients_of<Law<Real>>>());
}

VBOND_HD BondFrames<Real> frames_of(const CompactPack& p, std::size_t l) {
  const Quat<Real> frame = quat(p.frame, l);
  return {frame, frame};
}
VBOND_HD BondFrames<Real> frames_of(const FullPack& p, std::size_t l) {
  return {quat(p.frame_i, l), quat(p.frame_j, l)};
}

/// The bonds in lanes l, l + 1 .. of a pack as their particles stand.
template <class P>
VBOND_HD BondPose<Real> pose_of(const P& p, const PoseRow* pose, std::size_t l) {
  Halves r;
  load_between(pose, p.i + l, p.j + l, r);
  return bond_pose(frames_of(p, l), {r[0], r[1], r[2]}, load_quats(pose, p.i + l), load_quats(pose, p.j + l));
}

/// Adds the loads of the bonds in lanes l, l + 1 .. of a pack to their rows.
template <class P>
VBOND_HD void add_lanes(const P& p, PackLanes in_use, std::size_t l, const BondLoads<Real>& b,
                        LoadRow* load) {
  const Real zero(0.0);
  Halves F = {b.F.x, b.F.y, b.F.z, zero}, minus_F;
  Halves M_ij = {b.M_ij.x, b.M_ij.y, b.M_ij.z, zero}, M_ji = {b.M_ji.x, b.M_ji.y, b.M_ji.z, zero};
  transpose_halves(F);
  transpose_halves(M_ij);
  transpose_halves(M_ji);
  for (std::size_t k = 0; k < 4; ++k) minus_F[k] = -F[k];
  const std::uint32_t *i = p.i + l, *j = p.j + l;
  if (in_use.to_i == all_lanes && in_use.to_j == all_lanes) {
    for (std::size_t k = 0; k < lanes; ++k) {  // bond after bond: two of them may share a particle
      add_row(F, M_ij, k, numbers(load + i[k]));
      add_row(minus_F, M_ji, k, numbers(load + j[k]));
    }
    return;
  }
  for (std::size_t k = 0; k < lanes; ++k) {  // an earlier end costs the loop above registers: 3 % of a step
    if (in_use.adds_to_i(l + k)) add_row(F, M_ij, k, numbers(load + i[k]));
    if (in_use.adds_to_j(l + k)) add_row(minus_F, M_ji, k, numbers(load + j[k]));
  }
}

/// What is known of some bonds halfway, number by number: compilers copy structs of packs badly.
struct Halfway {
  Real r_ij[3], n_i[3][3], n_j[3][3], D, per_D, d[3];
};
VBOND_HD void put(const Vec3<Real>& v, Real (&to)[3]) {
  to[0] = v.x, to[1] = v.y, to[2] = v.z;
}
VBOND_HD Vec3<Real> vec(const Real (&v)[3]) {
  return {v[0], v[1], v[2]};
}

template <template <class> class Law, class P>
VBOND_HD void first_half(const P& p, const BondType& type, const PoseRow* pose, std::size_t l, Halfway& to) {
  const Law<Real> law = law_of<Law>(p, type, l);
  const BondPose<Real> b = pose_of(p, pose, l);
  const BondAxis<Real> axis = bond_axis(law, b);
  put(b.r_ij, to.r_ij);
  for (std::size_t k = 0; k < 3; ++k) put(b.n_i[k], to.n_i[k]), put(b.n_j[k], to.n_j[k]);
  to.D = axis.D, to.per_D = axis.per_D;
  put(axis.d, to.d);
}
template <template <class> class Law, class P>
VBOND_HD BondLoads<Real> second_half(const P& p, const BondType& type, std::size_t l, const Halfway& h) {
  const BondPose<Real> b{vec(h.r_ij),
                         {vec(h.n_i[0]), vec(h.n_i[1]), vec(h.n_i[2])},
                         {vec(h.n_j[0]), vec(h.n_j[1]), vec(h.n_j[2])}};
  return bond_loads(law_of<Law>(p, type, l), b, BondAxis<Real>{h.D, h.per_D, vec(h.d)});
}

/// Asks for those rows ahead that are due with packs [first, last) of all these.
VBOND_HD void fetch(const RowsAhead& ahead, std::size_t first, std::size_t last, std::size_t packs) {
  for (std::size_t k = ahead.count * first / packs; k < ahead.count * last / packs; ++k) {
    __builtin_prefetch(ahead.pose + k, 0, 2);  // into the second-level cache
    __builtin_prefetch(ahead.motion + k, 0, 2);
    __builtin_prefetch(ahead.load + k, 0, 2);
  }
}

/// Packs that are worked out together: first all poses with their root and quotient, then all loads. A core
/// that looks only some hundred instructions ahead gains by it, for it can begin a pack while the one before
/// waits for its root; one that looks further, or has few registers, loses: docs/decisions/data-layout.md.
constexpr std::size_t packs_together = VBOND_PACKS_TOGETHER;

template <template <class> class Law, class P>
VBOND_HD void add_elastic(const PackRun<P>& run, std::size_t first, std::size_t last, const PoseRow* pose,
                          LoadRow* load) {
  constexpr std::size_t parts = pack_bonds / lanes;
  if constexpr (packs_together == 1) {
    for (std::size_t l = 0; l < pack_bonds; l += lanes)
      add_lanes(run.packs[first], run.lanes[first], l,
                bond_loads(law_of<Law>(run.packs[first], *run.type, l), pose_of(run.packs[first], pose, l)),
                load);
  } else {
    Halfway halfway[packs_together * parts];
    for (std::size_t n = 0; n < (last - first) * parts; ++n)
      first_half<Law>(run.packs[first + n / parts], *run.type, pose, n % parts * lanes, halfway[n]);
    for (std::size_t n = 0; n < (last - first) * parts; ++n) {
      const std::size_t pack = first + n / parts, l = n % parts * lanes;
      add_lanes(run.packs[pack], run.lanes[pack], l,
                second_half<Law>(run.packs[pack], *run.type, l, halfway[n]), load);
    }
  }
}

// ---- laws that are more than elastic ----------------------------------------------------------------

/// The rates of the bonds in lanes l, l + 1 .. of a pack.
template <class P>
VBOND_HD BondRates<Real> rates_of(const P& p, const MotionRow* rates, std::size_t l) {
  Halves v_i, v, w_i, w_j;
  load_halves(rates, p.i + l, Half::first, v_i);
  load_halves(rates, p.j + l, Half::first, v);
  for (std::size_t k = 0; k < 4; ++k) v[k] = v[k] - v_i[k];
  transpose_halves(v);
  load_columns(rates, p.i + l, Half::second, w_i);
  load_columns(rates, p.j + l, Half::second, w_j);
  return {{v[0], v[1], v[2]}, {w_i[0], w_i[1], w_i[2]}, {w_j[0], w_j[1], w_j[2]}};
}

/// The sum over unbroken bonds, always in this order.
VBOND_HD void add_active(const Real& x, PackLanes in_use, std::size_t l, double& sum) {
  double all = sum;  // in place each addition would wait for the store of the one before
  for (std::size_t k = 0; k < lanes; ++k)
    if (in_use.has(l + k)) all += x.v[k];
  sum = all;
}

/// The same in each lane by itself.
VBOND_HD void add_in_lanes(const Real& x, PackLanes in_use, std::size_t l, double (&sums)[pack_bonds]) {
  if (in_use.active == all_lanes) return (Real::load(sums + l) + x).store(sums + l);
  for (std::size_t k = 0; k < lanes; ++k)
    if (in_use.has(l + k)) sums[l + k] += x.v[k];
}

/// What these damping loads take at these rates, in the order of DampedPower::causes.
template <class L>
VBOND_HD void add_powers(const L& law, const BondPose<Real>& b, const BondAxis<Real>& axis,
                         const BondRates<Real>& rates, const BondLoads<Real>& damping, PackLanes in_use,
                         std::size_t l, DampedPower& sum) {
  if constexpr (requires { damping_powers(law, b, axis, rates); }) {
    const DampingPowers<Real> taken = damping_powers(law, b, axis, rates);
    add_in_lanes(taken.axial, in_use, l, sum.of[0]);
    add_in_lanes(taken.shear, in_use, l, sum.of[1]);
    add_in_lanes(taken.bending, in_use, l, sum.of[2]);
    add_in_lanes(taken.torsion, in_use, l, sum.of[3]);
  } else {
    add_in_lanes(power_taken(damping, rates), in_use, l, sum.of[4]);
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

template <template <class> class Law, class P>
void add_loads(const PackRun<P>& run, BondSweep& sweep) {
  // copies: in place they would be read again after each store of loads
  const PoseRow* const pose = sweep.pose;
  LoadRow* const load = sweep.load;
  constexpr bool elastic = !ReadsRates<Law<Real>> && !Breakable<Law<Real>>;
  constexpr std::size_t at_once = elastic ? packs_together : 1;
  for (std::size_t k = 0; k < run.count; k += at_once) {
    const std::size_t last = k + at_once < run.count ? k + at_once : run.count;
    if (run.ahead.count != 0) fetch(run.ahead, k, last, run.count);
    if constexpr (elastic)
      add_elastic<Law>(run, k, last, pose, load);
    else if (Damped<Law<Real>> && run.type->damped)
      add_inelastic<Law, Damped<Law<Real>>>(run, k, sweep);
    else
      add_inelastic<Law, false>(run, k, sweep);
  }
}

template <template <class> class Law, class P>
VBOND_HD std::uint8_t survey_pack(const PackRun<P>& run, std::size_t pack, const PoseRow* pose,
                                  BondEnergies& sum) {
  const P& p = run.packs[pack];
  const PackLanes in_use = run.lanes[pack];
  unsigned look = 0;
  for (std::size_t first = 0; first < pack_bonds; first += lanes) {
    if (in_use.active >> first == 0) break;
    const BondPose<Real> b = pose_of(p, pose, first);
    const Law<Real> law = law_of<Law>(p, *run.type, first);
    const LawHistory<Law<Real>> history = history_of_lanes<Law<Real>>(run, pack, first);
    const BondEnergy<Real> U = energy_with(law, b, history);
    const BondTilt<Real> tilt = bond_tilt(elastic_pose_with(law, b, history), Real(0.0), Real(0.0));
    for (std::size_t l = 0; l < lanes; ++l) {
      if (!in_use.has(first + l)) continue;
      sum.U_L += U.U_L.v[l];
      sum.U_B += U.U_B.v[l];
      sum.U_T += U.U_T.v[l];
      const BondTilt<double> t{tilt.length.v[l], tilt.c_i.v[l], tilt.c_j.v[l], tilt.cos_twist.v[l],
                               tilt.sin_twist.v[l]};
      if (needs_look(t, p.a[first + l])) look |= 1u << (first + l);
    }
  }
  return static_cast<std::uint8_t>(look);
}

template <template <class> class Law, class P>
void survey(const PackRun<P>& run, const PoseRow* pose, BondEnergies& sum, std::uint8_t* look) {
  for (std::size_t k = 0; k < run.count; ++k) look[k] = survey_pack<Law>(run, k, pose, sum);
}

/// Bonds with offsets are hardly ever alike, and never in compact packs.
template <template <class> class Law>
constexpr BondLoops loops_of() {
  if constexpr (OffsetLaw<Law<Real>>)
    return {{}, {add_loads<Law, FullPack>, survey<Law, FullPack>}};
  else
    return {{add_loads<Law, CompactPack>, survey<Law, CompactPack>},
            {add_loads<Law, FullPack>, survey<Law, FullPack>}};
}
template <template <class> class Law>
constexpr BondLoops loops_of_law = loops_of<Law>();

}  // namespace
}  // namespace vbond::VBOND_KERNEL
