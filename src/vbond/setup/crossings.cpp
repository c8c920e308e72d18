#include "vbond/setup/crossings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "vbond/core/images.hpp"
#include "vbond/core/segments.hpp"
#include "vbond/model/capsules.hpp"

namespace vbond {
namespace {

/// Two capsules near each other, or next to each other.
struct Near {
  std::array<FibrePart, 2> part;
  std::array<double, 2> s{};  // of the nearest points, from i to j
  double gap = 0;
  bool may_touch = false;
};

bool share_an_end(const FibrePart& x, const FibrePart& y) {
  return x.i == y.i || x.i == y.j || x.j == y.i || x.j == y.j;
}

/// All pairs of capsules whose surfaces are at most `gap` apart, in order of bonds and images; also those
/// that are of one place in a fibre or bonded there, which may not touch.
std::vector<Near> near_capsules(const FibreParts& fibres, const Model& model, const State& state,
                                double gap) {
  constexpr double rounding = 1e-9;  // of the radii, as for gaps of spheres
  std::vector<FibrePart> capsules;
  std::vector<Vec3d> middle;
  std::vector<double> reach;
  double thickest = 0.0;
  const auto at = [&](const ImageOf& p) { return place_of(state.r, state.cell, p); };
  for (const FibrePart& p : fibres.parts()) {
    if (!p.is_capsule()) continue;
    const Vec3d r_i = at(p.i), r_j = at(p.j);
    capsules.push_back(p);
    middle.push_back(0.5 * (r_i + r_j));
    reach.push_back(0.5 * norm(between(r_i, r_j)) + p.R);
    thickest = std::max(thickest, p.R);
  }
  const double within = gap + 2.0 * rounding * thickest;
  constexpr double far = 20.0;  // halves of the longest capsule: others are in between
  if (!capsules.empty() && within > far * *std::max_element(reach.begin(), reach.end()))
    throw std::length_error("too large a gap");
  std::vector<Near> near;
  for_overlapping_images(state.cell, model.cell.periodic, middle, reach, within,
                         [&](std::size_t k, std::size_t l, const Image& n, double) {
                           const FibrePart &x = capsules[k], y = carried(capsules[l], n);
                           const NearestOnSegments nearest =
                               nearest_on_segments(at(x.i), at(x.j), at(y.i), at(y.j));
                           const double here = std::sqrt(nearest.distance2) - x.R - y.R;
                           if (near.size() > 200 * capsules.size()) throw std::length_error("too many pairs");
                           if (here <= within)
                             near.push_back({{x, y}, {nearest.s, nearest.t}, here, fibres.may_touch(x, y)});
                         });
  const auto order = [](const Near& p) {
    return std::tuple(p.part[0].bond, p.part[1].bond, p.part[1].i.image);
  };
  std::sort(near.begin(), near.end(), [&](const Near& a, const Near& b) { return order(a) < order(b); });
  return near;
}

/// Pairs of capsules, found by the particles at their ends.
class Neighbourhood {
 public:
  /// Keeps the pairs.
  Neighbourhood(const Model& model, std::span<const Near> near)
      : near_(near), at_(model.particles(), std::vector<End>{}) {
    for (std::uint32_t k = 0; k < near_.size(); ++k)
      for (const std::uint8_t side : {std::uint8_t{0}, std::uint8_t{1}})
        for (const ImageOf& end : {near_[k].part[side].i, near_[k].part[side].j})
          at_[end.particle].push_back({k, side});
  }

  /// Whether no pair of which both capsules are the same or next to these is nearer, or as near and comes
  /// first.
  bool is_least(std::uint32_t k) const {
    const Near& here = near_[k];
    for (const ImageOf& end : {here.part[0].i, here.part[0].j})
      for (const auto& [other, side] : at_[end.particle]) {
        const Near& there = near_[other];
        if (other == k || std::pair(here.gap, k) < std::pair(there.gap, other)) continue;
        const FibrePart& same_fibre = there.part[side];
        for (const ImageOf& its_end : {same_fibre.i, same_fibre.j}) {
          if (its_end.particle != end.particle) continue;
          const Image n = end.image - its_end.image;  // where both ends are one
          if (share_an_end(carried(there.part[1 - side], n), here.part[1])) return false;
        }
      }
    return true;
  }

 private:
  struct End {
    std::uint32_t pair;
    std::uint8_t side;  // which of its capsules ends there
  };
  std::span<const Near> near_;
  PerParticle<std::vector<End>> at_;
};

/// Fastened to the ends that are nearer.
Crossing crossing_of(const Near& near, const State& state) {
  std::array<ImageOf, 2> end;
  std::array<Vec3d, 2> offset;
  for (std::size_t k = 0; k < 2; ++k) {
    const FibrePart& part = near.part[k];
    const Vec3d r_i = place_of(state.r, state.cell, part.i), r_j = place_of(state.r, state.cell, part.j);
    end[k] = near.s[k] <= 0.5 ? part.i : part.j;
    offset[k] = between(near.s[k] <= 0.5 ? r_i : r_j, on_segment(r_i, r_j, near.s[k]));
  }
  const Pair as_found{end[0].particle, end[1].particle, end[1].image - end[0].image};
  Crossing c{in_order(as_found), {offset[0], offset[1], near.part[0].R, near.part[1].R}, near.gap};
  if (c.pair != as_found) c.points = {offset[1], offset[0], near.part[1].R, near.part[0].R};
  return c;
}

}  // namespace

std::vector<Crossing> crossings_within(const Model& model, const State& state, const PerBond<Bond>& bonds,
                                       double gap) {
  const FibreParts fibres(model, bonds);
  const std::vector<Near> near = near_capsules(fibres, model, state, gap);
  const Neighbourhood neighbourhood(model, near);
  std::vector<Crossing> crossings;
  for (std::uint32_t k = 0; k < near.size(); ++k)
    if (near[k].may_touch && neighbourhood.is_least(k)) crossings.push_back(crossing_of(near[k], state));
  std::stable_sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return a.pair < b.pair || (a.pair == b.pair && a.gap < b.gap);
  });
  const auto same = [](const Crossing& a, const Crossing& b) { return a.pair == b.pair; };
  crossings.erase(std::unique(crossings.begin(), crossings.end(), same), crossings.end());
  return crossings;
}

}  // namespace vbond
