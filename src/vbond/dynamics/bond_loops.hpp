// The loops over bonds of one law, for the sources that are compiled once per instruction set: see kernel.cpp
// on what they may contain.
#pragma once
#include <cstddef>
#include <cstdint>

#include "vbond/dynamics/inelastic_loops.hpp"
#include "vbond/dynamics/pack_lanes.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/with_offsets.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

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

/// Adds the loads of the bonds in lanes l .. l + W - 1 of a pack.
template <template <class> class Law, std::size_t W, class P>
VBOND_HD void add_elastic_lanes(const PackRun<P>& run, std::size_t pack, std::size_t l, const PoseRow* pose,
                                LoadRow* load) {
  const P& p = run.packs[pack];
  add_lanes(p, run.lanes[pack], l, bond_loads(law_of<Law, W>(p, *run.type, l), pose_of<W>(p, pose, l)), load);
}

template <template <class> class Law, class P>
VBOND_HD void add_elastic(const PackRun<P>& run, std::size_t first, std::size_t last, const PoseRow* pose,
                          LoadRow* load) {
  constexpr std::size_t parts = pack_bonds / lanes;
  if constexpr (packs_together == 1) {
    const unsigned active = run.lanes[first].active;
    for (std::size_t l = 0; l < pack_bonds && active >> l != 0; l += lanes)
      add_elastic_lanes<Law, lanes>(run, first, l, pose, load);
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

template <template <class> class Law, class P>
void add_loads(const PackRun<P>& run, BondSweep& sweep) {
  // copies: in place they would be read again after each store of loads
  const PoseRow* const pose = sweep.pose;
  LoadRow* const load = sweep.load;
  constexpr bool elastic = !ReadsRates<Law<Real>> && !Breakable<Law<Real>>;
  constexpr std::size_t at_once = elastic ? packs_together : 1;
  // half of the lanes do for a last pack of up to four bonds: a twentieth of the step of a short chain
  constexpr bool may_be_half_full = elastic && at_once == 1 && lanes == 8;
  std::size_t count = run.count;
  if constexpr (may_be_half_full)
    if (run.lanes[count - 1].active >> 4 == 0) --count;
  for (std::size_t k = 0; k < count; k += at_once) {
    const std::size_t last = k + at_once < count ? k + at_once : count;
    if (run.ahead.count != 0) fetch(run.ahead, k, last, count);
    if constexpr (elastic)
      add_elastic<Law>(run, k, last, pose, load);
    else if (Damped<Law<Real>> && run.type->damped)
      add_inelastic<Law, Damped<Law<Real>>>(run, k, sweep);
    else
      add_inelastic<Law, false>(run, k, sweep);
  }
  if constexpr (may_be_half_full)
    if (count < run.count) add_elastic_lanes<Law, 4>(run, count, 0, pose, load);
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
