#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "vbond/physics/law.hpp"
#include "vbond/physics/with_rules.hpp"

namespace vbond {

inline constexpr std::string_view name_with_rubbing = "-with-rubbing";

/// Where a bond with faces that rub keeps what it remembers: the numbers of the history of a law WithRubbing.
namespace rubbed {
inline constexpr std::size_t cracked = 0;  // 1 once it is, else 0
inline constexpr std::size_t slip = 1;  // of face j over face i, along both directions of the faces  [length]
inline constexpr std::size_t shear = 3;  // shear force at the end of the last step, along the same  [force]
inline constexpr std::size_t dissipated = 5;  // by friction  [energy]
inline constexpr std::size_t count = 6;
}  // namespace rubbed

/// A law with rules whose bonds do not vanish when they break: they crack. Then two plane faces, each rigid
/// with its particle, are pressed against each other and rub, or stand open. Intact it is the law with
/// rules; how the faces push and rub does not depend on it. See docs/theory.md, "Cracked bonds that rub".
template <template <class> class ElasticLaw>
struct WithRubbing {
  template <Scalar T>
  struct Law : WithRules<ElasticLaw>::template Law<T> {
    using Inner = typename WithRules<ElasticLaw>::template Law<T>;
    T off_2 = T(0.0),
      off_3 = T(0.0);  ///< of the bonded points from the middle of the faces: WithOffsets knows
    static constexpr std::string_view name = joined_name<ElasticLaw<T>::name, name_with_rubbing>;
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
    static constexpr std::array<std::string_view, rubbed::count> history{"cracked", "slip_2",  "slip_3",
                                                                         "shear_2", "shear_3", "dissipated"};
    static constexpr std::size_t dissipated_at = rubbed::dissipated;

    VBOND_HD constexpr const Inner& intact() const { return *this; }
  };
};

/// Laws between centres whose bonds crack, and then rub.
template <class Law>
concept RubbingLaw = HasRules<Law> && Remembering<Law> && !OffsetLaw<Law> && requires(const Law& law) {
  law.intact();
};

/// The two faces of a cracked bond as they stand: n is the mean of their normals. t_2 and t_3, in which slip
/// is counted, lie in the plane across it: t_2 halves the angle between the axes n_2 of both ends as they are
/// seen along n. All three have length 1. Below 180 degrees of twist, where t_2 has no direction, these
/// follow it.
template <Scalar T>
struct Faces {
  Vec3<T> D;  ///< between the bonded points  [length]
  Vec3<T> n, t_2, t_3;
  Vec3<T> turns_i, turns_j;  ///< how the axis n_2 of each end turns about n with where its tip goes
  T sum;                     ///< length of n_i1 - n_j1
  T cos_half;                ///< of half the twist
  T arc;                     ///< by how much the twist is more than its chord, 2 sin(twist/2)
  T gap;                     ///< D.n - a: how far they stand open; < 0: how deep they are pressed  [length]

  VBOND_HD Vec3<T> along_faces(const Vec3<T>& v) const { return v - dot(v, n) * n; }
};

/// By how much an angle between -90 and 90 degrees is more than its sine, given that and its cosine. Of small
/// angles by ten terms of the series in the sine, of which the eleventh is 6e-16 of the sum at most; the
/// function of the C library takes one number at a time.
template <Scalar T>
VBOND_HD T angle_less_sine(const T& sine, const T& cosine) {
  using std::atan2;
  constexpr std::size_t terms = 10;
  constexpr auto coefficients = [] {  // (2n)! / (4^n n!^2 (2n + 1)) for n = 1 .. terms
    std::array<double, terms> c{};
    double share = 1.0;
    for (std::size_t n = 1; n <= terms; ++n) {
      const auto twice = static_cast<double>(2 * n);
      share *= (twice - 1.0) / twice;
      c[n - 1] = share / (twice + 1.0);
    }
    return c;
  }();
  const T square = sq(sine), small(0.04);
  T sum(coefficients[terms - 1]);
  for (std::size_t n = terms - 1; n-- > 0;) sum = sum * square + T(coefficients[n]);
  const T series = sine * square * sum;
  if (!any_greater(square, small)) return series;
  return where_greater(square, small, atan2(sine, cosine) - sine, series);
}

template <class Law, Scalar T>
VBOND_HD Faces<T> faces_of(const Law& m, const BondPose<T>& b, const Vec3<T>& D) {
  using std::sqrt;
  const Vec3<T> n = b.n_i[0] - b.n_j[0];
  Faces<T> f;
  f.D = D;
  f.sum = norm(n);
  f.n = n / f.sum;
  const Vec3<T> seen_i = f.along_faces(b.n_i[1]), seen_j = f.along_faces(b.n_j[1]);
  const T size_i = norm(seen_i), size_j = norm(seen_j);
  const Vec3<T> of_i = seen_i / size_i, of_j = seen_j / size_j;
  f.turns_i = cross(f.n, of_i) / size_i, f.turns_j = cross(f.n, of_j) / size_j;
  const Vec3<T> both = of_i + of_j;
  const T length2 = norm2(both), one(1.0);
  const T safe2 = where_greater(length2, T(0.0), length2, one), length = sqrt(safe2);  // opposite: any
  f.t_2 = both / length;
  f.t_3 = cross(f.n, f.t_2);
  f.cos_half = dot(of_j, f.t_2);
  const T sin_half = dot(of_j, f.t_3);
  f.arc = T(2.0) * angle_less_sine(sin_half, where_greater(length2, T(0.0), f.cos_half, one));
  f.gap = dot(D, f.n) - m.a;
  return f;
}

/// What cracked faces carry, given their slip.
template <RubbingLaw Law, Scalar T>
struct FaceForces {
  BondStiffness<T> c;
  T s_2, s_3;  ///< slip along t_2 and t_3, less the arc of the cell about the joint's centre over its chord
  Vec3<T> shift;  ///< elastic, along the faces  [length]
  T pressed;      ///< the gap where it is < 0, else 0

  VBOND_HD FaceForces(const Law& m, const Faces<T>& f, const LawHistory<Law>& h)
      : c(stiffness(m)),
        s_2(h.value[rubbed::slip] + f.arc * m.off_3),
        s_3(h.value[rubbed::slip + 1] - f.arc * m.off_2),
        shift(f.along_faces(f.D) - s_2 * f.t_2 - s_3 * f.t_3),
        pressed(where_greater(T(0.0), f.gap, f.gap, T(0.0))) {}
  VBOND_HD T N() const { return c.c_A * pressed; }      ///< <= 0
  VBOND_HD Vec3<T> Q() const { return c.c_D * shift; }  ///< shear force on i
};

template <RubbingLaw Law, Scalar T>
VBOND_HD BondEnergy<T> face_energy(const Law& m, const BondPose<T>& b, const Vec3<T>& D,
                                   const LawHistory<Law>& h) {
  const FaceForces<Law, T> at(m, faces_of(m, b, D), h);
  return {T(0.5) * at.c.c_A * sq(at.pressed), T(0.5) * at.c.c_D * norm2(at.shift), T(0.0)};
}

/// The gradient of face_energy at fixed slip: of N along the mean normal and Q along the faces, with what
/// turns the normal and the directions that slip is counted along.
template <RubbingLaw Law, Scalar T>
VBOND_HD BondLoads<T> face_loads(const Law& m, const BondPose<T>& b, const Faces<T>& f,
                                 const LawHistory<Law>& h) {
  const FaceForces<Law, T> at(m, f, h);
  const T N = at.N(), half(0.5), one(1.0);
  const Vec3<T> Q = at.Q(), F = N * f.n + Q;
  // dU = F.dD + g.dn + A_i da_i + A_j da_j with the angles a of both axes n_2 about n: t_2 turns by half
  // their sum, and the twist is their difference. da = turns.(dn_2 - (n_2.n) dn).
  const T Q_2 = dot(Q, f.t_2), Q_3 = dot(Q, f.t_3);
  const T turned = half * (at.s_2 * Q_3 - at.s_3 * Q_2),
          twisted = (one - f.cos_half) * (m.off_3 * Q_2 - m.off_2 * Q_3);
  const Vec3<T> A_i = (twisted - turned) * f.turns_i, A_j = -(twisted + turned) * f.turns_j;
  // n = (n_i1 - n_j1)/sum, so that only what is normal to n counts
  const Vec3<T> of_n = N * f.D - dot(f.D, f.n) * Q - dot(b.n_i[1], f.n) * A_i - dot(b.n_j[1], f.n) * A_j;
  const Vec3<T> g = f.along_faces(of_n) / f.sum;
  return {F, cross(b.n_i[0], m.R_i * F - g) - cross(b.n_i[1], A_i),
          -cross(b.n_j[0], m.R_j * F - g) - cross(b.n_j[1], A_j)};
}

/// Numbers of cracked bonds where they are, else of intact ones.
template <RubbingLaw Law, Scalar T>
VBOND_HD T where_cracked(const LawHistory<Law>& h, const T& cracked, const T& intact) {
  return where_greater(h.value[rubbed::cracked], T(0.5), cracked, intact);
}
template <RubbingLaw Law, Scalar T>
VBOND_HD Vec3<T> where_cracked(const LawHistory<Law>& h, const Vec3<T>& cracked, const Vec3<T>& intact) {
  return {where_cracked<Law>(h, cracked.x, intact.x), where_cracked<Law>(h, cracked.y, intact.y),
          where_cracked<Law>(h, cracked.z, intact.z)};
}
template <RubbingLaw Law>
VBOND_HD bool any_cracked(const LawHistory<Law>& h) {
  return any_greater(h.value[rubbed::cracked], typename Law::Number(0.5));
}

template <RubbingLaw Law, Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Law& m, const BondPose<T>& b, const LawHistory<Law>& h) {
  const BondEnergy<T> whole = bond_energy(m.intact(), b);
  if (!any_cracked<Law>(h)) return whole;
  const BondEnergy<T> U = face_energy(m, b, bonded_points(b, m.R_i, m.R_j), h);
  return {where_cracked<Law>(h, U.U_L, whole.U_L), where_cracked<Law>(h, U.U_B, whole.U_B),
          where_cracked<Law>(h, U.U_T, whole.U_T)};
}
/// Loads of bonds of which at least one is cracked, whose faces stand like this.
template <RubbingLaw Law, Scalar T>
VBOND_HD BondLoads<T> loads_of_some_cracked(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                            const Faces<T>& f, const LawHistory<Law>& h) {
  const BondLoads<T> l = face_loads(m, b, f, h);
  if (!any_greater(T(0.5), h.value[rubbed::cracked])) return l;  // all are
  const BondLoads<T> whole = bond_loads(m.intact(), b, axis);
  return {where_cracked<Law>(h, l.F, whole.F), where_cracked<Law>(h, l.M_ij, whole.M_ij),
          where_cracked<Law>(h, l.M_ji, whole.M_ji)};
}
template <RubbingLaw Law, Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const LawHistory<Law>& h) {
  if (!any_cracked<Law>(h)) return bond_loads(m.intact(), b, axis);
  return loads_of_some_cracked(m, b, axis, faces_of(m, b, axis.D * axis.d), h);
}

/// By the length alone, which is all that there is to tell of faces that have neither slipped nor turned.
template <RubbingLaw Law, Scalar T>
VBOND_HD T tension(const Law& m, const T& D, const LawHistory<Law>& h) {
  const T N = tension(m.intact(), D), zero(0.0);
  return where_cracked<Law>(h, where_greater(zero, N, N, zero), N);
}
template <RubbingLaw Law, Scalar T>
VBOND_HD T stretch_energy(const Law& m, const T& D, const LawHistory<Law>& h) {
  const T U = stretch_energy(m.intact(), D);
  return where_cracked<Law>(h, where_greater(m.a, D, U, T(0.0)), U);
}

// the same for a bond that remembers nothing yet
template <RubbingLaw Law, Scalar T>
VBOND_HD T stretch_energy(const Law& m, const T& D) {
  return stretch_energy(m.intact(), D);
}
template <RubbingLaw Law, Scalar T>
VBOND_HD T tension(const Law& m, const T& D) {
  return tension(m.intact(), D);
}
template <RubbingLaw Law, Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Law& m, const BondPose<T>& b) {
  return bond_energy(m.intact(), b);
}
template <RubbingLaw Law, Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return bond_loads(m.intact(), b, axis);
}

/// Faces slip until the shear force is mu times the pressure; open ones carry none. A step dissipates the
/// mean of the shear forces at its ends times the slip, which is the work that a leap-frog step counts.
template <RubbingLaw Law, Scalar T>
VBOND_HD LawHistory<Law> slide(const Law& m, const Faces<T>& f, const LawHistory<Law>& before) {
  using std::sqrt;
  LawHistory<Law> h = before;
  const T zero(0.0), one(1.0);
  const FaceForces<Law, T> at(m, f, before);
  const T limit = T(-m.rules->rubbing.friction) * at.N(), limit2 = sq(limit), Q2 = norm2(at.Q());
  const T held = where_greater(Q2, limit2, limit / sqrt(where_greater(Q2, limit2, Q2, one)), one);
  const T kept = where_greater(zero, f.gap, held, zero);  // of the shift, which is elastic
  const Vec3<T> slid = (one - kept) * at.shift, Q = kept * at.Q();
  const Vec3<T> Q_before = h.value[rubbed::shear] * f.t_2 + h.value[rubbed::shear + 1] * f.t_3;
  const T slip[2] = {dot(slid, f.t_2), dot(slid, f.t_3)}, shear[2] = {dot(Q, f.t_2), dot(Q, f.t_3)};
  for (std::size_t k = 0; k < 2; ++k) {
    h.value[rubbed::slip + k] =
        where_cracked<Law>(before, before.value[rubbed::slip + k] + slip[k], before.value[rubbed::slip + k]);
    h.value[rubbed::shear + k] = where_cracked<Law>(before, shear[k], before.value[rubbed::shear + k]);
  }
  const T lost = before.value[rubbed::dissipated] + T(0.5) * dot(Q_before + Q, slid);
  h.value[rubbed::dissipated] = where_cracked<Law>(before, lost, before.value[rubbed::dissipated]);
  return h;
}

template <RubbingLaw Law, Scalar T>
VBOND_HD LawHistory<Law> advance(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const BondRates<T>& /*rates*/, const T& /*dt*/,
                                 const LawHistory<Law>& before) {
  return any_cracked<Law>(before) ? slide(m, faces_of(m, b, axis.D * axis.d), before) : before;
}
/// The faces are worked out once for both.
template <RubbingLaw Law, Scalar T>
VBOND_HD Advanced<Law> advance_with_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                          const BondRates<T>& /*rates*/, const T& /*dt*/,
                                          const LawHistory<Law>& before) {
  if (!any_cracked<Law>(before)) return {before, bond_loads(m.intact(), b, axis)};
  const Faces<T> f = faces_of(m, b, axis.D * axis.d);
  const LawHistory<Law> h = slide(m, f, before);
  return {h, loads_of_some_cracked(m, b, axis, f, h)};
}

/// What it remembers once it has cracked as it stands: of its shear force as much is left as faces so
/// pressed can carry. What that takes from its energy is released, and not dissipated by friction.
template <RubbingLaw Law, Scalar T>
VBOND_HD LawHistory<Law> crack(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                               const LawHistory<Law>& before) {
  LawHistory<Law> h = before;
  h.value[rubbed::cracked] = T(1.0);
  h = advance(m, b, axis, BondRates<T>{}, T(0.0), h);
  h.value[rubbed::dissipated] = before.value[rubbed::dissipated];
  return h;
}

/// Of intact bonds. What is cracked does not break again.
template <RubbingLaw Law, Scalar T>
VBOND_HD Failure<T> bond_failure(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const BondLoads<T>& loads, const LawHistory<Law>& h) {
  Failure<T> f = bond_failure(m.intact(), b, axis, loads);
  const T zero(0.0);
  for (T* share : {&f.tension, &f.shear, &f.bending, &f.torsion, &f.compression, &f.utilisation})
    *share = where_cracked<Law>(h, zero, *share);
  return f;
}
/// Of a cracked bond, how far the middles of the faces of its joint have moved along these, or stand open, as
/// a part of the reach, squared: at 1 the faces have left each other. How they turn, and how deep they are
/// pressed, does not part them, and all cells of a joint tell the same.
template <RubbingLaw Law, Scalar T>
VBOND_HD T parting(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  const Vec3<T> D = axis.D * axis.d - m.off_2 * (b.n_j[1] - b.n_i[1]) - m.off_3 * (b.n_j[2] - b.n_i[2]);
  const Faces<T> f = faces_of(m, b, D);
  const T reach2 = T(sq(m.rules->rubbing.reach)) * own_radius2(stiffness(m)), zero(0.0);
  const T moved2 = norm2(f.along_faces(D)) + sq(where_greater(f.gap, zero, f.gap, zero));
  return moved2 / where_greater(reach2, zero, reach2, T(1.0));
}
/// At 1 an intact bond cracks, and the faces of a cracked one part.
template <RubbingLaw Law, Scalar T>
VBOND_HD T utilisation(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis, const BondLoads<T>& loads,
                       const LawHistory<Law>& h) {
  const T of_intact = bond_failure(m, b, axis, loads, h).utilisation;
  if (!any_cracked<Law>(h)) return of_intact;
  return where_cracked<Law>(h, parting(m, b, axis), of_intact);
}

/// The pose by which the range of a bond is judged: of a cracked one without the shift of its faces.
template <RubbingLaw Law, Scalar T>
VBOND_HD BondPose<T> elastic_pose(const Law& m, const BondPose<T>& b, const LawHistory<Law>& h) {
  BondPose<T> p = b;
  p.r_ij = bonded_points(b, m.R_i, m.R_j);
  if (!any_cracked<Law>(h)) return p;
  const Faces<T> f = faces_of(m, b, p.r_ij);
  p.r_ij = where_cracked<Law>(h, m.a * f.n, p.r_ij);
  return p;
}

}  // namespace vbond
