#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {
namespace {

void look_at(const Model& model, const std::vector<Pressure>& pressures, bool at_rest, Mistakes& found) {
  for (const Pressure& p : pressures) {
    const std::string who = "a pressure on group \"" + p.group + "\"";
    found.require(std::isfinite(p.pressure), fmt::format("{} is {}", who, p.pressure));
    found.require_finite(p.centre, who, "the centre");
    found.require_finite(p.across, who, "the width of its strips");
    for (const Facet& f : p.facets) {
      found.require_known({f.i, f.j, f.k}, who);
      found.require(f.i != f.j && (f.is_strip() || f.j != f.k),
                    fmt::format("{} has a facet with particle {} twice", who, f.j.value));
      found.require(!f.is_strip() || p.across != Vec3d{}, who + " has strips without a width");
    }
    at_rest ? found.refuse_factor(p.factor, who) : found.require_factor(p.factor, who);
    found.require(at_rest || !p.constant, who + " is constant: in motion a pressure has a factor over time");
  }
  found.require(pressures.empty() || !model.cell.any(),
                "pressure acts on bodies without a cell: the cell of a periodic one gives way to a stress");
}

}  // namespace

void PressureTerm::look_at_motion(const Model& model, const Stage& stage, Mistakes& found) {
  look_at(model, stage.pressures, false, found);
  found.require(
      stage.pressures.empty() || (stage.inflows.empty() && stage.sinks.empty()),
      "pressure acts on the same particles throughout a stage: no bodies come in, none are taken out");
  found.require(stage.pressures.empty() || stage.on_unphysical == OnUnphysical::stop,
                "pressure acts on the same particles throughout a stage: none may be dropped");
}

void PressureTerm::look_at_rest(const Model& model, const StaticStage& stage, Mistakes& found) {
  look_at(model, stage.pressures, true, found);
}

}  // namespace vbond
