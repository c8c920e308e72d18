#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace vbond::page {

/// Walls as the page shows them: triangles as they stand in the first frame, and how each wall has moved
/// since.
struct Walls {
  std::vector<float> corners;            ///< x0, y0, z0, x1, ... from the origin of the sequence  [length]
  std::vector<std::uint32_t> triangles;  ///< three corners each
  std::vector<std::uint32_t> wall;       ///< of each corner
  /// For each frame and wall a rotation, row by row, and a shift: a corner x is at R x + t. All 0 where
  /// a stage has taken the wall away.
  std::vector<std::vector<float>> motion;
  std::size_t left_out = 0;  ///< so many triangles are too many for a page; then there is nothing else
};
constexpr std::size_t most_wall_triangles = 300'000;
constexpr std::size_t numbers_of_motion = 12;

/// Reads the walls of these frames; nothing if a file is not named. Throws IoError.
Walls read_walls(const std::vector<std::filesystem::path>& files, const std::array<double, 3>& origin);

}  // namespace vbond::page
