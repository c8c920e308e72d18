#pragma once
#include "vbond/physics/strength.hpp"
#include "vbond/physics/with_offsets.hpp"
#include "vbond/physics/with_rubbing.hpp"
#include "vbond/physics/with_rules.hpp"

namespace vbond {

/// Below 1 only if the utilisation is, and quick to work out: most bonds are far from breaking most of the
/// time. At most six times the square of the sum of all shares. Nothing of use for `energy` and `elongation`.
template <Scalar T>
VBOND_HD T utilisation_bound(const Strength& s, const BondStiffness<T>& c, const T& R_i, const T& R_j,
                             const BondLoads<T>& loads, const T& per_factor) {
  if (s.criterion == Criterion::energy || s.criterion == Criterion::elongation) return T(1e300);
  const bool sums = s.criterion == Criterion::linear || s.criterion == Criterion::quadratic;
  const double of_F = sums ? s.axial + s.shear : larger(larger(s.axial, s.shear + s.friction), s.compression);
  const double of_M =
      sums ? s.bending + s.torsion : larger(larger(s.bending, s.torsion), s.compression_bending);
  // no component is larger than its vector, no moment between the ends than the larger one there, and
  // (x + y)^2 <= 2 x^2 + 2 y^2, here with a hundredth for rounding
  const T two(2.02), R = larger(R_i, R_j);
  T F2 = norm2(loads.F);
  T M2 = two * (larger(norm2(loads.M_ij), norm2(loads.M_ji)) + sq(R) * F2);
  if (s.own_section) {
    const T r2 = own_radius2(c), per_A2 = sq(T(std::numbers::inv_pi) / r2);
    F2 = per_A2 * F2, M2 = T(16.0) * per_A2 / r2 * M2;
  }
  return two * sq(per_factor) * (T(of_F * of_F) * F2 + T(of_M * of_M) * M2);
}

/// The same for a bond by its elastic loads. Loops leave out the utilisation() of bonds for which it is below
/// 1; of a law without this function they work out all.
template <RuledLaw Law, Scalar T>
VBOND_HD T utilisation_bound(const Law& m, const BondPose<T>& /*b*/, const BondAxis<T>& /*axis*/,
                             const BondLoads<T>& loads, const LawHistory<Law>& /*h*/ = {}) {
  return utilisation_bound(m.rules->strength, stiffness(m), m.R_i, m.R_j, loads, T(1.0) + m.weakness);
}
/// Of cracked bonds it is the utilisation.
template <RubbingLaw Law, Scalar T>
VBOND_HD T utilisation_bound(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                             const BondLoads<T>& loads, const LawHistory<Law>& h) {
  const T of_intact = utilisation_bound(m.intact(), b, axis, loads);
  return any_cracked<Law>(h) ? where_cracked<Law>(h, parting(m, b, axis), of_intact) : of_intact;
}
template <OffsetLaw Law, Scalar T>
requires RuledLaw<typename Law::Centred> || RubbingLaw<typename Law::Centred> VBOND_HD T
utilisation_bound(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis, const BondLoads<T>& loads,
                  const LawHistory<Law>& h) {
  return utilisation_bound(m.centred(), m.at_offsets(b), axis, m.at_offsets(b, loads),
                           history_as<typename Law::Centred>(h));
}

}  // namespace vbond
