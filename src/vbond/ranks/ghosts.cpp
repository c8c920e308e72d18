#include "vbond/ranks/ghosts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/images.hpp"

namespace vbond {
namespace {

/// All places that may be near a particle of the body, with whose image each is; those of absent particles
/// are not among them.
NearImages places_of(const Model& model, const State& state, double reach) {
  std::vector<std::size_t> of;
  std::vector<Vec3d> r;
  for (const ParticleId p : state.r.ids())
    if (!is_absent(state, p)) of.push_back(p.value), r.push_back(state.r[p]);
  NearImages places;
  if (model.cell.any()) {
    places = near_images(state.cell, model.cell.periodic, r, reach);
    for (std::size_t& k : places.of) k = of[k];
    return places;
  }
  places.points = r.size();
  places.image.resize(places.points);
  places.of = std::move(of);
  places.r = std::move(r);
  return places;
}

/// Those of the places that are in the box of a rank's particles, or within reach of it.
std::vector<std::size_t> near_own(const NearImages& places, const PerParticle<char>& is_own, double reach) {
  BoundingBox box;
  for (std::size_t k = 0; k < places.points; ++k)
    if (is_own[ParticleId{places.of[k]}] != 0) box.add(places.r[k], reach);
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
    if (!b.broken && is_own[b.i] != 0) add(b.j, image_of_j(b));
  if (all)
    for (const ParticleId p : is_own.ids())
      if (!is_absent(state, p)) add(p, {});
  if (reach > 0.0) {
    const NearImages places = places_of(model, state, reach);  // all ranks throw, or none
    const std::vector<std::size_t> near = near_own(places, is_own, reach);
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
