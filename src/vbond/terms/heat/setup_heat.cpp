#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vbond/setup/stage_resolver.hpp"

namespace vbond {
namespace {

/// Reports temperatures at which a bond set would have no length left, or that nothing feels.
void check_temperatures(const StageResolver& resolver) {
  for (const TemperatureSpec& t : resolver.spec.temperatures) {
    if (std::none_of(resolver.c.bonds.begin(), resolver.c.bonds.end(),
                     [](const BondSpec& b) { return b.recipe.expansion != 0.0; })) {
      resolver.problems.add(
          t.place, "no bonds feel a temperature: none has an expansion",
          "temperature makes bonds grow by expansion times temperature",
          "give a set of bonds an expansion, as expansion = 1.2e-5, or leave temperatures out");
      return;
    }
    double largest = std::abs(t.change);
    if (t.factor.points.empty()) largest = std::max(largest, std::abs(t.temperature));
    for (const auto& [time, factor] : t.factor.points)
      largest = std::max(largest, std::abs(t.temperature * factor));
    for (const BondSpec& b : resolver.c.bonds)
      if (!(std::abs(b.recipe.expansion) * largest < 1.0))
        resolver.problems.add(t.place,
                              fmt::format("bonds \"{}\" would grow by {:.3g} of their lengths", b.name,
                                          std::abs(b.recipe.expansion) * largest),
                              "a bond may grow or shrink by less than its length",
                              "look for a missing power of ten in expansion or temperature");
  }
}

}  // namespace

void HeatTerm::resolve(const StageResolver& resolver, StagePart<HeatTerm>& to) {
  check_temperatures(resolver);
  const bool at_rest = is_static(resolver.spec.kind);
  for (const TemperatureSpec& t : resolver.spec.temperatures)
    to.heating.push_back({resolver.particles(t.group), at_rest ? t.change : t.temperature,
                          resolver.function(t.factor, t.place)});
}

}  // namespace vbond
