#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// Cuts a polygon, given by numbers of corners, into triangles and appends them: convex ones as a fan about
/// the first corner, others by cutting off ears (Meisters 1975) as seen along their normal. Corners in the
/// middle of a side stay corners of triangles, so that neighbours with that corner fit. Returns why it cannot
/// be done: it crosses itself, or has too many corners; empty if all is well.
std::string cut_polygon(const std::vector<Vec3d>& corners, std::span<const std::uint32_t> polygon,
                        std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace vbond
