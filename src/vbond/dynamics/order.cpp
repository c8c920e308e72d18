#include "vbond/dynamics/order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "vbond/core/bounding_box.hpp"

namespace vbond {
namespace {

/// Not a matter of the number of threads, as results must not depend on it.
constexpr std::size_t slab_rows = 32 * block_rows;

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

class Layering {
 public:
  /// Of those that the column holds, if any.
  explicit Layering(const PerParticle<Vec3d>& r) {
    if (r.values().empty()) return;
    const BoundingBox box = box_around(r);
    min_ = box.low;
    axis_ = box.axes_by_length();
    spacing_ = spacing_in(box.high - box.low, r.values().size());
  }
  Layers of(const Vec3d& p) const {
    Layers l{};
    for (std::size_t n = 0; n < 3; ++n) {
      const double x = (component(p, axis_[n]) - component(min_, axis_[n])) / spacing_;
      l[n] = static_cast<std::int64_t>(std::min(x + 0.5, 1e15));  // rounded: lattices fall into their layers
    }
    return l;
  }

 private:
  Vec3d min_;
  std::array<int, 3> axis_{0, 1, 2};
  double spacing_ = 1;
};

std::vector<Layers> layers_of(const PerParticle<Vec3d>& r) {
  const Layering layering(r);
  std::vector<Layers> layers;
  layers.reserve(r.size());
  for (const Vec3d& p : r) layers.push_back(layering.of(p));
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
  PerParticle<Row> row(r.size());
  order.particle.resize(r.size());
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    order.particle[Row{k}] = ParticleId{sorted[k]};
    row[ParticleId{sorted[k]}] = Row{k};
  }
  order.row = RowOf(std::move(row));
  order.own = order.ghosts = order.known = r.size();
  return order;
}

Order spatial_order(const PerParticle<Vec3d>& r, const std::vector<ParticleId>& some) {
  Order order;
  if (r.empty()) return order;
  const auto known = std::make_shared<const IdSet<ParticleId>>(r.size(), some);
  struct Placed {
    Layers layers;
    ParticleId particle;
  };
  const Layering layering(r);
  std::vector<Placed> sorted;
  sorted.reserve(known->size());
  known->for_each([&](ParticleId p) { sorted.push_back({layering.of(r[p]), p}); });
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Placed& a, const Placed& b) { return a.layers < b.layers; });
  PerParticle<Row> row;
  row.assign(r.size(), {});
  row.hold(known);
  for (const Placed& p : sorted) {
    row[p.particle] = Row{order.particle.size()};
    order.particle.push_back(p.particle);
  }
  order.own = order.ghosts = order.known = sorted.size();
  for (const ParticleId p : r.ids())
    if (!known->has(p)) {
      order.particle.push_back(p);
      break;
    }
  order.row = RowOf(std::move(row), known, Row{order.known});
  return order;
}

Order part_of(const Order& whole, const Holding& holding) {
  enum : char { inner, early, ghost, absent };
  PerParticle<char> place(whole.row.size(), absent);
  for (const ImageOf& g : holding.ghosts)
    if (g.image.is_itself()) place[g.particle] = ghost;
  for (const ParticleId p : holding.own) place[p] = inner;
  for (const ParticleId p : holding.early) place[p] = early;

  Order part;
  part.ghost_bonds_last = holding.ghost_bonds_last;
  PerParticle<Row> row(whole.row.size());
  const auto add = [&part, &row](ParticleId p) {
    row[p] = Row{part.particle.size()};
    part.particle.push_back(p);
  };
  std::vector<ParticleId> slab;
  const auto add_slab = [&] {
    std::stable_partition(slab.begin(), slab.end(), [&place](ParticleId p) { return place[p] == inner; });
    for (const ParticleId p : slab) {
      if (place[p] == early)
        part.early_blocks.resize(part.particle.size() / block_rows + 1), part.early_blocks.back() = 1;
      add(p);
    }
    slab.clear();
  };
  for (const ParticleId p : whole.particle) {
    if (place[p] != inner && place[p] != early) continue;
    slab.push_back(p);
    if (slab.size() == slab_rows) add_slab();
  }
  add_slab();
  part.own = part.particle.size();
  while (holding.apart && part.particle.size() % rows_at_once != 0)
    part.particle.push_back(part.particle[Row{part.own - 1}]);
  part.ghosts = part.particle.size();
  std::vector<std::pair<Row, ImageOf>> ghosts;
  bool any_image = false;
  for (const ImageOf& g : holding.ghosts) {
    const bool own = place[g.particle] == inner || place[g.particle] == early;
    ghosts.emplace_back(own ? row[g.particle] : Row{part.own + whole.row[g.particle].value}, g);
    any_image |= !g.image.is_itself();
  }
  std::sort(ghosts.begin(), ghosts.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first, a.second.image) < std::pair(b.first, b.second.image);
  });
  for (const auto& [sorted, g] : ghosts) {
    if (g.image.is_itself()) row[g.particle] = Row{part.particle.size()};
    if (any_image) part.images.push_back(g.image), part.by_image.push_back(Row{part.particle.size()});
    part.particle.push_back(g.particle);
  }
  part.known = part.particle.size();
  std::vector<ParticleId> own_row;
  bool any_other = false;
  for (const ParticleId p : whole.particle) {
    if (place[p] != absent)
      own_row.push_back(p);
    else if (!(any_other && holding.others_in_one_row))
      add(p), any_other = true;
  }
  if (any_other && holding.others_in_one_row)
    part.row =
        RowOf(std::move(row), std::make_shared<IdSet<ParticleId>>(place.size(), own_row), Row{part.known});
  else
    part.row = RowOf(std::move(row));
  std::sort(part.by_image.begin(), part.by_image.end(),
            [&part](Row k, Row l) { return part.image_of(k) < part.image_of(l); });
  return part;
}

std::optional<Row> Order::find(ParticleId p, const Image& n) const {
  if (n.is_itself()) return row[p];
  const ImageOf wanted{p, n};
  const auto at = std::lower_bound(by_image.begin(), by_image.end(), wanted,
                                   [this](Row k, const ImageOf& of) { return image_of(k) < of; });
  if (at == by_image.end() || image_of(*at) != wanted) return std::nullopt;
  return *at;
}

}  // namespace vbond
