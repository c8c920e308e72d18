#pragma once
#include <cstddef>
#include <vector>

#include "vbond/core/images.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// As for_overlapping_images() of the particles of a state, those that are absent apart: many may wait in one
/// place, and are not looked at.
template <class Visit>
void for_overlapping_present(const Model& model, const State& state, double margin, Visit&& visit) {
  if (!any_absent(state))
    return for_overlapping_images(state.cell, model.cell.periodic, state.r.values(), model.radius.values(),
                                  margin, visit);
  std::vector<std::size_t> of;
  std::vector<Vec3d> r;
  std::vector<double> radius;
  for (const ParticleId p : state.r.ids())
    if (!is_absent(state, p))
      of.push_back(p.value), r.push_back(state.r[p]), radius.push_back(model.radius[p]);
  for_overlapping_images(
      state.cell, model.cell.periodic, r, radius, margin,
      [&](std::size_t i, std::size_t j, const Image& n, double d2) { visit(of[i], of[j], n, d2); });
}

}  // namespace vbond
