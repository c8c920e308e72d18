#pragma once
#include <algorithm>
#include <tuple>
#include <vector>

#include "vbond/model/state.hpp"
#include "vbond/model/touching.hpp"

namespace vbond {

/// The pairs of a body that touch, for one placement after the other: those that may touch are looked for
/// only where a particle has moved so far that others could, or the cell has changed. Their order is that of
/// the particles' numbers, whenever they were looked for.
class TouchingList {
 public:
  /// As for_touching_pairs().
  template <class Visit>
  void for_each(const Model& model, const State& state, Visit&& visit) {
    for_each_within(0.0, model, state, visit);
  }
  /// Those as well that are about to touch: no more than this part of the least radius is between them.
  static constexpr double about_to = 0.05;
  template <class Visit>
  void for_each_or_about_to(const Model& model, const State& state, Visit&& visit) {
    for_each_within(about_to, model, state, visit);
  }
  /// Bonds have gone, and with them what kept pairs from touching.
  void forget() { found_ = false; }

 private:
  template <class Visit>
  void for_each_within(double part, const Model& model, const State& state, Visit&& visit) {
    if (!particles_touch(model.contact)) return;
    if (!holds(state)) find(model, state);
    const double reach = part * least_radius_;
    for (const Near& near : near_) {
      const double distance = norm(between(state, near.i, near.j, near.n));
      const double felt = felt_overlap(model, state, near.i, near.j, near.n, distance);
      if (felt > -reach) visit(near.i, near.j, near.n, felt);
    }
  }

  static constexpr double margin = 0.2;  // of the least radius
  struct Near {
    ParticleId i, j;
    Image n;
  };

  bool holds(const State& state) const {
    if (!found_ || state.cell != cell_ || state.r.size() != r_.size()) return false;
    const double farthest = 0.5 * margin * least_radius_;
    for (const ParticleId p : r_.ids())
      if (!(norm2(state.r[p] - r_[p]) <= farthest * farthest)) return false;
    return true;
  }

  void find(const Model& model, const State& state) {
    const auto& radii = model.radius.values();
    least_radius_ = radii.empty() ? 0.0 : *std::min_element(radii.begin(), radii.end());
    near_.clear();
    for_pairs_that_may_touch(model, state, (margin + about_to) * least_radius_,
                             [&](ParticleId i, ParticleId j, const Image& n, double) {
                               near_.push_back({i, j, n});
                             });
    std::sort(near_.begin(), near_.end(),
              [](const Near& a, const Near& b) { return std::tie(a.i, a.j, a.n) < std::tie(b.i, b.j, b.n); });
    r_ = state.r, cell_ = state.cell;
    found_ = true;
  }

  std::vector<Near> near_;
  PerParticle<Vec3d> r_;  // where they were looked for
  CellEdges cell_;
  double least_radius_ = 0;
  bool found_ = false;
};

}  // namespace vbond
