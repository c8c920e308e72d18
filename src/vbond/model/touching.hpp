#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "vbond/model/body_part.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/present.hpp"
#include "vbond/model/rigid_bodies.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Calls visit(i, j, n, distance) once for every pair of a particle i and an image n of particle j whose
/// surfaces are nearer than the margin and that contacts may keep apart, i < j, or i = j and n > 0: not
/// bonded if only unbonded pairs touch, and not of one of these rigid bodies; those of fibres
/// (model/capsules.hpp) and particles that are absent apart. Of a part of a body, which knows what is near
/// within two radii and the margin, its own pairs.
template <class Visit>
void for_pairs_that_may_touch(const Model& model, const BodyPart& body, double margin,
                              const RigidBodies& bodies, Visit&& visit) {
  const State& state = body.state;
  if (!particles_touch(model.contact) || (model.particles() < 2 && state.cell.empty())) return;
  const auto key = [](std::uint64_t i, std::uint64_t j) { return std::min(i, j) << 32 | std::max(i, j); };
  std::unordered_multimap<std::uint64_t, Image> exempt;  // seen from the lower one
  if (model.contact.pairs == ContactPairs::unbonded)
    body.for_bonded([&](ParticleId i, ParticleId j, const Image& n, bool) {
      exempt.emplace(key(i.value, j.value), i < j || (i == j && n > Image{}) ? n : -n);
    });
  const auto is_exempt = [&](std::size_t i, std::size_t j, const Image& n) {
    const auto [first, last] = exempt.equal_range(key(i, j));
    return std::any_of(first, last, [&n](const auto& bonded) { return bonded.second == n; });
  };
  const std::vector<char> of_fibre = particles_of_fibres(model.particles(), state.bonds);
  const auto in_fibre = [&of_fibre](std::size_t p) { return !of_fibre.empty() && of_fibre[p] != 0; };
  for_overlapping_present(model, body, margin, [&](std::size_t i, std::size_t j, const Image& n, double d2) {
    if (in_fibre(i) || in_fibre(j) || is_exempt(i, j, n) || bodies.are_one(ParticleId{i}, ParticleId{j}, n))
      return;
    visit(ParticleId{i}, ParticleId{j}, n, std::sqrt(d2));
  });
}

/// The same for the rigid bodies of the state.
template <class Visit>
void for_pairs_that_may_touch(const Model& model, const BodyPart& body, double margin, Visit&& visit) {
  for_pairs_that_may_touch(model, body, margin, RigidBodies(model.particles(), body.state.carried),
                           std::forward<Visit>(visit));
}

/// By how much a pair at this distance repels each other's surfaces: what they do not feel of their overlap
/// is taken off; 0 or less if they do not touch.  [length]
inline double felt_overlap(const Model& model, const State& state, ParticleId i, ParticleId j, const Image& n,
                           double distance) {
  return model.radius[i] + model.radius[j] - distance - kept_overlap(state, i, j, n);
}

/// Calls visit(i, j, n, overlap) once for every pair that repel each other as they stand, with the overlap
/// that they feel. For looks now and then, not for a time loop.
template <class Visit>
void for_touching_pairs(const Model& model, const BodyPart& body, const RigidBodies& bodies, Visit&& visit) {
  const State& state = body.state;
  for_pairs_that_may_touch(model, body, 0.0, bodies,
                           [&](ParticleId i, ParticleId j, const Image& n, double distance) {
                             const double felt = felt_overlap(model, state, i, j, n, distance);
                             if (felt > 0.0) visit(i, j, n, felt);
                           });
}
template <class Visit>
void for_touching_pairs(const Model& model, const BodyPart& body, Visit&& visit) {
  for_touching_pairs(model, body, RigidBodies(model.particles(), body.state.carried),
                     std::forward<Visit>(visit));
}

}  // namespace vbond
