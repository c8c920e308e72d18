#include "vbond/dynamics/bond_index.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "vbond/model/capsules.hpp"

namespace vbond {

BondIndex::BondIndex(const Order& order, const PerBond<Bond>& bonds, const PartBonds& of_part)
    : of_fibre_(particles_of_fibres(order.row.size(), bonds)) {
  const auto for_known = [&](const auto& visit) {
    for (const BondId k : bonds.ids())
      if (const Bond& b = bonds[k]; !b.broken && (order.knows(b.i) || order.knows(b.j)))
        visit(of_part.name(k), b.i, b.j, image_of_j(b));
    for (const BondEnds& b : of_part.others) visit(b.name, b.i, b.j, b.image_j);
  };
  std::size_t places = order.row.size();
  if (of_part.own_alone) {
    const auto some =
        std::make_shared<IdSet<ParticleId>>(IdSet<ParticleId>::of(places, [&for_known](const auto& add) {
          for_known([&add](BondId, ParticleId i, ParticleId j, const Image&) { add(i), add(j); });
        }));
    places = some->size();
    ends_ = some;
  }
  if (bonds.size() + of_part.others.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw std::length_error("more bonds than a process can look up");
  start_.assign(places + 1, 0);
  bool any_image = false;
  for_known([&](BondId, ParticleId i, ParticleId j, const Image& image_j) {
    ++start_[place(i) + 1];
    ++start_[place(j) + 1];
    any_image |= !image_j.is_itself();
  });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  kept_.resize(start_.back());
  if (any_image) of_other_.resize(start_.back());
  end_.assign(start_.begin(), start_.end() - 1);
  const auto add = [this](ParticleId p, BondId name, bool is_i, ParticleId other, const Image& of_other) {
    const std::size_t at = end_[place(p)]++;
    kept_[at] = {name, is_i ? 1u : 0u, other.value & 0x7fffffffu};
    if (!of_other_.empty()) of_other_[at] = of_other;
  };
  for_known([&add](BondId name, ParticleId i, ParticleId j, const Image& image_j) {
    add(i, name, true, j, image_j);
    add(j, name, false, i, -image_j);
  });
}

void BondIndex::remove(BondId bond, ParticleId i, ParticleId j) {
  for (const ParticleId p : {i, j}) {
    if (ends_ && !ends_->has(p)) continue;
    const std::size_t k = place(p);
    std::size_t at = start_[k];
    while (at != end_[k] && kept_[at].bond != bond) ++at;
    if (at == end_[k]) continue;
    --end_[k];
    for (; at != end_[k]; ++at) {
      kept_[at] = kept_[at + 1];
      if (!of_other_.empty()) of_other_[at] = of_other_[at + 1];
    }
  }
}

}  // namespace vbond
