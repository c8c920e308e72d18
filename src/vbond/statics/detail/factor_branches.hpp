#pragma once
#include <vector>

#include "vbond/statics/detail/blocked_factor.hpp"

namespace vbond {

/// Which blocks of a factor can be solved side by side: branches of the tree of elimination, where a block's
/// parent is that of its first row below. Blocks that are in no branch are the top, whose columns come after
/// those of all branches. It depends on the factor alone.
struct FactorBranches {
  struct Branch {
    int first, last;  ///< blocks; last: the one behind
    double size;      ///< entries
  };
  std::vector<Branch> branches;  ///< in the order of their blocks; none where the factor is small
  std::vector<int> top;          ///< the other blocks, in order
};

FactorBranches branches_of(const FactorBlocks& blocks);

}  // namespace vbond
