#include "vbond/terms/walls/page_wall_shapes.hpp"

#include <algorithm>

#include "vbond/core/error.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/report/block.hpp"
#include "vbond/report/vtp_read.hpp"

namespace vbond::page {
namespace {

using Per = VtpInput::Per;

[[noreturn]] void refuse_walls(const std::filesystem::path& file, const char* why) {
  throw IoError(file.string() + ": is damaged: " + why);
}

/// Where a wall is in a frame: one of its corners, and its rotation since the start; or that it is not there.
struct Pose {
  Vec3d corner;
  Quatd q;
  bool off = false;
};

/// The first corner and the first triangle of each wall, which are the same in all frames.
struct Anchors {
  std::vector<std::size_t> corner, triangle;
};

std::vector<Pose> poses_in(const VtpInput& in, const Anchors& anchors) {
  const std::vector<Vec3d> points = in.vectors(Per::point, "Points"),
                           rotation = in.vectors(Per::cell, "rotation");
  std::vector<std::int64_t> off(in.cells(), 0);  // frames of earlier versions do not tell
  if (in.has(Per::cell, "off")) off = in.integers(Per::cell, "off");
  std::vector<Pose> poses;
  for (std::size_t w = 0; w < anchors.corner.size(); ++w) {
    const std::size_t triangle = anchors.triangle[w];
    poses.push_back({points[anchors.corner[w]], rotation_of(rotation[triangle]), off[triangle] != 0});
  }
  return poses;
}

/// Takes up the triangles of the first frame.
Anchors read_shapes(const VtpInput& in, const std::filesystem::path& file, const Vec3d& origin,
                    Walls& walls) {
  const std::vector<Vec3d> points = in.vectors(Per::point, "Points");
  const std::vector<std::int64_t> corners = in.integers(Per::end, "connectivity"),
                                  id = in.integers(Per::cell, "id");
  Anchors anchors;
  walls.wall.assign(points.size(), 0);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::int64_t corner = corners[k], wall = id[k / 3];
    if (corner < 0 || corner >= static_cast<std::int64_t>(points.size()))
      refuse_walls(file, "a corner is not there");
    const auto known = static_cast<std::int64_t>(anchors.corner.size());
    if (wall < 0 || wall > known) refuse_walls(file, "its walls are not in order");
    if (wall == known) {
      anchors.corner.push_back(static_cast<std::size_t>(corner));
      anchors.triangle.push_back(k / 3);
    }
    walls.triangles.push_back(static_cast<std::uint32_t>(corner));
    walls.wall[static_cast<std::size_t>(corner)] = static_cast<std::uint32_t>(wall);
  }
  for (const Vec3d& x : points)
    for (const double c : {x.x - origin.x, x.y - origin.y, x.z - origin.z})
      walls.corners.push_back(as_float(c, file));
  return anchors;
}

}  // namespace

Walls read_walls(const std::vector<std::filesystem::path>& files, const std::array<double, 3>& origin) {
  Walls walls;
  const auto unnamed = [](const std::filesystem::path& file) { return file.empty(); };
  if (files.empty() || std::any_of(files.begin(), files.end(), unnamed)) return walls;
  const Vec3d o{origin[0], origin[1], origin[2]};
  Anchors anchors;
  std::vector<Pose> start;
  std::size_t points = 0, cells = 0;
  for (const std::filesystem::path& file : files) {
    const VtpInput in(file);
    if (!in.triangles()) refuse_walls(file, "its cells are not triangles");
    if (in.cells() > most_wall_triangles) {
      Walls none;
      none.left_out = in.cells();
      return none;
    }
    if (start.empty()) {
      points = in.points(), cells = in.cells();
      anchors = read_shapes(in, file, o, walls);
      start = poses_in(in, anchors);
    }
    if (in.points() != points || in.cells() != cells)
      throw IoError(file.string() + ": its walls are not those of the frames before it");
    const std::vector<Pose> now = poses_in(in, anchors);
    std::vector<float>& motion = walls.motion.emplace_back();
    for (std::size_t w = 0; w < now.size(); ++w) {
      if (now[w].off) {  // all of its corners in one point: nothing is seen of it
        motion.insert(motion.end(), numbers_of_motion, 0.0F);
        continue;
      }
      const Quatd turned = now[w].q * conjugate(start[w].q);
      const Axes<double> R = axes(turned);
      const Vec3d t = now[w].corner - o - rotate(turned, start[w].corner - o);
      for (const double x : {R.x.x, R.y.x, R.z.x, R.x.y, R.y.y, R.z.y, R.x.z, R.y.z, R.z.z, t.x, t.y, t.z})
        motion.push_back(as_float(x, file));
    }
  }
  return walls;
}

}  // namespace vbond::page
