#include "vbond/setup/mesh_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/column.hpp"
#include "vbond/core/disjoint_sets.hpp"

namespace vbond {
namespace {

using Corner = Id<struct CornerTag>;
using Sets = DisjointSets<Corner>;

constexpr double part_of_side = 0.25, needle = 1e-3;
constexpr int per_level = 4;  // distances of joining fall by this factor from level to level

/// Joins equal places; returns one corner of each.
std::vector<std::uint32_t> join_equal(const std::vector<Vec3d>& r, Sets& sets) {
  std::vector<std::uint32_t> order(r.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t k) { return std::tuple(r[k].x, r[k].y, r[k].z); };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t i, std::uint32_t j) { return key(i) != key(j) ? key(i) < key(j) : i < j; });
  std::vector<std::uint32_t> places;
  for (const std::uint32_t k : order)
    if (places.empty() || key(k) != key(places.back()))
      places.push_back(k);
    else
      sets.join(Corner(k), Corner(places.back()));
  return places;
}

/// The distance of joining at level k is largest / 4^k.
struct Levels {
  double largest = 0;
  int deepest = 0;  ///< where the distance comes near the roundings of 64 bits

  Levels(const TriangleMesh& mesh, const BoundingBox& box) {
    double far = 0.0;
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t k : t) {
        const Vec3d& r = mesh.corners[k];
        far = std::max({far, std::abs(r.x), std::abs(r.y), std::abs(r.z)});
      }
    constexpr double last_bit = std::numeric_limits<float>::epsilon();
    largest = std::max(same_corner * box.diagonal(), 2.0 * last_bit * far);
    for (double t = largest; t > 1e-15 * far && deepest < 40; t /= per_level) ++deepest;
  }
  double distance(int level) const { return largest * std::pow(static_cast<double>(per_level), -level); }
  int of(double limit) const {
    int level = 0;
    while (level <= deepest && distance(level) > limit) ++level;
    return level;
  }
};

/// The level of each corner, by the sides of its triangles.
std::vector<int> levels_of(const TriangleMesh& mesh, const Sets& equal, const Levels& levels) {
  Sets sets = equal;
  std::vector<int> level(mesh.corners.size(), 0);
  for (const auto& t : mesh.triangles) {
    const Vec3d &a = mesh.corners[t[0]], &b = mesh.corners[t[1]], &c = mesh.corners[t[2]];
    if (!has_area(a, b, c)) continue;
    const auto [shortest, longest] = std::minmax({norm(b - a), norm(c - b), norm(a - c)});
    if (shortest < levels.largest && shortest < needle * longest) continue;
    const int least = levels.of(part_of_side * shortest);
    for (const std::uint32_t k : t) {
      int& of = level[sets.smallest(Corner(k)).value];
      of = std::max(of, least);
    }
  }
  return level;
}

using Cell = std::array<std::int64_t, 3>;

Cell cell_of(const Vec3d& r, double size) {
  const auto along = [size](double x) { return static_cast<std::int64_t>(std::floor(x / size)); };
  return {along(r.x), along(r.y), along(r.z)};
}

double gap(const BoundingBox& a, const BoundingBox& b) {
  const auto between = [](double low, double high, double low_2, double high_2) {
    return std::max({low - high_2, low_2 - high, 0.0});
  };
  return std::hypot(between(a.low.x, a.high.x, b.low.x, b.high.x),
                    between(a.low.y, a.high.y, b.low.y, b.high.y),
                    between(a.low.z, a.high.z, b.low.z, b.high.z));
}

/// Places in one fine cell, which are all within the distance of joining of one another.
struct Clump {
  Cell coarse;
  BoundingBox box;
  std::uint32_t first;
};

/// Clumps in order of their coarse cells, each as long as the distance of joining.
std::vector<Clump> clumps_of(const std::vector<Vec3d>& r, const std::vector<std::uint32_t>& places,
                             double distance, Sets& sets) {
  constexpr double fine =
      0.25;  // of the distance: the diagonal of a cell is 0.43 of it; >> 2 makes them coarse
  std::vector<std::pair<Cell, std::uint32_t>> cells;
  for (const std::uint32_t k : places) cells.emplace_back(cell_of(r[k], fine * distance), k);
  std::sort(cells.begin(), cells.end());
  std::vector<Clump> clumps;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const auto& [cell, k] = cells[n];
    if (n == 0 || cell != cells[n - 1].first)
      clumps.push_back({{cell[0] >> 2, cell[1] >> 2, cell[2] >> 2}, {}, k});
    else
      sets.join(Corner(clumps.back().first), Corner(k));
    clumps.back().box.add(r[k]);
  }
  std::sort(clumps.begin(), clumps.end(), [](const Clump& a, const Clump& b) {
    return a.coarse != b.coarse ? a.coarse < b.coarse : a.first < b.first;
  });
  return clumps;
}

/// Joins all places that are closer than the distance: exactly where each is alone in its clump, and up to
/// twice as far between crowds of them, so that no crowd takes a time that grows with its square.
void join_near(const std::vector<Vec3d>& r, const std::vector<std::uint32_t>& places, double distance,
               Sets& sets) {
  const std::vector<Clump> clumps = clumps_of(r, places, distance, sets);
  const auto begins = [&](const Cell& cell) {
    return std::lower_bound(clumps.begin(), clumps.end(), cell,
                            [](const Clump& c, const Cell& other) { return c.coarse < other; });
  };
  // half of the 26 neighbours, in rows along z
  constexpr std::array<std::array<int, 3>, 5> rows{
      {{0, 0, 0}, {0, 1, -1}, {1, -1, -1}, {1, 0, -1}, {1, 1, -1}}};
  for (auto one = clumps.begin(); one != clumps.end(); ++one)
    for (const auto& [x, y, z] : rows) {
      const bool own = x == 0 && y == 0;
      const Cell& at = one->coarse;
      const Cell last{at[0] + x, at[1] + y, at[2] + 1};
      auto other = own ? one + 1 : begins({last[0], last[1], at[2] + z});
      for (; other != clumps.end() && other->coarse <= last; ++other) {
        const Corner a(one->first), b(other->first);
        if (sets.smallest(a) != sets.smallest(b) && gap(one->box, other->box) <= distance) sets.join(a, b);
      }
    }
}

}  // namespace

JoinedCorners join_corners(TriangleMesh& mesh) {
  BoundingBox box;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t k : t) box.add(mesh.corners[k]);
  JoinedCorners joined;
  if (!(box.diagonal() > 0.0)) return joined;
  Sets sets(mesh.corners.size());
  std::vector<std::uint32_t> places = join_equal(mesh.corners, sets);
  const Levels levels(mesh, box);
  const std::vector<int> level = levels_of(mesh, sets, levels);
  // the smallest of equal corners, so that it holds the level of all
  for (std::uint32_t& k : places) k = sets.smallest(Corner(k)).value;
  Sets all = sets;
  for (int n = 0; n <= levels.deepest; ++n) {
    std::vector<std::uint32_t> alike;
    bool some = n == 0;
    for (const std::uint32_t k : places) {
      if (level[k] <= n) alike.push_back(k);
      some = some || level[k] == n;
    }
    if (some) join_near(mesh.corners, alike, levels.distance(n), all);
  }
  for (const std::uint32_t k : places) {
    const std::uint32_t stands = all.smallest(Corner(k)).value;
    if (stands == k) continue;
    ++joined.count;
    joined.farthest = std::max(joined.farthest, norm(mesh.corners[k] - mesh.corners[stands]));
  }
  joined.farthest /= box.diagonal();
  for (auto& t : mesh.triangles)
    for (std::uint32_t& k : t) k = all.smallest(Corner(k)).value;
  return joined;
}

void take_corners(const std::vector<Vec3d>& corners, TriangleMesh& mesh) {
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  std::vector<Vec3d> taken;
  for (auto& t : mesh.triangles)
    for (std::uint32_t& corner : t) {
      const auto [at, is_new] = number.emplace(corner, static_cast<std::uint32_t>(taken.size()));
      if (is_new) taken.push_back(corners[corner]);
      corner = at->second;
    }
  mesh.corners = std::move(taken);
}

}  // namespace vbond
