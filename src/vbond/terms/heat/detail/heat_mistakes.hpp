#pragma once
#include <cmath>
#include <vector>

#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/terms/heat/heating.hpp"

namespace vbond {

/// What a program may do wrong with temperatures of a stage.
inline void look_at_heating(const std::vector<Heating>& heating, bool at_rest, Mistakes& found) {
  for (const Heating& h : heating) {
    found.require_known(h.particles, "a temperature", "");
    found.require(std::isfinite(h.temperature), "a temperature is not finite");
  }
  for (const Heating& h : heating)
    at_rest ? found.refuse_factor(h.factor, "a temperature")
            : found.require_factor(h.factor, "a temperature");
}

}  // namespace vbond
