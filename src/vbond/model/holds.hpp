#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// Degrees of freedom of a particle that a support holds and that no other is counted for.
struct Hold {
  ParticleId particle;
  std::size_t support;
  HeldDofs held;
};

/// Supports that agree may overlap: each degree of freedom is then that of the first rigid support that holds
/// it, or of the first of the others. Rigid supports come first, then the order is that of the supports.
template <class AnySupport>
std::vector<Hold> holds_of(const std::vector<AnySupport>& supports) {
  std::size_t particles = 0;
  for (const AnySupport& s : supports)
    for (const ParticleId p : s.particles) particles = std::max<std::size_t>(particles, p.value + 1);
  std::vector<HeldDofs> taken(particles);
  std::vector<Hold> holds;
  for (const bool rigid : {true, false})
    for (std::size_t k = 0; k < supports.size(); ++k) {
      if (supports[k].rigid != rigid) continue;
      for (const ParticleId p : supports[k].particles) {
        Hold h{p, k, {}};
        HeldDofs& before = taken[p.value];
        for (std::size_t dof = 0; dof < h.held.size(); ++dof) {
          h.held[dof] = supports[k].held[dof] && !before[dof];
          before[dof] = before[dof] || supports[k].held[dof];
        }
        if (h.held != HeldDofs{}) holds.push_back(h);
      }
    }
  return holds;
}

}  // namespace vbond
