#include "vbond/model/held_tops.hpp"

#include <algorithm>
#include <array>

#include "vbond/model/holds.hpp"

namespace vbond {

std::optional<PartlyHeldTop> partly_held_top(const Model& model, const std::vector<Support>& supports) {
  if (model.principal.empty()) return std::nullopt;
  struct Turns {
    std::array<bool, 3> held{};
    bool moved = false, slanted = false;
    std::size_t support = 0;
  };
  PerParticle<Turns> turns(model.particles());
  for (std::size_t s = 0; s < supports.size(); ++s)
    for (const ParticleId p : supports[s].particles)
      for (std::size_t k = 0; k < 3 && p.value < turns.size(); ++k) {
        if (!supports[s].held[k + 3]) continue;
        turns[p].held[k] = true;
        turns[p].moved |= component(supports[s].angular_velocity, static_cast<int>(k)) != 0.0;
        turns[p].support = s;
      }
  const ParticleAxes axes(supports);
  for (std::size_t s = 0; s < supports.size(); ++s)
    for (const ParticleId p : supports[s].particles)
      if (const auto of_p = axes.of(p); of_p && of_p->about != world_axes && p.value < turns.size())
        turns[p].slanted = true, turns[p].support = s;
  for (const ParticleId p : turns.ids()) {
    const auto n = std::count(turns[p].held.begin(), turns[p].held.end(), true);
    if (model.is_top(p) && (n == 1 || (n == 2 && turns[p].moved) || (n != 0 && turns[p].slanted)))
      return PartlyHeldTop{p, turns[p].support};
  }
  return std::nullopt;
}

}  // namespace vbond
