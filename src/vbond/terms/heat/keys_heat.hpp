#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "vbond/case/placed.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/terms/heat/term_heat.hpp"

namespace vbond {

/// What heats the particles of a group in a stage, as the user wrote it; see case.hpp.
struct TemperatureSpec {
  SourcePlace place;
  Placed<std::string> group;
  double temperature = 0;   ///< dynamics, times the factor
  TimeFunctionSpec factor;  ///< dynamics
  double change = 0;        ///< static stages: at load factor 1
};

template <>
struct SpecPart<HeatTerm> {
  std::vector<TemperatureSpec> temperatures;  ///< all kinds but modes
  bool any() const { return !temperatures.empty(); }
  bool grows() const {
    return std::any_of(temperatures.begin(), temperatures.end(),
                       [](const TemperatureSpec& t) { return t.change != 0.0; });
  }
};

namespace keys {
class Table;
/// Keys of a stage of this kind; those of every kind if it is not known.
void describe(Table& t, TemperatureSpec& s, std::optional<StageKind> kind);
}  // namespace keys

}  // namespace vbond
