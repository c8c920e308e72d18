#include "vbond/dynamics/bond_index.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <vector>

#include "vbond/model/capsules.hpp"

namespace vbond {

BondIndex::BondIndex(const Order& order, const PerBond<Bond>& bonds, const PartBonds& of_part)
    : of_fibre_(particles_of_fibres(order.row.size(), bonds)) {
  const auto for_known = [&](const auto& visit) {
    for (const BondId k : bonds.ids())
      if (const Bond& b = bonds[k]; !b.broken && (order.knows(b.i) || order.knows(b.j)))
        visit(of_part.name(k), b.i, b.j, b.image_j);
    for (const BondEnds& b : of_part.others) visit(b.name, b.i, b.j, b.image_j);
  };
  std::size_t places = order.row.size();
  if (of_part.own_alone) {
    std::vector<ParticleId> ends;
    for_known(
        [&ends](BondId, ParticleId i, ParticleId j, const Image&) { ends.push_back(i), ends.push_back(j); });
    const auto some = std::make_shared<IdSet<ParticleId>>(places, ends);
    places = some->size();
    ends_ = some;
  }
  start_.assign(places + 1, 0);
  for_known([this](BondId, ParticleId i, ParticleId j, const Image&) {
    ++start_[place(i) + 1];
    ++start_[place(j) + 1];
  });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  entries_.resize(start_.back());
  end_.assign(start_.begin(), start_.end() - 1);
  for_known([this](BondId name, ParticleId i, ParticleId j, const Image& image_j) {
    entries_[end_[place(i)]++] = {name, j, true, image_j};
    entries_[end_[place(j)]++] = {name, i, false, -image_j};
  });
}

void BondIndex::remove(BondId bond, ParticleId i, ParticleId j) {
  for (const ParticleId p : {i, j}) {
    if (ends_ && !ends_->has(p)) continue;
    const std::size_t k = place(p);
    Entry* const last = entries_.data() + end_[k];
    Entry* const at =
        std::find_if(entries_.data() + start_[k], last, [bond](const Entry& e) { return e.bond == bond; });
    if (at == last) continue;
    std::move(at + 1, last, at);
    --end_[k];
  }
}

}  // namespace vbond
