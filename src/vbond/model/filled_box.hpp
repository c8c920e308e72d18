#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

double volume_of(const BoundingBox& box);
/// The side of a cube with as much volume as each of so many particles has in the box.
double mean_distance(const BoundingBox& box, std::size_t particles);

/// Those that belong to a face of the box: centres no farther from it than their diameter, or the mean
/// distance where that is more. side: -1 or 1, of the axis.
std::vector<ParticleId> face_of_box(const Model& model, const State& state, const BoundingBox& box,
                                    const std::vector<ParticleId>& body, int axis, double side);

/// Why these particles do not fill the box around them: a corner is farther than two mean distances from all
/// of them, as that of a ball is, or a face has less than a third of the particles that would fill it, as
/// where some stick out. Nothing if they do.
std::optional<std::string> why_box_not_filled(const Model& model, const State& state, const BoundingBox& box,
                                              const std::vector<ParticleId>& body);

}  // namespace vbond
