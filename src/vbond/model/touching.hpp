#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "vbond/core/sized_points.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Calls visit(i, j, overlap), i < j, once for every pair that repels each other as the particles stand:
/// overlap > 0, what they do not feel of it taken off, and not bonded if only unbonded pairs touch; those of
/// fibres (model/capsules.hpp) and particles that were dropped apart. For looks now and then, not for a time
/// loop.
template <class Visit>
void for_touching_pairs(const Model& model, const State& state, Visit&& visit) {
  if (!particles_touch(model.contact) || model.particles() < 2) return;
  const auto key = [](std::uint64_t i, std::uint64_t j) { return std::min(i, j) << 32 | std::max(i, j); };
  std::unordered_set<std::uint64_t> exempt;
  if (model.contact.pairs == ContactPairs::unbonded)
    for (const Bond& b : state.bonds)
      if (!b.broken) exempt.insert(key(b.i.value, b.j.value));
  const std::vector<char> of_fibre = particles_of_fibres(model.particles(), state.bonds);
  const auto in_fibre = [&of_fibre](std::size_t p) { return !of_fibre.empty() && of_fibre[p] != 0; };
  for_overlapping_pairs(state.r.values(), model.radius.values(),
                        [&](std::size_t i, std::size_t j, double d2) {
                          const ParticleId p{i}, q{j};
                          if (in_fibre(i) || in_fibre(j) || exempt.count(key(i, j)) > 0) return;
                          if (is_dropped(state, p) || is_dropped(state, q)) return;
                          const double overlap = model.radius[p] + model.radius[q] - std::sqrt(d2);
                          const double felt = overlap - kept_overlap(state, p, q);
                          if (felt > 0.0) visit(p, q, felt);
                        });
}

}  // namespace vbond
