#include <fmt/format.h>

#include <cmath>

#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/terms/strain/strain_and_contacts.hpp"

namespace vbond {

void StrainTerm::look_at_motion(const Model& model, const Stage& stage, Mistakes& found) {
  if (!stage.strain) return;
  const StrainProgram& strain = *stage.strain;
  found.require_known(strain.particles, "the imposed strain");
  found.require_finite(strain.centre, "the imposed strain", "the centre");
  found.require(is_unit(strain.direction), "the direction of the imposed strain is " +
                                               text(strain.direction) + ": it must be a unit vector");
  found.require(std::isfinite(strain.increment),
                fmt::format("the increment of the imposed strain is {}", strain.increment));
  found.require(above_zero(strain.every),
                fmt::format("the strain is imposed every {}: it must be > 0", strain.every));
  found.require(!strained_and_gripped(stage),
                "the imposed strain moves particles of a rigid support, which would take them back");
  found.require(!feels_sliding(model.contact),
                "the imposed strain moves particles in jumps, along which contacts do not slide or roll: the "
                "model has friction or rolling");
  found.require(!model.cell.any(), "a periodic body takes no imposed strain: its cell is strained");
}

void StrainTerm::look_at_rest(const Model&, const StaticStage& stage, Mistakes& found) {
  found.require(!stage.strain, "a stage at rest imposes no strain");
}

}  // namespace vbond
