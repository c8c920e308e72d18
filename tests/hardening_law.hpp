#pragma once
#include <array>
#include <string_view>

#include "vbond/physics/laws.hpp"

/// An elastic law of a program's own with five coefficients, for tests of what the library makes of it.
namespace vbond::testing {

/// The EVM with a tension that hardens: N = B1 u (1 + u^2/s^2).
template <Scalar T>
struct Hardening : Evm<T> {
  T per_s2;  ///< 1/s^2  [1/length^2]

  static constexpr std::string_view name = "hardening", title = "EVM that hardens";
  static constexpr auto fields() {
    constexpr auto evm = Evm<T>::fields();
    using Field = LawField<Hardening>;
    return std::array{Field{evm[0].at, evm[0].info}, Field{evm[1].at, evm[1].info},
                      Field{evm[2].at, evm[2].info}, Field{evm[3].at, evm[3].info},
                      Field{&Hardening::per_s2, {"per_s2", {0, -2}, "hardening", LawInput::given}}};
  }
  static constexpr Hardening from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    return {Evm<T>::from(c, a, R_i, R_j), T(0.0)};
  }
  VBOND_HD constexpr const Evm<T>& evm() const { return *this; }
};
template <Scalar T>
VBOND_HD T stretch_energy(const Hardening<T>& m, const T& D) {
  const T u = D - m.a;
  return stretch_energy(m.evm(), D) + T(0.25) * m.B1 * m.per_s2 * sq(sq(u));
}
template <Scalar T>
VBOND_HD T tension(const Hardening<T>& m, const T& D) {
  const T u = D - m.a;
  return tension(m.evm(), D) + m.B1 * m.per_s2 * sq(u) * u;
}
template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Hardening<T>& m, const BondPose<T>& b) {
  BondEnergy<T> U = bond_energy(m.evm(), b);
  U.U_L = stretch_energy(m, norm(bonded_points(b, m.R_i, m.R_j)));
  return U;
}
template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Hardening<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return loads_at_tension(m.evm(), b, axis, tension(m, axis.D));
}
template <Scalar T>
VBOND_HD constexpr BondStiffness<T> stiffness(const Hardening<T>& m) {
  return stiffness(m.evm());
}
inline BondRange bond_range(const Hardening<double>& m, const BondShape& s) {
  return bond_range(m.evm(), s);
}

}  // namespace vbond::testing
