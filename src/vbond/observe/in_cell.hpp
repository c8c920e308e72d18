#pragma once
#include <array>
#include <optional>

#include "vbond/core/cell.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

/// How the cell of a periodic body, and particles in it, are shown: views only, the body knows nothing of
/// them.
namespace vbond {

/// The cell at the time of a frame.
struct FrameCell {
  std::array<Vec3d, 3> edges;  ///< [length]
  Vec3d corner;                ///< where they begin: it has moved as the cell deforms  [length]
  Periodic periodic;           ///< along which of them the body repeats
  friend bool operator==(const FrameCell&, const FrameCell&) = default;
};
/// Nothing of a body that is not periodic.
std::optional<FrameCell> frame_cell(const Model& model, const State& state);

/// Which image of each particle stands in the cell.
PerParticle<Image> images_in_cell(const Model& model, const State& state);

/// The same body with these images in place of its particles: positions, velocities, and which images bonds
/// and contacts join. The first positions of particles are not those of their images.
State shown_by_images(const State& state, const PerParticle<Image>& images);

}  // namespace vbond
