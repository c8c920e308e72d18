#pragma once
#include <array>
#include <string_view>

#include "vbond/physics/law.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond {

/// The V-model with a cubic force of stretching, N = B1 u + k3 u^2 + k4 u^3 with u = D - a. About rest it is
/// the V-model. Limits: the bound of the time step is that of rest, so k4 > 0 at large u takes a smaller
/// step; k3, and k4 < 0, let N fall from some u on.
template <Scalar T>
struct VModelCubic {
  using Number = T;
  T a;           ///< length at rest between the bonded points  [length], > 0
  T R_i, R_j;    ///< bonded points' distances from the centres  [length]
  T B1;          ///< [force/length]
  T B2, B3, B4;  ///< [force*length]
  T k3;          ///< [force/length^2]
  T k4;          ///< [force/length^3]

  static constexpr std::string_view name = "v-model-cubic", title = "V-model with cubic stretching";
  static constexpr double strained_past = VModel<T>::strained_past;
  static constexpr std::string_view rest_condition = VModel<T>::rest_condition,
                                    rest_way_out = VModel<T>::rest_way_out;
  static constexpr auto fields() {
    using Law = VModelCubic;
    constexpr auto v = VModel<T>::fields();
    return std::array<LawField<Law>, 6>{
        {{&Law::B1, v[0].info},
         {&Law::B2, v[1].info},
         {&Law::B3, v[2].info},
         {&Law::B4, v[3].info},
         {&Law::k3, {"k3", {1, -2}, "of u^2 in N = B1 u + k3 u^2 + k4 u^3", LawInput::given}},
         {&Law::k4, {"k4", {1, -3}, "of u^3", LawInput::given}}}};
  }

  /// Coefficients that match four stiffnesses exactly; k3 and k4 are left at zero.
  static constexpr VModelCubic from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    const VModel<T> m = VModel<T>::from(c, a, R_i, R_j);
    return {a, R_i, R_j, m.B1, m.B2, m.B3, m.B4, T(0.0), T(0.0)};
  }
};

/// Energy of stretching to the length D, and its derivative, positive in tension.  [energy], [force]
template <Scalar T>
VBOND_HD T stretch_energy(const VModelCubic<T>& m, const T& D) {
  const T u = D - m.a;
  return sq(u) * (T(0.5) * m.B1 + u * (T(1.0 / 3.0) * m.k3 + T(0.25) * m.k4 * u));
}
template <Scalar T>
VBOND_HD T tension(const VModelCubic<T>& m, const T& D) {
  const T u = D - m.a;
  return u * (m.B1 + u * (m.k3 + m.k4 * u));
}

template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const VModelCubic<T>& m, const BondPose<T>& b) {
  return vmodel_energy(m, b);
}
template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const VModelCubic<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return vmodel_loads(m, b, axis);
}

/// Stiffnesses about rest.
template <Scalar T>
constexpr BondStiffness<T> stiffness(const VModelCubic<T>& m) {
  return stiffness(VModel<T>{m.a, m.R_i, m.R_j, m.B1, m.B2, m.B3, m.B4});
}

inline BondRange bond_range(const VModelCubic<double>&, const BondShape& s) {
  return vmodel_range(s);
}

}  // namespace vbond
