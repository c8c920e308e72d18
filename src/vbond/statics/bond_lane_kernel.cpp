// Loads and tangents of several bonds at a time. This file is compiled once per instruction set, with its own
// namespace VBOND_LANE_SET, vectors of VBOND_LANES doubles, and VBOND_HD forcing the physics inline, as
// dynamics/kernel.cpp. Every lane rounds as a bond does by itself, whatever the set.
#include <utility>

#include "vbond/core/dual_of.hpp"
#include "vbond/core/simd.hpp"
#include "vbond/physics/evm.hpp"
#include "vbond/physics/pose.hpp"
#include "vbond/physics/vmodel.hpp"
#include "vbond/statics/detail/bond_lanes.hpp"

namespace vbond::VBOND_LANE_SET {
namespace {

constexpr std::size_t lanes = VBOND_LANES;
using Real = Pack<lanes>;
/// Three derivatives at a time, for what is moved: the distance of the centres, or a turn of one of them.
using Moved = DualOf<3, Real>;
enum class Moves { apart, i, j };

VBOND_HD Real real(const BondLanes::Lane& x, std::size_t l) {
  return Real::load(x + l);
}
VBOND_HD Vec3<Real> vec(const BondLanes::Lane (&x)[3], std::size_t l) {
  return {real(x[0], l), real(x[1], l), real(x[2], l)};
}
VBOND_HD Quat<Real> quat(const BondLanes::Lane (&x)[4], std::size_t l) {
  return {real(x[0], l), real(x[1], l), real(x[2], l), real(x[3], l)};
}
VBOND_HD void store(const Vec3<Real>& v, BondLanes::Lane (&to)[3], std::size_t l) {
  v.x.store(to[0] + l), v.y.store(to[1] + l), v.z.store(to[2] + l);
}

template <template <class> class Law, class T, std::size_t... k>
VBOND_HD Law<T> law_of(const BondLanes& b, std::size_t l, std::index_sequence<k...>) {
  Law<T> law;
  law.a = T(real(b.a, l)), law.R_i = T(real(b.R_i, l)), law.R_j = T(real(b.R_j, l));
  ((law.*coefficient<Law<T>, k> = T(real(b.coefficients[k], l))), ...);
  return law;
}
template <template <class> class Law, class T>
VBOND_HD Law<T> law_of(const BondLanes& b, std::size_t l) {
  return law_of<Law, T>(b, l, std::make_index_sequence<4>());
}

VBOND_HD BondPose<Real> pose_of(const BondLanes& b, std::size_t l) {
  return bond_pose(BondFrames<Real>{quat(b.frame_i, l), quat(b.frame_j, l)}, vec(b.r_ij, l), quat(b.q_i, l),
                   quat(b.q_j, l));
}

template <template <class> class Law>
void energy(BondLanes& b) {
  for (std::size_t l = 0; l < bonds_together; l += lanes) {
    const BondEnergy<Real> found = bond_energy(law_of<Law, Real>(b, l), pose_of(b, l));
    store({found.U_L, found.U_B, found.U_T}, b.U, l);
  }
}

template <template <class> class Law>
void loads(BondLanes& b) {
  for (std::size_t l = 0; l < bonds_together; l += lanes) {
    const BondLoads<Real> found = bond_loads(law_of<Law, Real>(b, l), pose_of(b, l));
    store(found.F, b.F, l), store(found.M_ij, b.M_ij, l), store(found.M_ji, b.M_ji, l);
  }
}

VBOND_HD Vec3<Moved> constant(const Vec3<Real>& a) {
  return {Moved(a.x), Moved(a.y), Moved(a.z)};
}
/// As moved() and turned() of physics/tangent.hpp.
VBOND_HD Vec3<Moved> shifted(const Vec3<Real>& a) {
  return {Moved::variable(a.x, 0), Moved::variable(a.y, 1), Moved::variable(a.z, 2)};
}
VBOND_HD Vec3<Moved> turned(const Vec3<Real>& a) {
  Vec3<Moved> n = constant(a);
  n.x.d[1] = a.z, n.x.d[2] = -a.y;
  n.y.d[0] = -a.z, n.y.d[2] = a.x;
  n.z.d[0] = a.y, n.z.d[1] = -a.x;
  return n;
}

/// How the rows F, M_ij, M_ji change with what moves.
template <template <class> class Law>
__attribute__((noinline)) void derivatives(const BondLanes& b, std::size_t l, const BondPose<Moved>& pose,
                                           Real (&d)[9][3]) {
  const BondLoads<Moved> found = bond_loads(law_of<Law, Moved>(b, l), pose);
  const Moved* rows[9] = {&found.F.x,    &found.F.y,    &found.F.z,    &found.M_ij.x, &found.M_ij.y,
                          &found.M_ij.z, &found.M_ji.x, &found.M_ji.y, &found.M_ji.z};
  for (std::size_t row = 0; row < 9; ++row)
    for (std::size_t k = 0; k < 3; ++k) d[row][k] = rows[row]->d[k];
}

VBOND_HD BondPose<Moved> moved_pose(const BondPose<Real>& b, Moves what) {
  BondPose<Moved> p;
  p.r_ij = what == Moves::apart ? shifted(b.r_ij) : constant(b.r_ij);
  for (int k = 0; k < 3; ++k) {
    p.n_i[k] = what == Moves::i ? turned(b.n_i[k]) : constant(b.n_i[k]);
    p.n_j[k] = what == Moves::j ? turned(b.n_j[k]) : constant(b.n_j[k]);
  }
  return p;
}

/// As block_of() for a bond, and the mean of that with what it is the other way round.
template <template <class> class Law>
void tangent(BondLanes& b, double length) {
  const Real L(length), half(0.5);
  for (std::size_t l = 0; l < bonds_together; l += lanes) {
    const BondPose<Real> pose = pose_of(b, l);
    Real d[3][9][3];  // with the distance, the turn of i, that of j
    derivatives<Law>(b, l, moved_pose(pose, Moves::apart), d[0]);
    derivatives<Law>(b, l, moved_pose(pose, Moves::i), d[1]);
    derivatives<Law>(b, l, moved_pose(pose, Moves::j), d[2]);
    Real K[12][12];
    for (std::size_t group = 0; group < 3; ++group)
      for (std::size_t a = 0; a < 3; ++a) {
        Real* row = K[(group == 0 ? 0 : group == 1 ? 3 : 9) + a];
        const std::size_t from = 3 * group + a;
        for (std::size_t c = 0; c < 3; ++c) {
          row[c] = d[0][from][c];
          row[3 + c] = -d[1][from][c];
          row[6 + c] = -d[0][from][c];
          row[9 + c] = -d[2][from][c];
        }
      }
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t c = 0; c < 12; ++c) K[6 + a][c] = -K[a][c];
    const auto is_turn = [](std::size_t k) { return k / 3 % 2 == 1; };
    for (std::size_t r = 0; r < 12; ++r)
      for (std::size_t c = 0; c < 12; ++c) {
        if (is_turn(r)) K[r][c] = K[r][c] / L;
        if (is_turn(c)) K[r][c] = K[r][c] / L;
      }
    for (std::size_t c = 0; c < 12; ++c)
      for (std::size_t r = 0; r < 12; ++r) (half * (K[r][c] + K[c][r])).store(b.block[c][r] + l);
  }
}

template <template <class> class Law>
constexpr BondLaneLoops loops_of{energy<Law>, loads<Law>, tangent<Law>};

}  // namespace

extern const BondLaneKernel kernel;
const BondLaneKernel kernel{{loops_of<VModel>, loops_of<Evm>}};

}  // namespace vbond::VBOND_LANE_SET
