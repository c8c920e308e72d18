#include "vbond/dynamics/order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace vbond {
namespace {

using Key = std::array<std::int64_t, 6>;  // three of the cell, three inside it

std::vector<Key> keys(const PerParticle<Vec3d>& r) {
  Vec3d min = *r.begin(), max = min;
  for (const Vec3d& p : r)
    for (int k = 0; k < 3; ++k) {
      component(min, k) = std::min(component(min, k), component(p, k));
      component(max, k) = std::max(component(max, k), component(p, k));
    }
  const Vec3d extent = max - min;
  std::array<int, 3> axis{0, 1, 2};  // longest first: cells of one cross-section follow one another
  std::stable_sort(axis.begin(), axis.end(), [&extent](int k, int l) { return component(extent, k) > component(extent, l); });

  // The spacing if the particles filled their box; a sheet or a fibre has no volume, so thin directions do
  // not count.
  const double longest = component(extent, axis[0]);
  double filled = 1.0;
  int directions = 0;
  for (int k = 0; k < 3; ++k)
    if (component(extent, k) > 1e-3 * longest) filled *= component(extent, k), ++directions;
  const double spacing = directions > 0 ? std::pow(filled / static_cast<double>(r.size()), 1.0 / directions) : 1.0;

  std::vector<Key> key;
  key.reserve(r.size());
  for (const Vec3d& p : r) {
    Key k{};
    for (std::size_t n = 0; n < 3; ++n) {
      const double x = (component(p, axis[n]) - component(min, axis[n])) / spacing;
      const auto layer = static_cast<std::int64_t>(std::min(x + 0.5, 1e15));
      k[n] = layer / 8;
      k[n + 3] = layer % 8;
    }
    key.push_back(k);
  }
  return key;
}

}  // namespace

Order spatial_order(const PerParticle<Vec3d>& r) {
  Order order;
  if (r.empty()) return order;
  const std::vector<Key> key = keys(r);
  std::vector<std::uint32_t> sorted(r.size());
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::stable_sort(sorted.begin(), sorted.end(), [&key](std::uint32_t i, std::uint32_t j) { return key[i] < key[j]; });
  order.row.resize(r.size());
  for (const std::uint32_t p : sorted) {
    order.row[ParticleId{p}] = Row{order.particle.size()};
    order.particle.push_back(ParticleId{p});
  }
  return order;
}

}  // namespace vbond
