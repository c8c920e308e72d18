#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// A top of which supports hold some turns, but neither all three nor two of them at rest: then no motion of
/// dynamics is known that keeps what is held. With the first support that does.
struct PartlyHeldTop {
  ParticleId p;
  std::size_t support;
};
std::optional<PartlyHeldTop> partly_held_top(const Model& model, const std::vector<Support>& supports);
inline constexpr const char* partly_held_top_rule =
    "of a particle whose moments of inertia differ a support holds no turn, all three, or two at rest, about "
    "axes of the world";

}  // namespace vbond
