#include "vbond/model/holds.hpp"

#include <utility>

namespace vbond {
namespace {

/// Held axes of translations (first = 0) or rotations (first = 3) of a particle, as its supports come. Where
/// a support holds all three it does not matter along which.
struct Kept {
  std::vector<Vec3d> along, about;
};

void keep(const Support& s, std::size_t first, std::vector<Vec3d>& kept) {
  if (s.held[first] && s.held[first + 1] && s.held[first + 2]) return;
  std::vector<Vec3d> with = kept;
  for (std::size_t dof = first; dof < first + 3; ++dof)
    if (s.held[dof]) with.push_back(axis_of(s.axes ? &*s.axes : nullptr, dof));
  if (common_axes(with)) kept = std::move(with);
}

}  // namespace

ParticleAxes::ParticleAxes(const std::vector<Support>& supports) {
  std::size_t particles = 0;
  for (const Support& s : supports)
    if (s.axes)
      for (const ParticleId p : s.particles) particles = std::max<std::size_t>(particles, p.value + 1);
  if (particles == 0) return;
  axes_.resize(particles);
  PerParticle<char> slanted(particles, 0);
  for (const Support& s : supports)
    if (s.axes)
      for (const ParticleId p : s.particles) slanted[p] = 1;
  PerParticle<Kept> kept(particles);
  for (const Support& s : supports)
    for (const ParticleId p : s.particles)
      if (p.value < particles && slanted[p]) keep(s, 0, kept[p].along), keep(s, 3, kept[p].about);
  for (const ParticleId p : axes_.ids()) {
    if (!slanted[p]) continue;
    const HeldAxes axes{*common_axes(kept[p].along), *common_axes(kept[p].about)};
    if (axes != HeldAxes{}) axes_[p] = std::make_shared<const HeldAxes>(axes);
  }
}

HeldDofs ParticleAxes::held_in(const HeldAxes* axes, const HeldDofs& held, const HeldAxes* of_support) {
  HeldDofs here{};
  for (const std::size_t first : {0u, 3u}) {
    const bool all = held[first] && held[first + 1] && held[first + 2];
    for (std::size_t dof = first; dof < first + 3; ++dof) {
      here[dof] = all;
      for (std::size_t own = first; own < first + 3; ++own)
        here[dof] = here[dof] || (held[own] && are_parallel(axis_of(axes, dof), axis_of(of_support, own)));
    }
  }
  return here;
}

}  // namespace vbond
