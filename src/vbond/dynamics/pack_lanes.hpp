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

template <std::size_t W>
VBOND_HD Quat<Pack<W>> quat(const double (&q)[4][pack_bonds], std::size_t l) {
  return {Pack<W>::load(q[0] + l), Pack<W>::load(q[1] + l), Pack<W>::load(q[2] + l), Pack<W>::load(q[3] + l)};
}

/// The laws of the bonds in lanes l, l + 1 .. of a pack.
template <class L, std::size_t... k>
VBOND_HD L law_of(const CompactPack& p, const BondType& t, std::size_t l, std::index_sequence<k...>) {
  using Numbers = typename L::Number;
  const Numbers scale = Numbers::load(p.scale + l);
  L law;
  law.a = Numbers::load(p.a + l), law.R_i = Numbers(t.R_i), law.R_j = Numbers(t.R_j);
  ((law.*coefficient<L, k> = scale * Numbers(t.coefficients[k])), ...);
  if constexpr (HasRules<L>) law.rules = t.rules;
  return law;
}
template <class L, std::size_t... k>
VBOND_HD L law_of(const FullPack& p, const BondType& t, std::size_t l, std::index_sequence<k...>) {
  using Numbers = typename L::Number;
  L law;
  law.a = Numbers::load(p.a + l), law.R_i = Numbers::load(p.R_i + l), law.R_j = Numbers::load(p.R_j + l);
  ((law.*coefficient<L, k> = Numbers::load(p.coefficients[k] + l)), ...);
  if constexpr (HasRules<L>) law.rules = t.rules;
  return law;
}
template <template <class> class Law, std::size_t W = lanes, class P>
VBOND_HD Law<Pack<W>> law_of(const P& p, const BondType& t, std::size_t l) {
  return law_of<Law<Pack<W>>>(p, t, l, std::make_index_sequence<coefficients_of<Law<Real>>>());
}

template <std::size_t W>
VBOND_HD BondFrames<Pack<W>> frames_of(const CompactPack& p, std::size_t l) {
  const Quat<Pack<W>> frame = quat<W>(p.frame, l);
  return {frame, frame};
}
template <std::size_t W>
VBOND_HD BondFrames<Pack<W>> frames_of(const FullPack& p, std::size_t l) {
  return {quat<W>(p.frame_i, l), quat<W>(p.frame_j, l)};
}

/// The bonds in lanes l, l + 1 .. of a pack as their particles stand.
template <std::size_t W = lanes, class P>
VBOND_HD BondPose<Pack<W>> pose_of(const P& p, const PoseRow* pose, std::size_t l) {
  HalvesOf<W> r;
  load_between(pose, p.i + l, p.j + l, r);
  return bond_pose(frames_of<W>(p, l), {r[0], r[1], r[2]}, load_quats<W>(pose, p.i + l),
                   load_quats<W>(pose, p.j + l));
}

/// Adds the loads of the bonds in lanes l, l + 1 .. of a pack to their rows.
template <std::size_t W, class P>
VBOND_HD void add_lanes(const P& p, PackLanes in_use, std::size_t l, const BondLoads<Pack<W>>& b,
                        LoadRow* load) {
  const Pack<W> zero(0.0);
  HalvesOf<W> F = {b.F.x, b.F.y, b.F.z, zero}, minus_F;
  HalvesOf<W> M_ij = {b.M_ij.x, b.M_ij.y, b.M_ij.z, zero}, M_ji = {b.M_ji.x, b.M_ji.y, b.M_ji.z, zero};
  transpose_halves(F);
  transpose_halves(M_ij);
  transpose_halves(M_ji);
  for (std::size_t k = 0; k < 4; ++k) minus_F[k] = -F[k];
  const std::uint32_t *i = p.i + l, *j = p.j + l;
  if (in_use.to_i == all_lanes && in_use.to_j == all_lanes) {
    for (std::size_t k = 0; k < W; ++k) {  // bond after bond: two of them may share a particle
      add_row(F, M_ij, k, numbers(load + i[k]));
      add_row(minus_F, M_ji, k, numbers(load + j[k]));
    }
    return;
  }
  for (std::size_t k = 0; k < W; ++k) {  // an earlier end costs the loop above registers: 3 % of a step
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
