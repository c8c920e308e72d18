#pragma once
#include <array>
#include <string_view>

#include "vbond/dynamics/law_with_loops.hpp"
#include "vbond/physics/section.hpp"
#include "vbond/physics/vmodel.hpp"

/// Laws that damp, remember and break, for tests of what carries them.
namespace vbond::testing {

/// The V-model with something more: a law of its own needs its name, its coefficients and their list.
template <Scalar T>
constexpr VModel<T> elastic_part(const auto& m) {
  return {m.a, m.R_i, m.R_j, m.B1, m.B2, m.B3, m.B4};
}
template <class Law>
constexpr LawField<Law> field_of(typename Law::Number Law::*at, std::size_t k) {
  return {at, VModel<double>::fields()[k].info};
}
template <class Law>
constexpr LawField<Law> given(typename Law::Number Law::*at, std::string_view name, LawDimension dimension) {
  return {at, {name, dimension, "of a test", LawInput::given}};
}

/// Damped by channel: R = (g_A v_n^2 + g_D v_s^2 + g_B w_t^2 + g_T w_n^2) / 2 is half the power taken out.
template <Scalar T>
struct Damped {
  using Number = T;
  T a, R_i, R_j, B1, B2, B3, B4;
  T g_A, g_D;  ///< [force*time/length]
  T g_B, g_T;  ///< [force*length*time]

  static constexpr std::string_view name = "damped", title = "damped V-model";
  static constexpr double strained_past = 45;
  static constexpr std::string_view rest_condition = VModel<T>::rest_condition,
                                    rest_way_out = VModel<T>::rest_way_out;
  static constexpr auto fields() {
    return std::array{field_of<Damped>(&Damped::B1, 0),
                      field_of<Damped>(&Damped::B2, 1),
                      field_of<Damped>(&Damped::B3, 2),
                      field_of<Damped>(&Damped::B4, 3),
                      given<Damped>(&Damped::g_A, "g_A", {1, -1}),
                      given<Damped>(&Damped::g_D, "g_D", {1, -1}),
                      given<Damped>(&Damped::g_B, "g_B", {1, 1}),
                      given<Damped>(&Damped::g_T, "g_T", {1, 1})};
  }
  static constexpr Damped from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    const VModel<T> m = VModel<T>::from(c, a, R_i, R_j);
    return {a, R_i, R_j, m.B1, m.B2, m.B3, m.B4, T(0.0), T(0.0), T(0.0), T(0.0)};
  }
};
template <Scalar T>
VBOND_HD T stretch_energy(const Damped<T>& m, const T& D) {
  return stretch_energy(elastic_part<T>(m), D);
}
template <Scalar T>
VBOND_HD T tension(const Damped<T>& m, const T& D) {
  return tension(elastic_part<T>(m), D);
}
template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Damped<T>& m, const BondPose<T>& b) {
  return bond_energy(elastic_part<T>(m), b);
}
template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Damped<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return bond_loads(elastic_part<T>(m), b, axis);
}
template <Scalar T>
constexpr BondStiffness<T> stiffness(const Damped<T>& m) {
  return stiffness(elastic_part<T>(m));
}
template <Scalar T>
constexpr BondStiffness<T> damping(const Damped<T>& m) {
  return {m.g_A, m.g_D, m.g_B, m.g_T};
}
inline BondRange bond_range(const Damped<double>&, const BondShape& s) {
  return bond_range(VModel<double>{}, s);
}
template <Scalar T>
VBOND_HD BondLoads<T> bond_damping(const Damped<T>& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                   const BondRates<T>& rates) {
  return linear_damping(damping(m), b, m.R_i, m.R_j, axis, rates);
}

/// Flows along its axis like a dashpot in series, its length at rest growing by N/eta per time, and breaks at
/// a tension.
template <Scalar T>
struct Brittle {
  using Number = T;
  T a, R_i, R_j, B1, B2, B3, B4;
  T per_eta;       ///< [length/(force*time)]
  T per_strength;  ///< [1/force]

  static constexpr std::string_view name = "brittle", title = "brittle V-model";
  static constexpr double strained_past = 45;
  static constexpr std::string_view rest_condition = VModel<T>::rest_condition,
                                    rest_way_out = VModel<T>::rest_way_out;
  static constexpr std::array<std::string_view, 1> history{"flow"};
  static constexpr auto fields() {
    return std::array{field_of<Brittle>(&Brittle::B1, 0),
                      field_of<Brittle>(&Brittle::B2, 1),
                      field_of<Brittle>(&Brittle::B3, 2),
                      field_of<Brittle>(&Brittle::B4, 3),
                      given<Brittle>(&Brittle::per_eta, "per_eta", {-1, 1}),
                      given<Brittle>(&Brittle::per_strength, "per_strength", {-1, 0})};
  }
  static constexpr Brittle from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    const VModel<T> m = VModel<T>::from(c, a, R_i, R_j);
    return {a, R_i, R_j, m.B1, m.B2, m.B3, m.B4, T(0.0), T(0.0)};
  }
};
template <Scalar T>
VBOND_HD VModel<T> flowed(const Brittle<T>& m, const LawHistory<Brittle<T>>& h) {
  return {m.a + h.value[0], m.R_i, m.R_j, m.B1, m.B2, m.B3, m.B4};
}
template <Scalar T>
VBOND_HD T tension(const Brittle<T>& m, const T& D, const LawHistory<Brittle<T>>& h) {
  return tension(flowed(m, h), D);
}
template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Brittle<T>& m, const BondPose<T>& b,
                                   const LawHistory<Brittle<T>>& h) {
  return bond_energy(flowed(m, h), b);
}
template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Brittle<T>& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const LawHistory<Brittle<T>>& h) {
  return bond_loads(flowed(m, h), b, axis);
}
template <Scalar T>
VBOND_HD LawHistory<Brittle<T>> advance(const Brittle<T>& m, const BondPose<T>&, const BondAxis<T>& axis,
                                        const BondRates<T>&, const T& dt, const LawHistory<Brittle<T>>& h) {
  LawHistory<Brittle<T>> now;
  now.value[0] = h.value[0] + dt * m.per_eta * tension(m, axis.D, h);
  return now;
}
template <Scalar T>
VBOND_HD T utilisation(const Brittle<T>& m, const BondPose<T>&, const BondAxis<T>& axis, const BondLoads<T>&,
                       const LawHistory<Brittle<T>>& h) {
  return m.per_strength * tension(m, axis.D, h);
}
template <Scalar T>
constexpr BondStiffness<T> stiffness(const Brittle<T>& m) {
  return stiffness(elastic_part<T>(m));
}
inline BondRange bond_range(const Brittle<double>&, const BondShape& s) {
  return bond_range(VModel<double>{}, s);
}

inline const BondLaw damped_law = law_with_loops<Damped>(), brittle_law = law_with_loops<Brittle>();

}  // namespace vbond::testing
