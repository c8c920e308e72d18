#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "vbond/terms/heat/term_heat.hpp"
#include "vbond/terms/pressure/term_pressure.hpp"
#include "vbond/terms/strain/term_strain.hpp"
#include "vbond/terms/walls/term_walls.hpp"

namespace vbond {

template <class... T>
struct TermList {
  static constexpr std::size_t size = sizeof...(T);
  template <class Visit>
  static constexpr void for_each(Visit&& visit) {
    (visit(T{}), ...);
  }
  template <class One>
  static constexpr std::size_t place_of() {
    constexpr std::array<bool, size> is{std::is_same_v<T, One>...};
    return static_cast<std::size_t>(std::find(is.begin(), is.end(), true) - is.begin());
  }
  /// What all of them add to a stage, to one of a case file, and to State.
  struct OfStage : StagePart<T>... {};
  struct OfSpec : SpecPart<T>... {};
  struct OfState : StatePart<T>... {
    friend bool operator==(const OfState&, const OfState&) = default;
  };
};

/// The one list of the terms, in the order in which a step and a body at rest go over them. A strain that is
/// imposed has all loads worked out anew, with lengths of before the step and books of its own: heat, which
/// gives bonds those of the step's end, what acts on places, and what moves by itself, come after it.
using Terms = TermList<StrainTerm, HeatTerm, PressureTerm, WallsTerm>;

/// What the terms do in a stage, of motion or at rest.
struct StageTerms : Terms::OfStage {};

}  // namespace vbond
