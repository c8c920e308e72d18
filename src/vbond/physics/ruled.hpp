#pragma once
#include <array>
#include <string_view>

#include "vbond/physics/evm.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/rules.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond {

/// Bending, shear and torsion of an elastic law, with a stretching, damping and strength by rules. No bond of
/// such a law remembers anything.
template <class Law, template <class> class ElasticLaw, Scalar T>
struct Ruled {
  using Number = T;
  using Elastic = ElasticLaw<T>;
  T a;           ///< length at rest between the bonded points  [length], > 0
  T R_i, R_j;    ///< bonded points' distances from the centres  [length]
  T B1;          ///< [force/length]
  T B2, B3, B4;  ///< [force*length]
  T g_A, g_D;    ///< damping of stretching and shear  [force*time/length]
  T g_B, g_T;    ///< damping of bending and torsion  [force*length*time]
  T weakness;    ///< one over the factor of the bond's own strength, less one: 0 for a bond of mean strength
  const BondRules* rules = &no_rules;  ///< never null

  static constexpr double strained_past = Elastic::strained_past;
  static constexpr std::string_view rest_condition = Elastic::rest_condition,
                                    rest_way_out = Elastic::rest_way_out;
  static constexpr auto fields() {
    constexpr auto e = Elastic::fields();
    constexpr auto given = LawInput::given;
    return std::array<LawField<Law>, 9>{
        {{&Law::B1, e[0].info},
         {&Law::B2, e[1].info},
         {&Law::B3, e[2].info},
         {&Law::B4, e[3].info},
         {&Law::g_A, {"g_A", force_per_length, "damping of stretching, times a time", given}},
         {&Law::g_D, {"g_D", force_per_length, "damping of shear, times a time", given}},
         {&Law::g_B, {"g_B", force_times_length, "damping of bending, times a time", given}},
         {&Law::g_T, {"g_T", force_times_length, "damping of torsion, times a time", given}},
         {&Law::weakness, {"weakness", {0, 0}, "1 over the factor of strength, less 1", given}}}};
  }
  static constexpr Law from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    const Elastic e = Elastic::from(c, a, R_i, R_j);
    const T zero(0.0);
    Law law{};
    law.a = a, law.R_i = R_i, law.R_j = R_j;
    law.B1 = e.B1, law.B2 = e.B2, law.B3 = e.B3, law.B4 = e.B4;
    law.g_A = law.g_D = law.g_B = law.g_T = law.weakness = zero;
    return law;
  }
  VBOND_HD Elastic elastic() const { return {a, R_i, R_j, B1, B2, B3, B4}; }
};

template <Scalar T>
struct RuledVModel : Ruled<RuledVModel<T>, VModel, T> {
  static constexpr std::string_view name = "v-model-with-rules", title = "V-model";
};
template <Scalar T>
struct RuledEvm : Ruled<RuledEvm<T>, Evm, T> {
  static constexpr std::string_view name = "evm-with-rules", title = "enhanced vector model (EVM)";
};

template <class Law>
concept HasRules = requires(const Law& law) {
  *law.rules;
};
/// Laws whose bonds remember nothing.
template <class Law>
concept RuledLaw = HasRules<Law> && !Remembering<Law>;

/// Energy of stretching to the length D, and its derivative, positive in tension.  [energy], [force]
template <RuledLaw Law, Scalar T>
VBOND_HD T stretch_energy(const Law& m, const T& D) {
  if (m.rules->stretch.form == StretchForm::harmonic) return stretch_energy(m.elastic(), D);
  return stretch_energy(m.rules->stretch, m.B1, m.a, D);
}
template <RuledLaw Law, Scalar T>
VBOND_HD T tension(const Law& m, const T& D) {
  if (m.rules->stretch.form == StretchForm::harmonic) return tension(m.elastic(), D);
  return tension(m.rules->stretch, m.B1, m.a, D);
}

template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const RuledVModel<T>& m, const BondPose<T>& b) {
  return vmodel_energy(m, b);
}
template <Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const RuledEvm<T>& m, const BondPose<T>& b) {
  return evm_energy(m, b);
}
template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const RuledVModel<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return vmodel_loads(m, b, axis);
}
template <Scalar T>
VBOND_HD BondLoads<T> bond_loads(const RuledEvm<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return evm_loads(m, b, axis);
}

/// Stiffnesses about rest, and the stiffest that the step allows for.
template <HasRules Law>
VBOND_HD constexpr auto stiffness(const Law& m) {
  return stiffness(m.elastic());
}
template <HasRules Law>
BondStiffness<double> stiffest(const Law& m) {
  BondStiffness<double> c = stiffness(m);
  c.c_A = stiffest(m.rules->stretch, m.B1, m.a);
  return c;
}

template <HasRules Law>
VBOND_HD constexpr auto damping(const Law& m) {
  return BondStiffness<typename Law::Number>{m.g_A, m.g_D, m.g_B, m.g_T};
}
template <HasRules Law, Scalar T>
VBOND_HD BondLoads<T> bond_damping(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                   const BondRates<T>& rates) {
  return linear_damping(damping(m), b, m.R_i, m.R_j, axis, rates);
}
template <HasRules Law, Scalar T>
VBOND_HD DampingPowers<T> damping_powers(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                         const BondRates<T>& rates) {
  return linear_damping_powers(damping(m), b, m.R_i, m.R_j, axis, rates);
}

template <RuledLaw Law, Scalar T>
VBOND_HD Failure<T> bond_failure(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const BondLoads<T>& loads) {
  const T one(1.0);
  return failure(m.rules->strength, stiffness(m), b, m.R_i, m.R_j, axis, loads, axis.D / m.a - one,
                 one + m.weakness);
}
template <RuledLaw Law, Scalar T>
VBOND_HD T utilisation(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                       const BondLoads<T>& loads) {
  return bond_failure(m, b, axis, loads).utilisation;
}

template <HasRules Law>
BondRange bond_range(const Law& m, const BondShape& s) {
  return bond_range(m.elastic(), s);
}

}  // namespace vbond
