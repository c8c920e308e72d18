#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vbond {

/// The instants of a step at which velocities and loads are asked for.
enum class Instant : std::uint8_t { start, middle, end };

/// Particles of supports or loads, block by block.
class ByBlock {
 public:
  struct Entry {
    std::size_t row;
    std::size_t index;  ///< of what holds or loads it
  };
  ByBlock() = default;
  ByBlock(std::vector<Entry> entries, std::size_t blocks);
  const Entry* begin_of(std::size_t block) const { return entries_.data() + start_[block]; }
  const Entry* end_of(std::size_t block) const { return entries_.data() + start_[block + 1]; }
  bool empty() const { return entries_.empty(); }

 private:
  std::vector<Entry> entries_;
  std::vector<std::size_t> start_;
};

}  // namespace vbond
