#include "vbond/dynamics/by_block.hpp"

#include <algorithm>
#include <utility>

#include "vbond/dynamics/rows.hpp"

namespace vbond {

ByBlock::ByBlock(std::vector<Entry> entries, std::size_t blocks)
    : entries_(std::move(entries)), start_(blocks + 1) {
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.row / block_rows < b.row / block_rows; });
  for (std::size_t b = 0, k = 0; b <= blocks; ++b) {
    while (k < entries_.size() && entries_[k].row < b * block_rows) ++k;
    start_[b] = k;
  }
}

}  // namespace vbond
