// The bonds of a pack side by side in registers: their laws, as their particles stand and move, and their
// loads on the way back to the rows. For bond_loops.hpp.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>

#include "vbond/dynamics/kernel.hpp"
#include "vbond/dynamics/kernel_rows.hpp"
#include "vbond/dynamics/stretch_lanes.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/with_rules.hpp"

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

}  // namespace
}  // namespace vbond::VBOND_KERNEL
