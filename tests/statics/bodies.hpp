#pragma once
#include <utility>
#include <vector>

#include "dynamics/rods.hpp"
#include "validation/rests.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::testing {

/// Held so that a body in the x-y plane stays in it.
inline constexpr HeldDofs in_plane{false, false, true, true, true};

inline Support fixed(std::vector<ParticleId> particles, HeldDofs held, const Vec3d& displacement = {},
                     const Vec3d& rotation = {}) {
  return {"fixed", std::move(particles), held, displacement, rotation};
}

/// Force and moment on one particle, in proportion to the load factor.
inline PointLoad pushed(std::size_t particle, const Vec3d& force, const Vec3d& moment = {}) {
  return {"pushed", {ParticleId{particle}}, force, moment};
}

inline StaticStage static_stage(StageKind kind, std::vector<Support> supports,
                                std::vector<PointLoad> loads = {}) {
  StaticStage stage;
  stage.name = "test";
  stage.kind = kind;
  stage.supports = std::move(supports);
  stage.loads = std::move(loads);
  return stage;
}

/// The 45 degree bend of Bathe and Bolourchi: R = 100, E = 1e7, a square section of side 1, nu = 0, clamped
/// at the origin along +x and bent towards +y; N bonds.
inline Specimen bathe_bolourchi_bend(std::size_t N) {
  const double R = 100.0;
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= N; ++k) {
    const double phi = M_PI / 4 * static_cast<double>(k) / static_cast<double>(N);
    r.push_back({R * std::sin(phi), R * (1 - std::cos(phi)), 0});
  }
  Specimen s = particles_at(r);
  BondRecipe recipe;  // the polar moment of the reference: 1/6
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1e7, 0.0}, {1.0, 1.0 / 12, 1.0 / 6}, 0};
  recipe.n_2 = Vec3d{0, 0, 1};
  for (std::size_t k = 0; k < N; ++k) bond(s, k, k + 1, recipe);
  return s;
}

}  // namespace vbond::testing
