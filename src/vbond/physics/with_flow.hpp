#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "vbond/physics/flow.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/section.hpp"
#include "vbond/physics/with_rules.hpp"

namespace vbond {

/// A law with rules whose state of rest moves: its length at rest grows, its frames turn, and damage takes
/// away from its energy. The energy itself stays that of the law with rules: see docs/theory.md.
template <template <class> class ElasticLaw>
struct WithFlow {
  template <Scalar T>
  struct Law : WithRules<ElasticLaw>::template Law<T> {
    using Inner = typename WithRules<ElasticLaw>::template Law<T>;
    static constexpr std::string_view name = joined_name<ElasticLaw<T>::name, name_with_flow>;
    static constexpr auto fields() {
      constexpr auto inner = Inner::fields();
      std::array<LawField<Law>, inner.size()> all{};
      for (std::size_t k = 0; k < all.size(); ++k) all[k] = {inner[k].at, inner[k].info};
      return all;
    }
    static constexpr Law from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
      Law law{};
      static_cast<Inner&>(law) = Inner::from(c, a, R_i, R_j);
      return law;
    }

    static constexpr std::array<std::string_view, memory::count> history{
        "stretch",    "creep",      "turn_i_1",      "turn_i_2",   "turn_i_3",     "turn_j_1",
        "turn_j_2",   "turn_j_3",   "axial_flow",    "shear_flow", "bending_flow", "torsion_flow",
        "plastic_b2", "plastic_b3", "plastic_twist", "damage",     "dissipated"};
    static constexpr std::size_t dissipated_at = memory::dissipated;

    /// The law about its present rest, between the bonded points.
    VBOND_HD Inner about(const T& rest_length) const {
      Inner law = *this;
      law.a = rest_length, law.R_i = T(0.0), law.R_j = T(0.0);
      return law;
    }
  };
};

template <class Law>
concept FlowingLaw = HasRules<Law> && Remembering<Law> && !OffsetLaw<Law> && requires(const Law& law) {
  law.about(law.a);
};

/// The frames of a bond as flow has turned them against its particles.
template <Scalar T>
struct FlowTurns {
  Quat<T> i, j;
};
/// Adds to a number of the memory.
template <FlowingLaw Law, Scalar T>
VBOND_HD void add_to(LawHistory<Law>& h, std::size_t k, const T& x) {
  h.value[k] = h.value[k] + x;
}
/// Three numbers of the memory, as a vector.
template <FlowingLaw Law>
VBOND_HD auto vector_at(const LawHistory<Law>& h, std::size_t k) {
  return Vec3<typename Law::Number>{h.value[k], h.value[k + 1], h.value[k + 2]};
}
template <FlowingLaw Law>
VBOND_HD auto turns_of(const LawHistory<Law>& h) {
  return FlowTurns<typename Law::Number>{rotation_by_quarter(vector_at<Law>(h, memory::turn_i)),
                                         rotation_by_quarter(vector_at<Law>(h, memory::turn_j))};
}

/// Axes x, y, z turned by q, which is given in these axes.
template <Scalar T>
VBOND_HD void turn_axes(const Quat<T>& q, const Axes<T>& n, Vec3<T> (&to)[3]) {
  const Axes<T> R = axes(q);
  to[0] = R.x.x * n.x + R.x.y * n.y + R.x.z * n.z;
  to[1] = R.y.x * n.x + R.y.y * n.y + R.y.z * n.z;
  to[2] = R.z.x * n.x + R.z.y * n.y + R.z.z * n.z;
}
/// The frames of a pose, both right-handed.
template <Scalar T>
VBOND_HD Axes<T> frame_of_i(const BondPose<T>& b) {
  return {b.n_i[0], b.n_i[1], b.n_i[2]};
}
template <Scalar T>
VBOND_HD Axes<T> frame_of_j(const BondPose<T>& b) {
  return {-b.n_j[0], b.n_j[1], b.n_j[2]};
}

/// The pose of the bond itself: between its bonded points, where the particles hold it, with turned frames.
/// What follows of it is for R_i = R_j = 0.
template <Scalar T>
VBOND_HD BondPose<T> turned_pose(const BondPose<T>& b, const Vec3<T>& D_ij, const FlowTurns<T>& turns) {
  BondPose<T> p;
  p.r_ij = D_ij;
  turn_axes(turns.i, frame_of_i(b), p.n_i);
  turn_axes(turns.j, frame_of_j(b), p.n_j);
  p.n_j[0] = -p.n_j[0];
  return p;
}

template <FlowingLaw Law, Scalar T>
VBOND_HD T rest_length(const Law& m, const LawHistory<Law>& h) {
  return m.a + (h.value[memory::stretch] + h.value[memory::crept]);
}

/// The pose by which the range of a bond is judged: elastic angles, and the length less what has flowed.
template <FlowingLaw Law, Scalar T>
VBOND_HD BondPose<T> elastic_pose(const Law& m, const BondPose<T>& b, const LawHistory<Law>& h) {
  const Vec3<T> D_ij = bonded_points(b, m.R_i, m.R_j);
  const T flowed = h.value[memory::stretch] + h.value[memory::crept];
  return turned_pose(b, D_ij - (flowed / norm(D_ij)) * D_ij, turns_of<Law>(h));
}

// ---- energy and loads ------------------------------------------------------------------------------

/// Damage weakens all but compression along the axis.
template <FlowingLaw Law, Scalar T>
VBOND_HD T tension(const Law& m, const T& D, const LawHistory<Law>& h) {
  const T N = tension(m.about(rest_length<Law, T>(m, h)), D);
  return where_greater(N, T(0.0), N - h.value[memory::damage] * N, N);
}
template <FlowingLaw Law, Scalar T>
VBOND_HD T stretch_energy(const Law& m, const T& D, const LawHistory<Law>& h) {
  const T a = rest_length<Law, T>(m, h), U = stretch_energy(m.about(a), D);
  const T stored = T(0.5 * m.rules->yield.kinematic.axial) * sq(h.value[memory::stretch]);
  return where_greater(D, a, U - h.value[memory::damage] * U, U) + stored;
}

template <FlowingLaw Law, Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Law& m, const BondPose<T>& b, const LawHistory<Law>& h) {
  const Vec3<T> D_ij = bonded_points(b, m.R_i, m.R_j);
  const BondEnergy<T> U =
      bond_energy(m.about(rest_length<Law, T>(m, h)), turned_pose(b, D_ij, turns_of<Law>(h)));
  const FlowLimits& back = m.rules->yield.kinematic;
  const T whole = T(1.0) - h.value[memory::damage];
  const T bent2 = sq(h.value[memory::bent]) + sq(h.value[memory::bent + 1]);
  return {stretch_energy(m, norm(D_ij), h), whole * U.U_B + T(0.5 * back.bending) * bent2,
          whole * U.U_T + T(0.5 * back.torsion) * sq(h.value[memory::twisted])};
}

/// Elastic loads about the bonded points, without damage.
template <FlowingLaw Law, Scalar T>
VBOND_HD BondLoads<T> undamaged_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                      const T& rest_length, const FlowTurns<T>& turns) {
  return bond_loads(m.about(rest_length), turned_pose(b, axis.D * axis.d, turns), axis);
}

template <FlowingLaw Law, Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const LawHistory<Law>& h) {
  const T damage = h.value[memory::damage], whole = T(1.0) - damage, zero(0.0);
  const BondLoads<T> l = undamaged_loads(m, b, axis, rest_length<Law, T>(m, h), turns_of<Law>(h));
  const T N = dot(l.F, axis.d);
  const Vec3<T> F = whole * l.F + where_greater(zero, N, damage * N, zero) * axis.d;
  return {F, whole * l.M_ij + m.R_i * cross(b.n_i[0], F), whole * l.M_ji - m.R_j * cross(b.n_j[0], F)};
}

/// What a bond has dissipated by yielding in each way.
inline FlowLimits lost_by_yield(const Yield& rule, std::span<const double> history) {
  const FlowLimits &limit = rule.limit, &grow = rule.isotropic;
  const double all = history[memory::axial], longer = 0.5 * (all + history[memory::stretch]);
  return {dissipated_by(limit.axial, grow.axial, all) + (rule.compression - limit.axial) * (all - longer),
          dissipated_by(limit.shear, grow.shear, history[memory::shear]),
          dissipated_by(limit.bending, grow.bending, history[memory::bending]),
          dissipated_by(limit.torsion, grow.torsion, history[memory::torsion])};
}

// the same for a bond that remembers nothing yet
template <FlowingLaw Law, Scalar T>
VBOND_HD T stretch_energy(const Law& m, const T& D) {
  return stretch_energy(m, D, LawHistory<Law>{});
}
template <FlowingLaw Law, Scalar T>
VBOND_HD T tension(const Law& m, const T& D) {
  return tension(m, D, LawHistory<Law>{});
}
template <FlowingLaw Law, Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Law& m, const BondPose<T>& b) {
  return bond_energy(m, b, LawHistory<Law>{});
}
template <FlowingLaw Law, Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return bond_loads(m, b, axis, LawHistory<Law>{});
}

template <FlowingLaw Law, Scalar T>
VBOND_HD Failure<T> bond_failure(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const BondLoads<T>& loads, const LawHistory<Law>& h) {
  const T one(1.0);
  Failure<T> f = failure(m.rules->strength, stiffness(m), b, m.R_i, m.R_j, axis, loads, axis.D / m.a - one,
                         one + m.weakness);
  if (!m.rules->softening.any()) return f;
  f.tension = larger(f.tension, h.value[memory::damage]);
  f.utilisation = larger(f.utilisation, h.value[memory::damage]);
  return f;
}
template <FlowingLaw Law, Scalar T>
VBOND_HD T utilisation(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis, const BondLoads<T>& loads,
                       const LawHistory<Law>& h) {
  return bond_failure(m, b, axis, loads, h).utilisation;
}

}  // namespace vbond
