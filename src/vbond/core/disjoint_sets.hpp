#pragma once
#include <algorithm>
#include <cstddef>

#include "vbond/core/column.hpp"

namespace vbond {

/// Things joined pair by pair into sets. A set is known by its smallest member.
template <class IdType>
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) {
    for (const IdType k : parent_.ids()) parent_[k] = k;
  }
  /// The smallest member of the set that this one is in.
  IdType smallest(IdType k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void join(IdType i, IdType j) {
    const IdType a = smallest(i), b = smallest(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  Column<IdType, IdType> parent_;
};

}  // namespace vbond
