#pragma once
#include <optional>
#include <string>

#include "vbond/case/placed.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/terms/strain/term_strain.hpp"

namespace vbond {

/// The strain that a stage of dynamics imposes, as the user wrote it; see case.hpp.
struct StrainSpec {
  SourcePlace place;
  Placed<std::string> group;
  Vec3d direction{1, 0, 0};
  double increment = 0;
  CaseTime every;
};

template <>
struct SpecPart<StrainTerm> {
  std::optional<StrainSpec> strain;  ///< dynamics
  bool any() const { return strain.has_value(); }
  bool grows() const { return false; }
};

namespace keys {
class Table;
void describe(Table& t, StrainSpec& s);
}  // namespace keys

}  // namespace vbond
