#pragma once
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "vbond/physics/bond_numbers.hpp"
#include "vbond/physics/pose.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/stiffness.hpp"

namespace vbond {

/// What a coefficient of a law is measured in: powers of force and length.
struct LawDimension {
  int force = 0, length = 0;
  friend constexpr bool operator==(const LawDimension&, const LawDimension&) = default;
};
inline constexpr LawDimension force_per_length{1, -1}, force_times_length{1, 1};

/// Where a coefficient comes from, unless all coefficients are given: it follows from the four stiffnesses
/// and the length of the bond, or it is always given.
enum class LawInput : unsigned char { from_stiffness, given };

/// Values that a coefficient may have.
enum class LawBound : unsigned char { any, positive };

/// What is to be known of a coefficient besides its value.
struct LawFieldInfo {
  std::string_view name;
  LawDimension dimension;
  std::string_view meaning;
  LawInput input = LawInput::from_stiffness;
  LawBound bound = LawBound::any;
};

/// One entry of a law's list of coefficients.
template <class Law>
struct LawField {
  typename Law::Number Law::*at;
  LawFieldInfo info;
};

/// A bond law is a template over the scalar type with
///     using Number = T;
///     T a, R_i, R_j;                     length at rest, attachment distances
///     T ...;                             its coefficients, at most most_coefficients
///     static constexpr std::string_view name, title, rest_condition, rest_way_out;
///     static constexpr double strained_past;
///     static constexpr auto fields();    std::array of LawField: the one list of its coefficients
///     static constexpr Law from(stiffness, a, R_i, R_j);     coefficients that give these stiffnesses
/// and the functions bond_energy, stretch_energy, tension, bond_loads, stiffness and bond_range. Everything
/// else follows from these: packs of the step loop, checkpoint, keys of case files and their reference,
/// tangents by dual numbers, and the tests that every law must pass.
///
/// A law may have more:
///     bond_damping(law, pose, axis, rates)     loads that never give energy: power_taken() >= 0
///     damping(law)                             the slopes of these at rest, by channel, as a BondStiffness
///     damping_powers(law, pose, axis, rates)   what they take by channel, as DampingPowers, for the books
///     static constexpr std::array history{names}             what the bond remembers, zero at first: at most
///         most_history numbers.
///         bond_energy, tension and bond_loads then have a LawHistory as last argument, as do those
///         below
///     advance(law, pose, axis, rates, dt, history)           the new history, before the loads of a step
///     static constexpr std::size_t dissipated_at             which number of the history is the energy that
///         it has dissipated; without it, what a new history takes from the energy of a bond is
///     elastic_pose(law, pose, history)                       by which its range is judged, with R = 0
///     utilisation(law, pose, axis, loads[, history])         by its elastic loads; the bond breaks at 1
///     stiffest(law)                                          what the step allows for; else stiffness(law)
///     loads_at_tension(law, pose, axis, N)     its loads with the tension N in place of its own. A law that
///     is
///         derived from another one hands its base to that one's function: with itself it would call itself.
///     tension_is_linear<law> = true            see below
///
/// Of a law that is elastic and no more, with at most eight coefficients, the library also makes one with
/// rules (with_rules.hpp) and one with flow (with_flow.hpp): any form of stretching, damping, strength,
/// yielding, creep and softening, without a line of its own. So all its functions but bond_range are
/// templates over the scalar type.

/// Whether tension() of a law is c_A (D - a), so that its softening is worked out in closed form; a law says
/// so by a specialisation.
template <class Law>
inline constexpr bool tension_is_linear = false;

template <class Law>
inline constexpr std::size_t coefficients_of = Law::fields().size();

/// Coefficient number k of a law, as a pointer to its member.
template <class Law, std::size_t k>
inline constexpr auto coefficient = Law::fields()[k].at;

template <class Law>
inline constexpr std::size_t history_of = 0;
template <class Law>
requires requires {
  Law::history.size();
}
inline constexpr std::size_t history_of<Law> = Law::history.size();

/// What a bond of this law remembers, number by number.
template <class Law>
struct LawHistory {
  typename Law::Number value[history_of<Law> > 0 ? history_of<Law> : 1]{};
};

template <class Law>
concept Damped = requires(const Law& law, const BondPose<typename Law::Number>& b,
                          const BondAxis<typename Law::Number>& axis,
                          const BondRates<typename Law::Number>& rates) {
  bond_damping(law, b, axis, rates);
};
template <class Law>
concept Remembering = history_of<Law> >
0;
template <class Law>
concept Breakable = requires(const Law& law, const BondPose<typename Law::Number>& b,
                             const BondAxis<typename Law::Number>& axis,
                             const BondLoads<typename Law::Number>& loads) {
  utilisation(law, b, axis, loads);
}
|| requires(const Law& law, const BondPose<typename Law::Number>& b,
            const BondAxis<typename Law::Number>& axis, const BondLoads<typename Law::Number>& loads,
            const LawHistory<Law>& history) {
  utilisation(law, b, axis, loads, history);
};
/// Laws whose loads need the rates of their particles.
template <class Law>
concept ReadsRates = Damped<Law> || Remembering<Law>;

/// Energy, tension, elastic loads and utilisation of a bond, whether its law remembers anything or not.
template <class Law, Scalar T>
VBOND_HD BondEnergy<T> energy_with(const Law& law, const BondPose<T>& b, const LawHistory<Law>& history) {
  if constexpr (Remembering<Law>)
    return bond_energy(law, b, history);
  else
    return bond_energy(law, b);
}
template <class Law, Scalar T>
VBOND_HD T tension_with(const Law& law, const T& D, const LawHistory<Law>& history) {
  if constexpr (Remembering<Law>)
    return tension(law, D, history);
  else
    return tension(law, D);
}
template <class Law, Scalar T>
VBOND_HD BondLoads<T> loads_with(const Law& law, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const LawHistory<Law>& history) {
  if constexpr (Remembering<Law>)
    return bond_loads(law, b, axis, history);
  else
    return bond_loads(law, b, axis);
}
template <class Law, Scalar T>
VBOND_HD T utilisation_with(const Law& law, const BondPose<T>& b, const BondAxis<T>& axis,
                            const BondLoads<T>& loads, const LawHistory<Law>& history) {
  if constexpr (Remembering<Law>)
    return utilisation(law, b, axis, loads, history);
  else
    return utilisation(law, b, axis, loads);
}

/// What a bond remembers after a step, and its elastic loads then.
template <class Law>
struct Advanced {
  LawHistory<Law> history;
  BondLoads<typename Law::Number> loads;
};
/// Both at once: laws with a function of this name share what both need.
template <Remembering Law, Scalar T>
VBOND_HD Advanced<Law> advance_with_loads(const Law& law, const BondPose<T>& b, const BondAxis<T>& axis,
                                          const BondRates<T>& rates, const T& dt,
                                          const LawHistory<Law>& before) {
  const LawHistory<Law> now = advance(law, b, axis, rates, dt, before);
  return {now, bond_loads(law, b, axis, now)};
}

/// The pose between the bonded points by which the range of a bond is judged: for R_i = R_j = 0.
template <class Law, Scalar T>
VBOND_HD BondPose<T> elastic_pose_with(const Law& law, const BondPose<T>& b, const LawHistory<Law>& history) {
  if constexpr (requires { elastic_pose(law, b, history); })
    return elastic_pose(law, b, history);
  else
    return {
        bonded_points(b, law.R_i, law.R_j), {b.n_i[0], b.n_i[1], b.n_i[2]}, {b.n_j[0], b.n_j[1], b.n_j[2]}};
}

/// The same law with constants of another scalar type, which carry no derivatives.
template <Scalar To, template <class> class Law, Scalar From>
constexpr Law<To> with_scalar(const Law<From>& m) {
  Law<To> to{};
  to.a = To(m.a), to.R_i = To(m.R_i), to.R_j = To(m.R_j);
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    ((to.*coefficient<Law<To>, k> = To(m.*coefficient<Law<From>, k>)), ...);
  }
  (std::make_index_sequence<coefficients_of<Law<To>>>());
  if constexpr (requires { to.rules; }) to.rules = m.rules;
  return to;
}

/// Laws by their templates. f(LawTag<Law>{}) is called for each, in order.
template <template <class> class L>
struct LawTag {
  template <class T>
  using Law = L<T>;
};
template <template <class> class... Laws>
struct LawList {
  static constexpr std::size_t size = sizeof...(Laws);
  template <class F>
  static constexpr void for_each(F f) {
    (f(LawTag<Laws>{}), ...);
  }
};

}  // namespace vbond
