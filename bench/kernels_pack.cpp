// The V-model in the lanes of a vector register, for kernels.cpp. This file is compiled once per instruction
// set, with packs of VBOND_WIDTH doubles and VBOND_HD forcing every law inline, and must define nothing but
// the functions of its own namespace VBOND_SET.
#include <cstddef>

#include "vbond/core/cell.hpp"
#include "vbond/core/simd.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond_bench::VBOND_SET {
namespace {

constexpr std::size_t W = VBOND_WIDTH;
using P = vbond::Pack<W>;

inline __attribute__((always_inline)) P row(const double* from, std::size_t k) {
  return P::load(from + k * W);
}
inline __attribute__((always_inline)) vbond::Vec3<P> vector(const double* from, std::size_t k) {
  return {row(from, k), row(from, k + 1), row(from, k + 2)};
}
inline __attribute__((always_inline)) vbond::Quat<P> quaternion(const double* from, std::size_t k) {
  return {row(from, k), row(from, k + 1), row(from, k + 2), row(from, k + 3)};
}
inline __attribute__((always_inline)) void store(const vbond::Vec3<P>& a, double* to, std::size_t k) {
  a.x.store(to + k * W), a.y.store(to + (k + 1) * W), a.z.store(to + (k + 2) * W);
}

inline __attribute__((always_inline)) vbond::VModel<P> alike(const double* law) {
  return {P(law[0]), P(law[1]), P(law[2]), P(law[3]), P(law[4]), P(law[5]), P(law[6])};
}

inline __attribute__((always_inline)) void store(const vbond::BondLoads<P>& loads, double* to) {
  store(loads.F, to, 0), store(loads.M_ij, to, 3), store(loads.M_ji, to, 6);
}

}  // namespace

/// Loads of bonds whose poses are known. law: a, R_i, R_j, B1..B4 of all bonds; pose: per pack 21 rows of W
/// numbers, r_ij, n_i[0..2], n_j[0..2]; loads: per pack 9 rows, F, M_ij, M_ji.
void loads_of_poses(const double* law, const double* pose, std::size_t packs, double* loads) {
  const vbond::VModel<P> m = alike(law);
  for (std::size_t n = 0; n < packs; ++n, pose += 21 * W, loads += 9 * W) {
    const vbond::BondPose<P> b{vector(pose, 0),
                               {vector(pose, 3), vector(pose, 6), vector(pose, 9)},
                               {vector(pose, 12), vector(pose, 15), vector(pose, 18)}};
    store(vbond::bond_loads(m, b), loads);
  }
}

/// The same from positions and orientations. ends: per pack 22 rows of W numbers, frame.i, frame.j, q_i, q_j,
/// r_i, r_j.
void loads_of_ends(const double* law, const double* ends, std::size_t packs, double* loads) {
  const vbond::VModel<P> m = alike(law);
  for (std::size_t n = 0; n < packs; ++n, ends += 22 * W, loads += 9 * W) {
    const vbond::BondFrames<P> frames{quaternion(ends, 0), quaternion(ends, 4)};
    const vbond::Vec3<P> r_ij = vbond::between(vector(ends, 16), vector(ends, 19));
    store(vbond::bond_loads(m, vbond::bond_pose(frames, r_ij, quaternion(ends, 8), quaternion(ends, 12))),
          loads);
  }
}

}  // namespace vbond_bench::VBOND_SET
