#include "vbond/model/held_axes.hpp"

#include <algorithm>
#include <cmath>

namespace vbond {
namespace {

constexpr double rounding = 1e-9;

/// The number of the axis of the world that this unit vector is, either way; 3 if it is none.
std::size_t world_axis(const Vec3d& a) {
  for (std::size_t k = 0; k < 3; ++k)
    if (are_parallel(a, world_axes[k])) return k;
  return 3;
}

/// Directions, as unit vectors perpendicular to each other that span the same.
std::vector<Vec3d> orthonormal(const std::vector<Vec3d>& directions) {
  std::vector<Vec3d> done;
  for (const Vec3d& d : directions) {
    Vec3d a = normalised(d);
    for (int twice = 0; twice < 2; ++twice)
      for (const Vec3d& b : done) a = across(a, b);
    if (done.size() < 3 && norm(a) > rounding) done.push_back(normalised(a));
  }
  return done;
}

/// Right-handed axes of which these are the first. One or two of them.
Triad completed(const std::vector<Vec3d>& first) {
  const Vec3d& a = first[0];
  Vec3d b;
  if (first.size() > 1) {
    b = first[1];
  } else {
    const Vec3d size{std::abs(a.x), std::abs(a.y), std::abs(a.z)};
    const std::size_t least = size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2;
    b = normalised(across(world_axes[least], a));
  }
  return {a, b, cross(a, b)};
}

/// Triad whose first ones are held, or the world's with those flags.
Triad axes_with(const std::vector<Vec3d>& directions, bool* held) {
  const std::vector<Vec3d> span = orthonormal(directions);
  const auto none = [](const Vec3d& a) { return world_axis(a) == 3; };
  if (span.size() == 3 || std::none_of(span.begin(), span.end(), none)) {
    for (const Vec3d& a : span)
      if (span.size() < 3) held[world_axis(a)] = true;
    if (span.size() == 3) std::fill_n(held, 3, true);
    return world_axes;
  }
  std::fill_n(held, 3, false);
  std::fill_n(held, span.size(), true);
  return completed(span);
}

std::vector<Vec3d> listed(const bool* named, const std::vector<Vec3d>& more) {
  std::vector<Vec3d> all;
  for (std::size_t k = 0; k < 3; ++k)
    if (named[k]) all.push_back(world_axes[k]);
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace

bool are_parallel(const Vec3d& a, const Vec3d& b) {
  return norm(cross(a, b)) <= rounding;
}

bool are_right_handed(const Triad& axes) {
  return std::abs(norm(axes[0]) - 1.0) <= rounding && std::abs(norm(axes[1]) - 1.0) <= rounding &&
         norm(cross(axes[0], axes[1]) - axes[2]) <= rounding;
}

HeldDirections held_directions(const HeldDofs& named, const std::vector<Vec3d>& along,
                               const std::vector<Vec3d>& about) {
  HeldDirections d{named};
  HeldAxes axes;
  if (!along.empty()) axes.along = axes_with(listed(named.data(), along), d.held.data());
  if (!about.empty()) axes.about = axes_with(listed(named.data() + 3, about), d.held.data() + 3);
  if (axes != HeldAxes{}) d.axes = axes;
  return d;
}

Vec3d held_part(const HeldDirections& d, const Vec3d& v, bool is_rotation) {
  Vec3d part;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t dof = is_rotation ? k + 3 : k;
    const Vec3d& a = axis_of(d.axes ? &*d.axes : nullptr, dof);
    if (d.held[dof]) part += dot(v, a) * a;
  }
  return part;
}

std::optional<Triad> common_axes(const std::vector<Vec3d>& held) {
  std::vector<Vec3d> kept;
  for (const Vec3d& a : held) {
    const auto is_it = [&a](const Vec3d& b) { return are_parallel(a, b); };
    const auto slants = [&a](const Vec3d& b) { return std::abs(dot(a, b)) > rounding; };
    if (std::any_of(kept.begin(), kept.end(), is_it)) continue;
    if (std::any_of(kept.begin(), kept.end(), slants)) return std::nullopt;
    kept.push_back(a);
  }
  const auto is_world = [](const Vec3d& a) { return world_axis(a) < 3; };
  if (std::all_of(kept.begin(), kept.end(), is_world)) return world_axes;
  const std::vector<Vec3d> exactly = orthonormal(kept);
  return completed({exactly.begin(), exactly.begin() + std::min<std::ptrdiff_t>(2, std::ssize(exactly))});
}

}  // namespace vbond
