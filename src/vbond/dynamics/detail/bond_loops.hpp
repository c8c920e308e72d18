// The loops over bonds of one law, for the sources that are compiled once per instruction set: see kernel.cpp
// on what they may contain.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>

#include "vbond/dynamics/detail/kernel_rows.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/range.hpp"

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
  return law;
}
template <template <class> class Law, std::size_t... k>
VBOND_HD Law<Real> law_of(const FullPack& p, const BondType&, std::size_t l, std::index_sequence<k...>) {
  Law<Real> law;
  law.a = Real::load(p.a + l), law.R_i = Real::load(p.R_i + l), law.R_j = Real::load(p.R_j + l);
  ((law.*coefficient<Law<Real>, k> = Real::load(p.coefficients[k] + l)), ...);
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
  Halves i, r;
  load_halves(pose, p.i + l, Half::first, i);
  load_halves(pose, p.j + l, Half::first, r);
  for (std::size_t k = 0; k < 4; ++k) r[k] = r[k] - i[k];
  transpose_halves(r);
  return bond_pose(frames_of(p, l), {r[0], r[1], r[2]}, load_quats(pose, p.i + l), load_quats(pose, p.j + l));
}

/// Adds the loads of the bonds in lanes l, l + 1 .. of a pack to their rows.
template <class P>
VBOND_HD void add_lanes(const P& p, PackLanes in_use, std::size_t l, const BondLoads<Real>& b, RowRange own,
                        LoadRow* load) {
  const Real zero(0.0);
  Halves F = {b.F.x, b.F.y, b.F.z, zero}, minus_F;
  Halves M_ij = {b.M_ij.x, b.M_ij.y, b.M_ij.z, zero}, M_ji = {b.M_ji.x, b.M_ji.y, b.M_ji.z, zero};
  transpose_halves(F);
  transpose_halves(M_ij);
  transpose_halves(M_ji);
  for (std::size_t k = 0; k < 4; ++k) minus_F[k] = -F[k];
  const std::uint32_t *i = p.i + l, *j = p.j + l;
  if (in_use.count == pack_bonds && !in_use.crossing) {
    for (std::size_t k = 0; k < lanes; ++k) {  // bond after bond: two of them may share a particle
      add_row(F, M_ij, k, numbers(load + i[k]));
      add_row(minus_F, M_ji, k, numbers(load + j[k]));
    }
    return;
  }
  for (std::size_t k = 0; k < lanes && l + k < in_use.count; ++k) {
    if (own.contains(i[k])) add_row(F, M_ij, k, numbers(load + i[k]));
    if (own.contains(j[k])) add_row(minus_F, M_ji, k, numbers(load + j[k]));
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
  const BondAxis<Real> axis = bond_axis(b, law.R_i, law.R_j);
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
void add_loads(const PackRun<P>& run, RowRange own, const PoseRow* pose, LoadRow* load) {
  constexpr std::size_t parts = pack_bonds / lanes;
  for (std::size_t k = 0; k < run.count; k += packs_together) {
    const std::size_t last = k + packs_together < run.count ? k + packs_together : run.count;
    if (run.ahead.count != 0) fetch(run.ahead, k, last, run.count);
    if constexpr (packs_together == 1) {
      for (std::size_t l = 0; l < pack_bonds; l += lanes)
        add_lanes(run.packs[k], run.lanes[k], l,
                  bond_loads(law_of<Law>(run.packs[k], run.type, l), pose_of(run.packs[k], pose, l)), own,
                  load);
    } else {
      Halfway halfway[packs_together * parts];
      for (std::size_t n = 0; n < (last - k) * parts; ++n)
        first_half<Law>(run.packs[k + n / parts], run.type, pose, n % parts * lanes, halfway[n]);
      for (std::size_t n = 0; n < (last - k) * parts; ++n) {
        const std::size_t pack = k + n / parts, l = n % parts * lanes;
        add_lanes(run.packs[pack], run.lanes[pack], l,
                  second_half<Law>(run.packs[pack], run.type, l, halfway[n]), own, load);
      }
    }
  }
}

template <template <class> class Law, class P>
VBOND_HD std::uint8_t survey_pack(const P& p, const BondType& type, PackLanes in_use, const PoseRow* pose,
                                  BondEnergies& sum) {
  unsigned look = 0;
  for (std::size_t first = 0; first < in_use.count; first += lanes) {
    const BondPose<Real> b = pose_of(p, pose, first);
    const Law<Real> law = law_of<Law>(p, type, first);
    const BondEnergy<Real> U = bond_energy(law, b);
    const BondTilt<Real> tilt = bond_tilt(b, law.R_i, law.R_j);
    for (std::size_t l = 0; l < lanes && first + l < in_use.count; ++l) {
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
  for (std::size_t k = 0; k < run.count; ++k)
    look[k] = survey_pack<Law>(run.packs[k], run.type, run.lanes[k], pose, sum);
}

template <template <class> class Law>
constexpr BondLoops bond_loops{{add_loads<Law, CompactPack>, survey<Law, CompactPack>},
                               {add_loads<Law, FullPack>, survey<Law, FullPack>}};

}  // namespace
}  // namespace vbond::VBOND_KERNEL
