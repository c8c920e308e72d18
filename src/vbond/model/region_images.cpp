#include "vbond/model/region_images.hpp"

#include <cmath>

#include "vbond/core/images.hpp"

namespace vbond {
namespace {

/// A box around the part of a region that images of a cell's particles need: of infinite sides some edges.
BoundingBox limited(BoundingBox box, const CellEdges& cell) {
  double far = 0.0;
  for (const CellEdge& edge : cell) far += norm(edge.along);
  for (int k = 0; k < 3; ++k) {
    double &low = component(box.low, k), &high = component(box.high, k);
    if (std::isinf(low) && std::isinf(high)) low = -far, high = far;
    if (std::isinf(low)) low = high - far;
    if (std::isinf(high)) high = low + far;
  }
  return box;
}

}  // namespace

bool holds_image(const Space& region, const Model& model, const State& s, ParticleId p) {
  if (s.cell.empty()) return region.holds(s.r[p], 0.0);
  const Vec3d r =
      s.r[p] + to_image(s.cell, image_in_cell(s.cell, model.cell.periodic, model.cell.corner, s.r[p]));
  bool holds = region.holds(r, 0.0);
  for_images_in(limited(region.box, s.cell), s.cell, model.cell.periodic, r,
                [&](const Image& n) { holds = holds || region.holds(r + to_image(s.cell, n), 0.0); });
  return holds;
}

}  // namespace vbond
