#pragma once
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/terms/pressure/pressure.hpp"

namespace vbond {

/// What a program may do wrong with the pressures of a stage.
inline void look_at_pressures(const Model& model, const std::vector<Pressure>& pressures, bool at_rest,
                              Mistakes& found) {
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

}  // namespace vbond
