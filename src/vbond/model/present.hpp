#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

/// A body cut across its longest direction, so that what pairs are found by need not be there of all
/// particles at once. Few layers are as good as one.
class PairLayers {
 public:
  /// Of these particles. within: how far the second particle of a pair may be.  [length]
  PairLayers(const std::vector<ParticleId>& particles, const PerParticle<Vec3d>& r, double within)
      : within_(within) {
    BoundingBox box;
    for (const ParticleId p : particles) box.add(r[p]);
    axis_ = box.axes_by_length()[0];
    const double low = component(box.low, axis_), size = component(box.high, axis_) - low;
    const std::size_t wanted = std::min(1 + particles.size() / particles_each, most);
    const double thickness = size / static_cast<double>(wanted);
    if (!(thickness > within) || !std::isfinite(thickness)) return;  // one
    for (std::size_t k = 1; k < wanted; ++k) borders_.push_back(low + thickness * static_cast<double>(k));
  }
  std::size_t count() const { return borders_.size() + 1; }
  /// About how many particles one of the layers of so many has.
  static double particles_of_one(double particles) {
    return std::min(particles, std::max(static_cast<double>(particles_each), particles / most));
  }
  std::size_t of(const Vec3d& r) const {
    const auto above = std::upper_bound(borders_.begin(), borders_.end(), component(r, axis_));
    return static_cast<std::size_t>(above - borders_.begin());
  }
  /// Whether a particle may be the second one of a pair whose first one is in this layer. Differences are
  /// compared as those of the pair are, so that rounding leaves out no pair.
  bool is_near(const Vec3d& r, std::size_t layer) const {
    const double x = component(r, axis_);
    return (layer == 0 || borders_[layer - 1] - x <= within_) &&
           (layer == borders_.size() || x - borders_[layer] <= within_);
  }

 private:
  static constexpr std::size_t particles_each = 1 << 16, most = 16;

  double within_;
  int axis_ = 0;
  std::vector<double> borders_;  // between layers
};

/// As for_overlapping_images() of the particles of a body, those that are absent apart: many may wait in one
/// place, and are not looked at. Of a part of a body, pairs that are its own, of one layer after the other.
template <class Visit>
void for_overlapping_present(const Model& model, const BodyPart& body, double margin, Visit&& visit) {
  const State& state = body.state;
  if (body.is_whole() && !body.shares_pairs() && !any_absent(state))
    return for_overlapping_images(state.cell, model.cell.periodic, state.r.values(), model.radius.values(),
                                  margin, visit);
  const double reach = (reach_of_overlaps(model) + margin) * (1.0 + 1e-9);
  std::vector<ParticleId> near;
  if (body.is_whole()) {
    const bool some = body.shares_pairs() && state.cell.empty();
    BoundingBox own;
    for (const ParticleId p : state.r.ids())
      if (some && body.has_pair_of(p)) own.add(state.r[p]);
    for (const ParticleId p : state.r.ids())
      if (!is_absent(state, p) && (!some || own.is_near(state.r[p], reach))) near.push_back(p);
  }
  const std::vector<ParticleId>& all = body.is_whole() ? near : body.near;
  const bool in_layers = body.shares_pairs() && state.cell.empty();
  const PairLayers layers(all, state.r, in_layers ? reach : BoundingBox::inf);
  for (std::size_t layer = 0; layer < layers.count(); ++layer) {
    std::vector<std::uint32_t> of;
    std::vector<Vec3d> r;
    std::vector<double> radius;
    for (const ParticleId p : all)
      if (layers.is_near(state.r[p], layer))
        of.push_back(p.value), r.push_back(state.r[p]), radius.push_back(model.radius[p]);
    for_overlapping_images(state.cell, model.cell.periodic, r, radius, margin,
                           [&](std::size_t i, std::size_t j, const Image& n, double d2) {
                             if (!body.has_pair_of(ParticleId{of[i]})) return;
                             if (layers.count() == 1 || layers.of(r[i]) == layer) visit(of[i], of[j], n, d2);
                           });
  }
}

}  // namespace vbond
