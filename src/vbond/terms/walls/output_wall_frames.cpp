#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <variant>
#include <vector>

#include "vbond/observe/detail/values_of.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/observe/vtp.hpp"
#include "vbond/terms/walls/output_wall_triangles.hpp"

namespace vbond {

void write_walls_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                     std::optional<double> load_factor, FrameFormat format) {
  write_walls_vtp(path, model, state, load_factor, format, body_at_start(model));
}

void write_walls_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                     std::optional<double> load_factor, FrameFormat format, const BoundingBox& body) {
  const std::vector<WallState> at_start(state.walls.empty() ? model.walls.size() : 0);
  std::vector<Vec3d> corners;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<WallView> views;  // of each triangle
  for (std::size_t w = 0; w < model.walls.size(); ++w) {
    const WallState& now = state.walls.empty() ? at_start[w] : state.walls[w];
    const TriangleMesh mesh = triangles_of(model.walls[w], body);
    const auto first = static_cast<std::int64_t>(corners.size());
    for (const Vec3d& x : mesh.corners) corners.push_back(moved(model.walls[w], now, x));
    for (const auto& t : mesh.triangles) triangles.push_back({first + t[0], first + t[1], first + t[2]});
    while (views.size() < triangles.size()) views.push_back({w, now});
  }
  VtpFile f = VtpFile::of_triangles(corners, triangles, format);
  f.set_unit_of_points(unit::length.in(model.units));
  const auto view = [&views](std::size_t k) -> const WallView& { return views[k]; };
  for (const WallQuantity& q : wall_quantities())
    std::visit(
        [&](const auto value) {
          f.add_cell_data(q.name, values_of(views.size(), view, value), q.unit.in(model.units));
        },
        q.value);
  f.write(path, state.clock.time(), state.clock.step, load_factor);
}

}  // namespace vbond
