#pragma once
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace vbond {

/// Which numbers from 0 on are taken, in stretches of consecutive ones: each where there is room first.
class Slots {
 public:
  /// The first of a stretch of this length.
  std::size_t take(std::size_t count) {
    const auto room =
        std::find_if(free_.begin(), free_.end(), [count](const Stretch& s) { return s.count >= count; });
    if (room == free_.end()) return std::exchange(size_, size_ + count);
    const std::size_t first = room->first;
    room->first += count, room->count -= count;
    if (room->count == 0) free_.erase(room);
    return first;
  }
  /// What take() gave.
  void give_back(std::size_t first, std::size_t count) {
    if (count == 0) return;
    auto at = std::lower_bound(free_.begin(), free_.end(), first,
                               [](const Stretch& s, std::size_t f) { return s.first < f; });
    at = free_.insert(at, {first, count});
    if (const auto next = at + 1; next != free_.end() && next->first == at->first + at->count) {
      at->count += next->count;
      at = free_.erase(next) - 1;
    }
    if (at == free_.begin()) return;
    if (const auto before = at - 1; before->first + before->count == at->first) {
      before->count += at->count;
      free_.erase(at);
    }
  }
  /// All that were ever taken are less than this.
  std::size_t size() const { return size_; }

 private:
  struct Stretch {
    std::size_t first, count;
  };
  std::size_t size_ = 0;
  std::vector<Stretch> free_;  // in order, no two of them side by side
};

}  // namespace vbond
