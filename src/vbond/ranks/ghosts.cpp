#include "vbond/ranks/ghosts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/images.hpp"

namespace vbond {
namespace {

/// All places that may be near a particle of the body, with whose image each is.
NearImages places_of(const Model& model, const State& state, double reach) {
  if (model.cell.any()) return near_images(state.cell, model.cell.periodic, state.r.values(), reach);
  NearImages places;
  places.r.assign(state.r.begin(), state.r.end());
  places.points = places.r.size();
  places.image.resize(places.points);
  for (std::size_t k = 0; k < places.points; ++k) places.of.push_back(k);
  return places;
}

/// Those of the places that are in the box of a rank's particles, or within reach of it.
std::vector<std::size_t> near_own(const NearImages& places, const std::vector<ParticleId>& own,
                                  double reach) {
  BoundingBox box;
  for (const ParticleId p : own) box.add(places.r[p.value], reach);
  const auto holds = [&box](const Vec3d& r) {
    return r.x >= box.low.x && r.y >= box.low.y && r.z >= box.low.z && r.x <= box.high.x &&
           r.y <= box.high.y && r.z <= box.high.z;
  };
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < places.r.size(); ++k)
    if (holds(places.r[k])) near.push_back(k);
  return near;
}

}  // namespace

std::vector<ImageOf> ghosts_of(const std::vector<ParticleId>& own, const Model& model, const State& state,
                               double reach, bool all) {
  PerParticle<char> is_own(model.particles(), 0);
  for (const ParticleId p : own) is_own[p] = 1;
  std::vector<ImageOf> ghosts;
  const auto add = [&](ParticleId p, const Image& n) {
    if (is_own[p] == 0 || !n.is_itself()) ghosts.push_back({p, n});
  };
  for (const Bond& b : state.bonds)
    if (!b.broken && is_own[b.i] != 0) add(b.j, b.image_j);
  if (all)
    for (const ParticleId p : is_own.ids()) add(p, {});
  if (reach > 0.0) {
    const NearImages places = places_of(model, state, reach);  // all ranks throw, or none
    const std::vector<std::size_t> near = near_own(places, own, reach);
    std::vector<Vec3d> r;
    for (const std::size_t k : near) r.push_back(places.r[k]);
    // particles in the cell have all their neighbours there, or among the images around it
    const auto add_neighbour = [&](std::size_t of, std::size_t k) {
      if (of < places.points && is_own[ParticleId{places.of[of]}] != 0)
        add(ParticleId{places.of[k]}, places.image[k] - places.image[of]);
    };
    for_near_pairs(r, reach, [&](std::size_t k, std::size_t l, double) {
      add_neighbour(near[k], near[l]);
      add_neighbour(near[l], near[k]);
    });
  }
  std::sort(ghosts.begin(), ghosts.end());
  ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
  return ghosts;
}

}  // namespace vbond
