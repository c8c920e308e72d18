#include "vbond/dynamics/contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "vbond/dynamics/encounters.hpp"

namespace vbond {
namespace {

/// Pairs that touch, so many that their forces are worth evaluating together.
struct Touching {
  static constexpr std::size_t most = 128;
  std::size_t count = 0;
  std::array<Row, most> i, j;
  std::array<HertzContact<double>, most> law;
};

/// Takes up those of `near` that touch i; t has room for all. Each is written down and kept if it touches:
/// a branch could not be foretold.
void collect(Row i, std::span<const Row> near, const PoseRow* pose, const PerRow<double>& radius,
             Touching& t) {
  const Vec3d r_i = pose[i.value].r;
  const double R_i = radius[i];
  std::size_t n = t.count;
  for (const Row j : near) {
    t.i[n] = i, t.j[n] = j;
    n += static_cast<std::size_t>(!(norm2(pose[j.value].r - r_i) >= sq(R_i + radius[j])));
  }
  t.count = n;
}

/// Adds to the loads of each i what its j does to it, pair by pair. Returns whether one of the pairs is deep.
bool push_apart(Touching& t, const PoseRow* pose, const PerRow<double>& radius, LoadRow* load) {
  std::array<double, Touching::most> distance2, reach, scale;
  for (std::size_t l = 0; l < t.count; ++l) {
    distance2[l] = norm2(pose[t.j[l].value].r - pose[t.i[l].value].r);
    reach[l] = radius[t.i[l]] + radius[t.j[l]];
  }
  double deepest = 0.0;
#pragma omp simd reduction(max : deepest)
  for (std::size_t l = 0; l < t.count; ++l) {
    const double distance = std::sqrt(distance2[l]), beyond = deep_part * reach[l] - distance;
    deepest = beyond > deepest ? beyond : deepest;
    scale[l] = contact_force(t.law[l], reach[l] - distance) / distance;
  }
  for (std::size_t l = 0; l < t.count;) {
    const Row i = t.i[l];
    Vec3d F = load[i.value].F;
    do F -= scale[l] * (pose[t.j[l].value].r - pose[i.value].r);
    while (++l < t.count && t.i[l] == i);
    load[i.value].F = F;
  }
  t.count = 0;
  return deepest > 0.0;
}

}  // namespace

Contacts::Contacts(const Model& model, const Order& order, const BondIndex& index) : model_(model) {
  if (model.contact.law == ContactLaw::none || model.particles() == 0) return;
  for (const ParticleId p : order.particle) radius_.push_back(model.radius[p]);
  const auto [R_min, R_max] = std::minmax_element(radius_.begin(), radius_.end());
  if (!(*R_max > 0.0)) return;
  if (*R_min == *R_max) one_law_ = contact_law(model.contact, *R_min, *R_max);

  NeighbourList::Keep keep;
  if (model.contact.pairs == ContactPairs::unbonded)
    keep = [&order, &index](Row i, Row* first, Row* last) {
      return std::remove_if(first, last,
                            [&, p = order.particle[i]](Row j) { return index.bonded(p, order.particle[j]); });
    };
  const double skin = 0.4 * *R_max;  // a fifth of the reach: rebuilds are rare, lists stay short
  list_.emplace(radius_, skin, std::move(keep));
}

void Contacts::refresh(std::span<const PoseRow> pose, const Team& team, double way) {
  if (list_) list_->refresh(pose, team, way);
}

void Contacts::bonds_changed() {
  if (list_ && model_.contact.pairs == ContactPairs::unbonded) list_->invalidate();
}

HertzContact<double> Contacts::law(Row i, Row j) const {
  return one_law_ ? *one_law_ : contact_law(model_.contact, radius_[i], radius_[j]);
}

bool Contacts::add_loads(RowRange rows, const PoseRow* pose, LoadRow* load) const {
  if (!list_ || list_->count(rows) == 0) return false;
  Touching t;
  bool deep = false;
  if (one_law_) t.law.fill(*one_law_);
  const auto push = [&] {
    if (!one_law_)
      for (std::size_t l = 0; l < t.count; ++l) t.law[l] = law(t.i[l], t.j[l]);
    deep |= push_apart(t, pose, radius_, load);
  };
  for (std::size_t k = rows.first; k < rows.last; ++k)
    for (std::span<const Row> near = list_->of(Row{k}); !near.empty();) {
      const std::size_t some = std::min(near.size(), Touching::most - t.count);
      collect(Row{k}, near.first(some), pose, radius_, t);
      near = near.subspan(some);
      if (t.count > Touching::most / 2) push();
    }
  push();
  return deep;
}

std::vector<std::pair<Row, Row>> Contacts::deep_pairs(RowRange rows, std::span<const PoseRow> pose) const {
  std::vector<std::pair<Row, Row>> deep;
  for (std::size_t k = rows.first; k < rows.last; ++k)
    for (const Row j : list_->of(Row{k}))
      if (k < j.value && norm2(pose[j.value].r - pose[k].r) < sq(deep_part * (radius_[Row{k}] + radius_[j])))
        deep.emplace_back(Row{k}, j);
  return deep;
}

double Contacts::energy(std::span<const PoseRow> pose) const {
  double U = 0.0;
  if (!list_) return U;
  for (const Row i : radius_.ids())
    for (const Row j : list_->of(i)) {
      const double overlap = radius_[i] + radius_[j] - norm(pose[j.value].r - pose[i.value].r);
      if (i < j && overlap > 0.0) U += contact_energy(law(i, j), overlap);
    }
  return U;
}

}  // namespace vbond
