#include "vbond/core/communicator.hpp"

#include <cstring>

namespace vbond {

void Communicator::gather_bytes(std::span<const std::byte> mine, const Room& room) const {
  std::byte* const all = room(mine.size());
  if (!mine.empty()) std::memcpy(all, mine.data(), mine.size());
}

std::vector<std::size_t> Communicator::swap_bytes(std::span<const std::byte> mine,
                                                  const std::vector<std::size_t>& sizes,
                                                  const Room& room) const {
  gather_bytes(mine, room);
  return sizes;
}

const Communicator& alone() {
  static const Communicator one;
  return one;
}

}  // namespace vbond
