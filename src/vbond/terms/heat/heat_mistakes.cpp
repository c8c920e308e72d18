#include <cmath>

#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {
namespace {

void look_at(const Heating& h, Mistakes& found) {
  found.require_known(h.particles, "a temperature", "");
  found.require(std::isfinite(h.temperature), "a temperature is not finite");
}

}  // namespace

void HeatTerm::look_at_motion(const Model&, const Stage& stage, Mistakes& found) {
  for (const Heating& h : stage.heating) {
    look_at(h, found);
    found.require_factor(h.factor, "a temperature");
  }
}

void HeatTerm::look_at_rest(const Model&, const StaticStage& stage, Mistakes& found) {
  for (const Heating& h : stage.heating) {
    look_at(h, found);
    found.refuse_factor(h.factor, "a temperature");
  }
}

}  // namespace vbond
