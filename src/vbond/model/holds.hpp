#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/model/held_axes.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// The axes of a particle's degrees of freedom: those in which each direction that some support holds is one
/// axis. Particles that no support holds along or about slanted axes have those of the world.
class ParticleAxes {
 public:
  /// Where axes of two supports of a particle are neither parallel nor perpendicular, and no support holds
  /// all, those of the later support are left out: disagreements() finds them.
  explicit ParticleAxes(const std::vector<Support>& supports);

  /// nullptr: those of the world.
  std::shared_ptr<const HeldAxes> of(ParticleId p) const {
    return p.value < axes_.size() ? axes_[p] : nullptr;
  }
  const HeldAxes* get(ParticleId p) const { return p.value < axes_.size() ? axes_[p].get() : nullptr; }
  /// What a support holds of a particle, in the axes of that particle.
  HeldDofs held(const Support& s, ParticleId p) const {
    const HeldAxes* axes = get(p);
    return axes == nullptr && !s.axes ? s.held : held_in(axes, s.held, s.axes ? &*s.axes : nullptr);
  }
  /// Whether all that it holds of the particle is along these axes.
  bool fits(const Support& s, ParticleId p) const {
    const HeldDofs here = held(s, p);
    return std::count(here.begin(), here.end(), true) == std::count(s.held.begin(), s.held.end(), true);
  }

 private:
  static HeldDofs held_in(const HeldAxes* axes, const HeldDofs& held, const HeldAxes* of_support);

  PerParticle<std::shared_ptr<const HeldAxes>> axes_;  // empty: all have those of the world
};

/// Degrees of freedom of a particle that a support holds and that no other is counted for.
struct Hold {
  ParticleId particle;
  std::size_t support;
  HeldDofs held;
  std::shared_ptr<const HeldAxes> axes = {};  ///< of the particle; nullptr: the world's
};

/// Supports that agree may overlap: each degree of freedom is then that of the first rigid support that holds
/// it, or of the first of the others. Rigid supports come first, then the order is that of the supports.
inline std::vector<Hold> holds_of(const std::vector<Support>& supports) {
  const ParticleAxes axes(supports);
  std::size_t particles = 0;
  for (const Support& s : supports)
    for (const ParticleId p : s.particles) particles = std::max<std::size_t>(particles, p.value + 1);
  std::vector<HeldDofs> taken(particles);
  std::vector<Hold> holds;
  for (const bool rigid : {true, false})
    for (std::size_t k = 0; k < supports.size(); ++k) {
      if (supports[k].rigid != rigid) continue;
      for (const ParticleId p : supports[k].particles) {
        Hold h{p, k, {}, axes.of(p)};
        const HeldDofs held = axes.held(supports[k], p);
        HeldDofs& before = taken[p.value];
        for (std::size_t dof = 0; dof < h.held.size(); ++dof) {
          h.held[dof] = held[dof] && !before[dof];
          before[dof] = before[dof] || held[dof] || supports[k].rigid;
        }
        if (h.held != HeldDofs{}) holds.push_back(std::move(h));
      }
    }
  return holds;
}

}  // namespace vbond
