#include "vbond/dynamics/bond_index.hpp"

#include <algorithm>
#include <numeric>

#include "vbond/model/capsules.hpp"

namespace vbond {

BondIndex::BondIndex(const Order& order, const PerBond<Bond>& bonds, const PartBonds& of_part)
    : start_(order.row.size() + 1, 0), of_fibre_(particles_of_fibres(order.row.size(), bonds)) {
  const auto for_known = [&](const auto& visit) {
    for (const BondId k : bonds.ids())
      if (const Bond& b = bonds[k]; !b.broken && (order.knows(b.i) || order.knows(b.j)))
        visit(of_part.name(k), b.i, b.j, b.image_j);
    for (const BondEnds& b : of_part.others) visit(b.name, b.i, b.j, b.image_j);
  };
  for_known([this](BondId, ParticleId i, ParticleId j, const Image&) {
    ++start_[i.value + 1];
    ++start_[j.value + 1];
  });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  entries_.resize(start_.back());
  end_.assign(start_.begin(), start_.end() - 1);
  for_known([this](BondId name, ParticleId i, ParticleId j, const Image& image_j) {
    entries_[end_[i.value]++] = {name, j, true, image_j};
    entries_[end_[j.value]++] = {name, i, false, -image_j};
  });
}

void BondIndex::remove(BondId bond, ParticleId i, ParticleId j) {
  for (const ParticleId p : {i, j}) {
    Entry* const last = entries_.data() + end_[p.value];
    Entry* const at = std::find_if(entries_.data() + start_[p.value], last,
                                   [bond](const Entry& e) { return e.bond == bond; });
    if (at == last) continue;
    std::move(at + 1, last, at);
    --end_[p.value];
  }
}

}  // namespace vbond
