#pragma once
#include <utility>
#include <vector>

#include "dynamics/rods.hpp"
#include "validation/rests.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::testing {

/// Held so that a body in the x-y plane stays in it.
inline constexpr HeldDofs in_plane{false, false, true, true, true, false};

inline StaticSupport fixed(std::vector<ParticleId> particles, HeldDofs held, const Vec3d& displacement = {},
                           const Vec3d& rotation = {}) {
  return {"fixed", std::move(particles), held, displacement, rotation};
}

/// Force and moment on one particle, in proportion to the load factor.
inline StaticLoad pushed(std::size_t particle, const Vec3d& force, const Vec3d& moment = {}) {
  return {"pushed", {ParticleId{particle}}, force, moment, false};
}

inline StaticStage static_stage(StageKind kind, std::vector<StaticSupport> supports,
                                std::vector<StaticLoad> loads = {}) {
  StaticStage stage;
  stage.name = "test";
  stage.kind = kind;
  stage.supports = std::move(supports);
  stage.loads = std::move(loads);
  return stage;
}

}  // namespace vbond::testing
