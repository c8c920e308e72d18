#pragma once
#include <optional>

#include "vbond/terms/strain/strain.hpp"
#include "vbond/terms/term.hpp"

namespace vbond {

struct StrainTerm;

template <>
struct StagePart<StrainTerm> {
  std::optional<StrainProgram> strain;  ///< of motion
  bool any() const { return strain.has_value(); }
};

/// A strain that is imposed on a group now and then.
struct StrainTerm : Term {
  static constexpr const char* key = "strain";
  static void look_at_motion(const Model& model, const Stage& stage, Mistakes& found);
  static void look_at_rest(const Model& model, const StaticStage& stage, Mistakes& found);
  static void describe(keys::Table& t, SpecPart<StrainTerm>& s, std::optional<StageKind> kind);
  static void resolve(const StageResolver& resolver, StagePart<StrainTerm>& to);
  static std::unique_ptr<MotionTerm> in_motion(const BodyInMotion& on);
};

}  // namespace vbond
