#include "vbond/dynamics/bond_index.hpp"

#include <algorithm>
#include <numeric>

#include "vbond/model/capsules.hpp"

namespace vbond {

BondIndex::BondIndex(const Order& order, const PerBond<Bond>& bonds)
    : start_(order.row.size() + 1, 0), of_fibre_(particles_of_fibres(order.row.size(), bonds)) {
  const auto is_left_out = [&order](const Bond& b) {
    return b.broken || !(order.knows(b.i) || order.knows(b.j));
  };
  for (const Bond& b : bonds) {
    if (is_left_out(b)) continue;
    ++start_[b.i.value + 1];
    ++start_[b.j.value + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  entries_.resize(start_.back());
  end_.assign(start_.begin(), start_.end() - 1);
  for (const BondId b : bonds.ids()) {
    const Bond& bond = bonds[b];
    if (is_left_out(bond)) continue;
    entries_[end_[bond.i.value]++] = {b, bond.j, true, bond.image_j};
    entries_[end_[bond.j.value]++] = {b, bond.i, false, -bond.image_j};
  }
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
