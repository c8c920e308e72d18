#include "vbond/terms/setup_terms.hpp"

#include "vbond/terms/heat/setup_heat.hpp"
#include "vbond/terms/pressure/setup_pressure.hpp"
#include "vbond/terms/strain/setup_strain.hpp"
#include "vbond/terms/walls/setup_walls.hpp"

namespace vbond {

void resolve_terms(const StageResolver& resolver, StageTerms& stage) {
  stage.heating = resolve_heating(resolver);
  if (resolver.spec.strain) stage.strain = resolve_strain(resolver, *resolver.spec.strain);
  stage.pressures = resolve_pressures(resolver);
  stage.walls = resolve_wall_drives(resolver);
}

void complete_terms(const StageResolver& resolver, const State& state, StageTerms& stage) {
  find_facets(resolver, state, stage.pressures);
}

}  // namespace vbond
