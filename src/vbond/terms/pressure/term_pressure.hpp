#pragma once
#include <tuple>
#include <vector>

#include "vbond/model/field_table.hpp"
#include "vbond/terms/pressure/pressure.hpp"
#include "vbond/terms/term.hpp"

namespace vbond {

struct PressureTerm;

template <>
struct StagePart<PressureTerm> {
  std::vector<Pressure> pressures;  ///< all add up
  bool any() const { return !pressures.empty(); }
};

template <>
struct StatePart<PressureTerm> {
  std::vector<PressedFacet> pressed;  ///< of the stage under way, pressure by pressure
  friend bool operator==(const StatePart&, const StatePart&) = default;
};

/// Pressures on chains, sheets and the skin of solids.
struct PressureTerm : Term {
  static constexpr const char* key = "pressures";
  static constexpr auto state_tables = std::tuple{rows_of(
      "/pressed/", &StatePart<PressureTerm>::pressed, {.anew = Anew::any_stage, .filed = Filed::where_any},
      field("pressure", &PressedFacet::pressure, unit::none,
            "of facets that are pressed on the number of their pressure in the stage, from 0; only in a "
            "stage that has some"),
      field("i", &PressedFacet::i, unit::none, "their first particles"),
      field("j", &PressedFacet::j, unit::none, "their second particles"),
      field("k", &PressedFacet::k, unit::none, "their third particles; of strips the first again"),
      field("area", &PressedFacet::area, unit::area, "vectors of their areas as the stage began"),
      field("towards", &PressedFacet::towards, unit::area,
            "the parts of the areas of their particles that faced the centre as the stage began; only of "
            "central pressures",
            {.filed = Filed::where_any}))};
  static void look_at_motion(const Model& model, const Stage& stage, Mistakes& found);
  static void look_at_rest(const Model& model, const StaticStage& stage, Mistakes& found);
  /// Where nothing is elastic nothing feels it.
  static AddedFrequency added_frequency(const Model& model, const State& state, const Stage& stage,
                                        double dt_without);
  static void describe(keys::Table& t, SpecPart<PressureTerm>& s, std::optional<StageKind> kind);
  static void resolve(const StageResolver& resolver, StagePart<PressureTerm>& to);
  /// The facets.
  static void complete(const StageResolver& resolver, const State& state, StagePart<PressureTerm>& to);
  static std::unique_ptr<MotionTerm> in_motion(const BodyInMotion& on);
  /// All bodies of the stage press on the facets that it begins with.
  static void begin_at_rest(const StaticStage& stage, State& state);
  static std::unique_ptr<RestTerm> at_rest(const StaticBody& body, State& state);
};

}  // namespace vbond
