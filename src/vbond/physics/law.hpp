#pragma once
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "vbond/physics/pose.hpp"
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
///     static constexpr auto fields();    std::array of LawField: the one list of its coefficients
///     static constexpr Law from(stiffness, a, R_i, R_j);     coefficients that give these stiffnesses
/// and the functions bond_energy, tension, bond_loads, stiffness and bond_range. Everything else follows from
/// these: packs of the step loop, checkpoint, keys of case files and their reference, tangents by dual
/// numbers, and the tests that every law must pass. docs/theory.md says what the functions must fulfil.
inline constexpr std::size_t most_coefficients = 8;

template <class Law>
inline constexpr std::size_t coefficients_of = Law::fields().size();

/// Coefficient number k of a law, as a pointer to its member.
template <class Law, std::size_t k>
inline constexpr auto coefficient = Law::fields()[k].at;

/// The same law with constants of another scalar type, which carry no derivatives.
template <Scalar To, template <class> class Law, Scalar From>
constexpr Law<To> with_scalar(const Law<From>& m) {
  Law<To> to{};
  to.a = To(m.a), to.R_i = To(m.R_i), to.R_j = To(m.R_j);
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    ((to.*coefficient<Law<To>, k> = To(m.*coefficient<Law<From>, k>)), ...);
  }
  (std::make_index_sequence<coefficients_of<Law<To>>>());
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
