#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "vbond/physics/bond_rules.hpp"
#include "vbond/physics/law.hpp"

namespace vbond {

/// The letters of `first` and then of `more`, in an array that outlives every string_view of it.
template <const std::string_view& first, const std::string_view& more>
inline constexpr auto letters_of_both = [] {
  std::array<char, first.size() + more.size()> letters{};
  std::copy(more.begin(), more.end(), std::copy(first.begin(), first.end(), letters.begin()));
  return letters;
}();
template <const std::string_view& first, const std::string_view& more>
inline constexpr std::string_view joined_name{letters_of_both<first, more>.data(),
                                              letters_of_both<first, more>.size()};
inline constexpr std::string_view name_with_rules = "-with-rules", name_with_flow = "-with-flow";

/// Any elastic law with a stretching, damping and strength by rules. No bond of such a law remembers
/// anything.
template <template <class> class ElasticLaw>
struct WithRules {
  template <Scalar T>
  struct Law : ElasticLaw<T> {
    using Elastic = ElasticLaw<T>;
    T g_A, g_D;  ///< damping of stretching and shear  [force*time/length]
    T g_B, g_T;  ///< damping of bending and torsion  [force*length*time]
    T weakness;  ///< one over the factor of the bond's own strength, less one: 0 for a bond of mean strength
    const BondRules* rules = &no_rules;  ///< never null

    static constexpr std::string_view name = joined_name<Elastic::name, name_with_rules>;
    static constexpr auto fields() {
      constexpr auto elastic = Elastic::fields();
      constexpr auto given = LawInput::given;
      constexpr std::size_t count = elastic.size();
      std::array<LawField<Law>, count + rule_coefficients> all{};
      for (std::size_t k = 0; k < count; ++k) all[k] = {elastic[k].at, elastic[k].info};
      all[count + 0] = {&Law::g_A, {"g_A", force_per_length, "damping of stretching, times a time", given}};
      all[count + 1] = {&Law::g_D, {"g_D", force_per_length, "damping of shear, times a time", given}};
      all[count + 2] = {&Law::g_B, {"g_B", force_times_length, "damping of bending, times a time", given}};
      all[count + 3] = {&Law::g_T, {"g_T", force_times_length, "damping of torsion, times a time", given}};
      all[count + 4] = {&Law::weakness, {"weakness", {0, 0}, "1 over the factor of strength, less 1", given}};
      return all;
    }
    static constexpr Law from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
      Law law{};
      static_cast<Elastic&>(law) = Elastic::from(c, a, R_i, R_j);
      law.g_A = law.g_D = law.g_B = law.g_T = law.weakness = T(0.0);
      return law;
    }
    VBOND_HD constexpr const Elastic& elastic() const { return *this; }
  };
};

template <class Law>
concept HasRules = requires(const Law& law) {
  *law.rules;
  law.elastic();
};
/// Laws of with_offsets.hpp, around a law with rules that stands between centres.
template <class Law>
concept OffsetLaw = HasRules<Law> && requires(const Law& law) {
  law.centred();
};
/// Laws between centres whose bonds remember nothing.
template <class Law>
concept RuledLaw = HasRules<Law> && !Remembering<Law> && !OffsetLaw<Law>;
/// Laws that rules may be added to: elastic and no more, and with room for the coefficients of rules.
template <class Law>
concept TakesRules = !HasRules<Law> && !ReadsRates<Law> && !Breakable<Law> &&
                     coefficients_of<Law> + rule_coefficients <= most_coefficients;
/// Whether the last coefficients of a law with rules are those that rules have: they are found by their
/// place.
template <class Law>
constexpr bool rules_come_last() {
  constexpr auto all = Law::fields();
  constexpr std::size_t n = all.size();
  if constexpr (n < rule_coefficients)
    return false;
  else
    return all[n - 5].at == &Law::g_A && all[n - 4].at == &Law::g_D && all[n - 3].at == &Law::g_B &&
           all[n - 2].at == &Law::g_T && all[n - 1].at == &Law::weakness;
}

/// The longitudinal stiffness about rest, which forms of stretching begin with.
template <HasRules Law>
VBOND_HD constexpr auto axial_stiffness(const Law& m) {
  return stiffness(m.elastic()).c_A;
}

/// Energy of stretching to the length D, and its derivative, positive in tension.  [energy], [force]
template <RuledLaw Law, Scalar T>
VBOND_HD T stretch_energy(const Law& m, const T& D) {
  if (m.rules->stretch.form == StretchForm::harmonic) return stretch_energy(m.elastic(), D);
  return stretch_energy(m.rules->stretch, axial_stiffness(m), m.a, D);
}
template <RuledLaw Law, Scalar T>
VBOND_HD T tension(const Law& m, const T& D) {
  if (m.rules->stretch.form == StretchForm::harmonic) return tension(m.elastic(), D);
  return tension(m.rules->stretch, axial_stiffness(m), m.a, D);
}

/// Loads of an elastic law with the tension N in place of its own: by the law's own function of this name, or
/// with a force along the axis that makes up the difference.
template <class Elastic, Scalar T>
VBOND_HD BondLoads<T> loads_at_tension(const Elastic& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                       const T& N) {
  const BondLoads<T> l = bond_loads(m, b, axis);
  const Vec3<T> more = (N - tension(m, axis.D)) * axis.d;
  return {l.F + more, l.M_ij + m.R_i * cross(b.n_i[0], more), l.M_ji - m.R_j * cross(b.n_j[0], more)};
}

template <RuledLaw Law, Scalar T>
VBOND_HD BondEnergy<T> bond_energy(const Law& m, const BondPose<T>& b) {
  BondEnergy<T> U = bond_energy(m.elastic(), b);
  if (m.rules->stretch.form != StretchForm::harmonic)
    U.U_L = stretch_energy(m, norm(bonded_points(b, m.R_i, m.R_j)));
  return U;
}
template <RuledLaw Law, Scalar T>
VBOND_HD BondLoads<T> bond_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return loads_at_tension(m.elastic(), b, axis, tension(m, axis.D));
}

/// Stiffnesses about rest, and the stiffest that the step allows for.
template <HasRules Law>
VBOND_HD constexpr auto stiffness(const Law& m) {
  return stiffness(m.elastic());
}
template <HasRules Law>
BondStiffness<double> stiffest(const Law& m) {
  BondStiffness<double> c = [&] {
    if constexpr (requires { stiffest(m.elastic()); })
      return stiffest(m.elastic());
    else
      return stiffness(m);
  }();
  if (m.rules->stretch.form != StretchForm::harmonic)
    c.c_A = stiffest(m.rules->stretch, axial_stiffness(m), m.a);
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
