#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "vbond/model/units.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/in_cell.hpp"
#include "vbond/observe/vtp.hpp"

namespace vbond {

void write_cell_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                    std::optional<double> load_factor, FrameFormat format) {
  const std::optional<FrameCell> cell = frame_cell(model, state);
  if (!cell) return;
  std::vector<Vec3d> corners;  // bit k of its number: whether edge k leads there
  for (std::size_t n = 0; n < 8; ++n) {
    Vec3d& x = corners.emplace_back(cell->corner);
    for (std::size_t k = 0; k < 3; ++k)
      if ((n >> k & 1) != 0) x += cell->edges[k];
  }
  std::vector<std::int64_t> ends, edge;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t n = 0; n < 8; ++n) {
      if ((n >> k & 1) != 0) continue;
      ends.insert(ends.end(), {static_cast<std::int64_t>(n), static_cast<std::int64_t>(n | 1u << k)});
      edge.push_back(static_cast<std::int64_t>(k));
    }
  VtpFile f = VtpFile::of_lines(corners, ends, format);
  f.set_unit_of_points(unit::length.in(model.units));
  f.set_cell(*cell);
  f.add_cell_data("edge", edge);
  f.write(path, state.clock.time(), state.clock.step, load_factor);
}

}  // namespace vbond
