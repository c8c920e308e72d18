#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

#include "vbond/core/dual.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/touch.hpp"

namespace vbond {

/// Loads of a pair and their derivatives: rows F, M_ij, M_ji; columns r_ij, then small turns of i and of j
/// about the world's axes, n -> n + turn x n.
template <std::size_t N>
struct PairTangent {
  BondLoads<double> loads;
  std::array<std::array<double, N>, N> d{};
};

/// A vector moved along three variables, from number `first`.
template <std::size_t N>
Vec3<Dual<N>> moved(const Vec3d& a, std::size_t first) {
  return {Dual<N>::variable(a.x, first), Dual<N>::variable(a.y, first + 1),
          Dual<N>::variable(a.z, first + 2)};
}

/// A vector of fixed length turned by three variables, from number `first`: its derivative is turn x a.
template <std::size_t N>
Vec3<Dual<N>> turned(const Vec3d& a, std::size_t first) {
  Vec3<Dual<N>> n{a.x, a.y, a.z};
  n.x.d[first + 1] = a.z, n.x.d[first + 2] = -a.y;
  n.y.d[first] = -a.z, n.y.d[first + 2] = a.x;
  n.z.d[first] = a.y, n.z.d[first + 1] = -a.x;
  return n;
}

/// The pose of a bond whose first nine variables are r_ij and the small turns of i and of j.
template <std::size_t N>
BondPose<Dual<N>> moved_pose(const BondPose<double>& pose) {
  BondPose<Dual<N>> p{moved<N>(pose.r_ij, 0), {}, {}};
  for (int k = 0; k < 3; ++k) {
    p.n_i[k] = turned<N>(pose.n_i[k], 3);
    p.n_j[k] = turned<N>(pose.n_j[k], 6);
  }
  return p;
}

/// These loads and their derivatives with the first nine variables.
template <std::size_t N>
PairTangent<9> tangent_of(const BondLoads<Dual<N>>& l) {
  using D = Dual<N>;
  const D* rows[9] = {&l.F.x,    &l.F.y,    &l.F.z,    &l.M_ij.x, &l.M_ij.y,
                      &l.M_ij.z, &l.M_ji.x, &l.M_ji.y, &l.M_ji.z};
  PairTangent<9> t;
  for (std::size_t k = 0; k < 9; ++k) std::copy_n(rows[k]->d.begin(), 9, t.d[k].begin());
  const auto values = [](const Vec3<D>& a) { return Vec3d{a.x.value, a.y.value, a.z.value}; };
  t.loads = {values(l.F), values(l.M_ij), values(l.M_ji)};
  return t;
}

/// Loads of a bond and their exact derivatives, from the law itself run over dual numbers.
template <class Law>
PairTangent<9> bond_tangent(const Law& law, const BondPose<double>& pose) {
  return tangent_of(bond_loads(with_scalar<Dual<9>>(law), moved_pose<9>(pose)));
}

/// The numbers that a repulsion asks for, as duals.
inline TouchNumbers<Dual<3>> repulsion(const TouchNumbers<double>& numbers) {
  TouchNumbers<Dual<3>> c;
  c.stiffness = numbers.stiffness;
  return c;
}

/// The same for two particles that overlap, R_i + R_j > |r_ij|, and repel each other: a force on i along
/// -r_ij, no moments.
inline PairTangent<3> contact_tangent(const TouchForms& forms, const TouchNumbers<double>& numbers,
                                      const Vec3d& r_ij, double R_i, double R_j) {
  using D = Dual<3>;
  const Vec3<D> r = moved<3>(r_ij, 0);
  const D distance = norm(r);
  const D force =
      normal_force(forms, repulsion(numbers), D(reduced_radius(R_i, R_j)), D(R_i + R_j) - distance).F;
  const Vec3<D> F = -(force / distance) * r;
  return {{{F.x.value, F.y.value, F.z.value}, {}, {}}, {F.x.d, F.y.d, F.z.d}};
}

}  // namespace vbond
