#pragma once
#include <cstddef>
#include <vector>

#include "vbond/core/images.hpp"
#include "vbond/core/segments.hpp"
#include "vbond/setup/fibres/fibre_field.hpp"

namespace vbond {

/// The segments of all fibres. Segment k of a fibre begins at its point k.
struct Segments {
  std::vector<std::size_t> fibre, point;  ///< of each: its fibre, and its first point among all
  std::vector<double> half;               ///< length  [length]

  explicit Segments(const FibreField& field) {
    for (std::size_t f = 0; f < field.size(); ++f)
      for (std::size_t k = field.first[f]; k + 1 < field.first[f + 1]; ++k) {
        fibre.push_back(f);
        point.push_back(k);
        half.push_back(0.5 * norm(field.shape[k + 1] - field.shape[k]));
      }
  }
  std::vector<Vec3d> middles(const std::vector<Vec3d>& r) const {
    std::vector<Vec3d> m;
    m.reserve(point.size());
    for (const std::size_t k : point) m.push_back(0.5 * (r[k] + r[k + 1]));
    return m;
  }
};

struct SegmentPair {
  std::size_t i, j;
  Vec3d shift;  ///< of the image of j  [length]
};

/// visit(pair) for all pairs of segments of different fibres whose axes may be within reach.
template <class Visit>
void for_segments_within(const FibreVessel& vessel, const Segments& segments, const std::vector<Vec3d>& r,
                         double reach, Visit&& visit) {
  const CellEdges cell = vessel.cell();
  for_overlapping_images(cell, vessel.periodic(), segments.middles(r), segments.half, reach,
                         [&](std::size_t i, std::size_t j, const Image& n, double) {
                           if (segments.fibre[i] == segments.fibre[j] && n.is_itself()) return;
                           visit(SegmentPair{i, j, to_image(cell, n)});
                         });
}

/// Of the axes of two segments.
inline double distance2(const Segments& segments, const std::vector<Vec3d>& r, const SegmentPair& pair) {
  const std::size_t p = segments.point[pair.i], q = segments.point[pair.j];
  return nearest_on_segments(r[p], r[p + 1], r[q] + pair.shift, r[q + 1] + pair.shift).distance2;
}

}  // namespace vbond
