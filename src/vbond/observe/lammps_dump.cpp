#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>

#include "vbond/core/bounding_box.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/in_cell.hpp"

// Format: LAMMPS manual, command dump, styles custom; boxes by three vectors since April 2024.
namespace vbond {
namespace {

/// How a box is given: by its ends along x, y and z; by those and xy, xz, yz; or by three vectors.
enum class Box : std::uint8_t { orthogonal, triclinic, general };

/// Of edges: whether they are small against the edge that they belong to. Rounding may leave them.
bool is_small(double x, const Vec3d& edge) {
  return std::abs(x) <= 1e-12 * norm(edge);
}

/// The simplest style for these edges. LAMMPS has the first edge of a box along x and the second one in the
/// plane of x and y.
Box style_of(const std::array<Vec3d, 3>& edges) {
  const auto& [a, b, c] = edges;
  if (!is_small(a.y, a) || !is_small(a.z, a) || !is_small(b.z, b) || a.x < 0.0 || b.y < 0.0)
    return Box::general;
  return is_small(b.x, b) && is_small(c.x, c) && is_small(c.y, c) ? Box::orthogonal : Box::triclinic;
}

/// The style for all that the cell may become: a symmetric deformation gradient with shear turns its edges,
/// an upper triangular one tilts them.
Box style_of(const CellShape& shape, bool shears) {
  const Box at_start = style_of(shape.edges);
  if (!shears) return at_start;
  return std::max(at_start, shape.triangular ? Box::triclinic : Box::general);
}

std::string open_box(const Model& model, const State& state) {
  BoundingBox box;
  const std::vector<ParticleId> without = left_out(state);
  for (const ParticleId p : model.mass.ids())
    if (!std::binary_search(without.begin(), without.end(), p)) box.add(state.r[p], model.radius[p]);
  if (without.size() == model.particles()) box = {{0, 0, 0}, {0, 0, 0}};
  return fmt::format("ITEM: BOX BOUNDS ss ss ss\n{} {}\n{} {}\n{} {}\n", box.low.x, box.high.x, box.low.y,
                     box.high.y, box.low.z, box.high.z);
}

std::string box_of_cell(const FrameCell& cell, Box style) {
  const auto end = [&cell](std::size_t k) { return cell.periodic[k] ? "pp" : "ss"; };
  const std::string ends = fmt::format("{} {} {}", end(0), end(1), end(2));
  const auto& [a, b, c] = cell.edges;
  const Vec3d& o = cell.corner;
  switch (style) {
    case Box::orthogonal:
      return fmt::format("ITEM: BOX BOUNDS {}\n{} {}\n{} {}\n{} {}\n", ends, o.x, o.x + a.x, o.y, o.y + b.y,
                         o.z, o.z + c.z);
    case Box::triclinic: {  // ends are those of the box around the tilted one
      const auto [least_x, most_x] = std::minmax({0.0, b.x, c.x, b.x + c.x});
      const auto [least_y, most_y] = std::minmax({0.0, c.y});
      return fmt::format("ITEM: BOX BOUNDS xy xz yz {}\n{} {} {}\n{} {} {}\n{} {} {}\n", ends, o.x + least_x,
                         o.x + a.x + most_x, b.x, o.y + least_y, o.y + b.y + most_y, c.x, o.z, o.z + c.z,
                         c.y);
    }
    case Box::general:
      return fmt::format("ITEM: BOX BOUNDS abc origin {}\n{} {} {} {}\n{} {} {} {}\n{} {} {} {}\n", ends, a.x,
                         a.y, a.z, o.x, b.x, b.y, b.z, o.y, c.x, c.y, c.z, o.z);
  }
  return {};
}

}  // namespace

std::string lammps_frame(const Model& model, const State& state, const FrameFormat& format) {
  fmt::memory_buffer out;
  const std::vector<ParticleId> without = left_out(state);
  const auto to = std::back_inserter(out);
  const std::optional<FrameCell> cell = frame_cell(model, state);
  const bool wraps = cell && format.wrap;
  std::string box;
  if (cell)  // a cell that a program moves otherwise than it has said may need more
    box = box_of_cell(*cell, std::max(style_of(model.cell, format.cell_shears), style_of(cell->edges)));
  else
    box = open_box(model, state);
  fmt::format_to(to,
                 "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\n{}"
                 "ITEM: ATOMS id type {} vx vy vz radius quatw quati quatj quatk{}\n",
                 state.clock.step, model.particles() - without.size(), box,
                 cell && !wraps ? "xu yu zu" : "x y z", wraps ? " ix iy iz" : "");
  PerParticle<Image> images;
  if (wraps) images = images_in_cell(model, state);
  for (const ParticleId p : model.mass.ids()) {
    if (std::binary_search(without.begin(), without.end(), p)) continue;
    const Image n = wraps ? images[p] : Image{};
    const Vec3d r = n.is_itself() ? state.r[p] : state.r[p] + to_image(state.cell, n);
    const Vec3d v = n.is_itself() ? state.v[p] : state.v[p] + image_velocity(state.cell, n);
    const Quatd& q = state.q[p];
    fmt::format_to(to, "{} {} {} {} {} {} {} {} {} {} {} {} {}", p.value + 1, model.specimen_of(p) + 1, r.x,
                   r.y, r.z, v.x, v.y, v.z, model.radius[p], q.w, q.x, q.y, q.z);
    if (wraps) fmt::format_to(to, " {} {} {}", -n.a, -n.b, -n.c);
    fmt::format_to(to, "\n");
  }
  return fmt::to_string(out);
}

}  // namespace vbond
