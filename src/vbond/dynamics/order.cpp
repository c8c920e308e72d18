#include "vbond/dynamics/order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace vbond {
namespace {

/// The layer of each particle along the body's longest, middle and shortest direction.
using Layers = std::array<std::int64_t, 3>;

/// The spacing if particles filled their box. A sheet or a fibre has no volume: thin directions do not count.
double spacing_in(const Vec3d& extent, std::size_t particles) {
  const double longest = std::max({extent.x, extent.y, extent.z});
  double filled = 1.0;
  int directions = 0;
  for (int k = 0; k < 3; ++k)
    if (component(extent, k) > 1e-3 * longest) filled *= component(extent, k), ++directions;
  return directions > 0 ? std::pow(filled / static_cast<double>(particles), 1.0 / directions) : 1.0;
}

std::vector<Layers> layers_of(const PerParticle<Vec3d>& r) {
  Vec3d min = *r.begin(), max = min;
  for (const Vec3d& p : r)
    for (int k = 0; k < 3; ++k) {
      component(min, k) = std::min(component(min, k), component(p, k));
      component(max, k) = std::max(component(max, k), component(p, k));
    }
  const Vec3d extent = max - min;
  std::array<int, 3> axis{0, 1, 2};
  std::stable_sort(axis.begin(), axis.end(),
                   [&extent](int k, int l) { return component(extent, k) > component(extent, l); });
  const double spacing = spacing_in(extent, r.size());

  std::vector<Layers> layers;
  layers.reserve(r.size());
  for (const Vec3d& p : r) {
    Layers& l = layers.emplace_back();
    for (std::size_t n = 0; n < 3; ++n) {
      const double x = (component(p, axis[n]) - component(min, axis[n])) / spacing;
      l[n] = static_cast<std::int64_t>(std::min(x + 0.5, 1e15));  // rounded: lattices fall into their layers
    }
  }
  return layers;
}

}  // namespace

Order spatial_order(const PerParticle<Vec3d>& r) {
  Order order;
  if (r.empty()) return order;
  const std::vector<Layers> layers = layers_of(r);
  std::vector<std::uint32_t> sorted(r.size());
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&layers](std::uint32_t i, std::uint32_t j) { return layers[i] < layers[j]; });
  order.row.resize(r.size());
  order.particle.resize(r.size());
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    order.particle[Row{k}] = ParticleId{sorted[k]};
    order.row[ParticleId{sorted[k]}] = Row{k};
  }
  order.inner = order.own = order.known = r.size();
  return order;
}

Order part_of(const Order& whole, const Holding& holding) {
  enum : char { inner, sent, ghost, absent };
  PerParticle<char> place(whole.row.size(), absent);
  for (const ParticleId p : holding.ghosts) place[p] = ghost;
  for (const ParticleId p : holding.own) place[p] = inner;
  for (const ParticleId p : holding.sent) place[p] = sent;
  Order part;
  part.row.resize(whole.row.size());
  for (const char which : {inner, sent, ghost, absent}) {
    for (const ParticleId p : whole.particle) {
      if (place[p] != which) continue;
      part.row[p] = Row{part.particle.size()};
      part.particle.push_back(p);
    }
    if (which == inner) part.inner = part.particle.size();
    if (which == sent) part.own = part.particle.size();
    if (which == ghost) part.known = part.particle.size();
  }
  return part;
}

std::optional<Row> Order::find(ParticleId p, const Image& n) const {
  if (n.is_itself()) return row[p];
  const auto before = [this](Row k, const std::pair<Row, Image>& wanted) {
    return std::pair(row[particle[k]], images[k.value - own]) < wanted;
  };
  std::size_t first = own, count = images.size();
  while (count > 0) {
    const std::size_t half = count / 2;
    if (before(Row{first + half}, {row[p], n}))
      first += half + 1, count -= half + 1;
    else
      count = half;
  }
  const Row at{first};
  if (first == own + images.size() || particle[at] != p || image(at) != n) return std::nullopt;
  return at;
}

Order with_images(const Order& whole, const std::vector<ImageOf>& images, bool all_sent) {
  Holding holding;
  PerParticle<char> has_images(whole.row.size(), all_sent ? 1 : 0);
  for (const ImageOf& of : images) has_images[of.particle] = 1;
  for (const ParticleId p : has_images.ids()) {
    holding.own.push_back(p);
    if (has_images[p] != 0) holding.sent.push_back(p);
  }
  Order order = part_of(whole, holding);
  std::vector<std::pair<Row, Image>> rows;
  for (const ImageOf& of : images) rows.emplace_back(order.row[of.particle], of.image);
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  for (const auto& [row, image] : rows) {
    order.particle.push_back(order.particle[row]);
    order.images.push_back(image);
  }
  order.known = order.own + order.images.size();
  return order;
}

}  // namespace vbond
