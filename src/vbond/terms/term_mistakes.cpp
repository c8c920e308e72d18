#include "vbond/terms/detail/term_mistakes.hpp"
#include "vbond/terms/heat/detail/heat_mistakes.hpp"
#include "vbond/terms/pressure/detail/pressure_mistakes.hpp"
#include "vbond/terms/strain/detail/strain_mistakes.hpp"
#include "vbond/terms/walls/wall_mistakes.hpp"

namespace vbond {

void look_at_terms(const Model& model, const Stage& stage, Mistakes& found) {
  look_at_heating(stage.heating, false, found);
  look_at_pressures(model, stage.pressures, false, found);
  found.require(
      stage.pressures.empty() || (stage.inflows.empty() && stage.sinks.empty()),
      "pressure acts on the same particles throughout a stage: no bodies come in, none are taken out");
  found.require(stage.pressures.empty() || stage.on_unphysical == OnUnphysical::stop,
                "pressure acts on the same particles throughout a stage: none may be dropped");
  look_at_strain(model, stage, found);
  found.add(mistakes_in_drives(model, stage));
}

void look_at_terms(const Model& model, const StaticStage& stage, Mistakes& found) {
  look_at_heating(stage.heating, true, found);
  look_at_pressures(model, stage.pressures, true, found);
  found.require(!stage.strain, "a stage at rest imposes no strain");
  found.add(mistakes_in_drives(model, stage));
}

}  // namespace vbond
