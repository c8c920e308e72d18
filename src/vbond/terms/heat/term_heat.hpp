#pragma once
#include <vector>

#include "vbond/terms/heat/heating.hpp"
#include "vbond/terms/term.hpp"

namespace vbond {

struct HeatTerm;

template <>
struct StagePart<HeatTerm> {
  std::vector<Heating> heating;  ///< in this order, where groups overlap
  bool any() const { return !heating.empty(); }
};

/// Temperatures of particles: bonds that expand grow with them.
struct HeatTerm : Term {
  static constexpr const char* key = "temperatures";
  static void look_at_motion(const Model& model, const Stage& stage, Mistakes& found);
  static void look_at_rest(const Model& model, const StaticStage& stage, Mistakes& found);
  /// With the shortest bonds, and with the longest.
  static void for_extremes(const State& state, const Stage& stage,
                           const std::function<void(const State&)>& visit);
  static void describe(keys::Table& t, SpecPart<HeatTerm>& s, std::optional<StageKind> kind);
  static void resolve(const StageResolver& resolver, StagePart<HeatTerm>& to);
  static std::unique_ptr<MotionTerm> in_motion(const BodyInMotion& on);
  static std::unique_ptr<RestTerm> at_rest(const StaticBody& body, State& state);
};

}  // namespace vbond
