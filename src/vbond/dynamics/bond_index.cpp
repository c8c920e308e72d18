#include "vbond/dynamics/bond_index.hpp"

#include <numeric>

namespace vbond {

BondIndex::BondIndex(std::size_t particles, const PerBond<Bond>& bonds)
    : start_(particles + 1, 0), entries_(2 * bonds.size()) {
  for (const Bond& b : bonds) {
    ++start_[b.i.value + 1];
    ++start_[b.j.value + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
  for (const BondId b : bonds.ids()) {
    const Bond& bond = bonds[b];
    entries_[next[bond.i.value]++] = {b, bond.j, true};
    entries_[next[bond.j.value]++] = {b, bond.i, false};
  }
}

}  // namespace vbond
