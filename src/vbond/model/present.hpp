#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// How near the centres of particles may be that overlap: two of the largest radii.  [length]
inline double reach_of_overlaps(const Model& model) {
  return model.particles() == 0 ? 0.0 : 2.0 * *std::max_element(model.radius.begin(), model.radius.end());
}

/// As for_overlapping_images() of the particles of a body, those that are absent apart: many may wait in one
/// place, and are not looked at. Of a part of a body, pairs that are its own.
template <class Visit>
void for_overlapping_present(const Model& model, const BodyPart& body, double margin, Visit&& visit) {
  const State& state = body.state;
  if (body.is_whole() && !body.shares_pairs() && !any_absent(state))
    return for_overlapping_images(state.cell, model.cell.periodic, state.r.values(), model.radius.values(),
                                  margin, visit);
  std::vector<std::size_t> of;
  std::vector<Vec3d> r;
  std::vector<double> radius;
  const auto add = [&](ParticleId p) {
    of.push_back(p.value), r.push_back(state.r[p]), radius.push_back(model.radius[p]);
  };
  if (body.is_whole()) {
    const bool some = body.shares_pairs() && state.cell.empty();
    BoundingBox own;
    for (const ParticleId p : state.r.ids())
      if (some && body.has_pair_of(p)) own.add(state.r[p]);
    const double reach = (reach_of_overlaps(model) + margin) * (1.0 + 1e-9);
    for (const ParticleId p : state.r.ids())
      if (!is_absent(state, p) && (!some || own.is_near(state.r[p], reach))) add(p);
  } else {
    for (const ParticleId p : body.near) add(p);
  }
  for_overlapping_images(state.cell, model.cell.periodic, r, radius, margin,
                         [&](std::size_t i, std::size_t j, const Image& n, double d2) {
                           if (body.has_pair_of(ParticleId{of[i]})) visit(of[i], of[j], n, d2);
                         });
}

}  // namespace vbond
