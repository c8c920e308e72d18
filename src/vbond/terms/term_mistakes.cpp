#include "vbond/terms/detail/term_mistakes.hpp"
#include "vbond/terms/heat/detail/heat_mistakes.hpp"
#include "vbond/terms/strain/detail/strain_mistakes.hpp"
#include "vbond/terms/walls/wall_mistakes.hpp"

namespace vbond {

void look_at_terms(const Model& model, const Stage& stage, Mistakes& found) {
  look_at_heating(stage.heating, false, found);
  look_at_strain(model, stage, found);
  found.add(mistakes_in_drives(model, stage));
}

void look_at_terms(const Model& model, const StaticStage& stage, Mistakes& found) {
  look_at_heating(stage.heating, true, found);
  found.require(!stage.strain, "a stage at rest imposes no strain");
  found.add(mistakes_in_drives(model, stage));
}

}  // namespace vbond
