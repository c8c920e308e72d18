#include "vbond/observe/spool.hpp"

#include <algorithm>
#include <array>

#include "vbond/core/error.hpp"

namespace vbond {

Spool::Piece Spool::keep(std::string_view bytes) {
  if (beside_.empty() || (!file_ && memory_.size() + bytes.size() <= in_memory)) {
    const Piece piece{false, memory_.size(), bytes.size()};
    memory_ += bytes;
    return piece;
  }
  if (!file_) file_ = nameless_file(beside_);
  const Piece piece{true, file_size_, bytes.size()};
  write_all(file_.get(), bytes, beside_);
  file_size_ += bytes.size();
  return piece;
}

void Spool::copy(const Piece& piece, Replacement& to) const {
  if (!piece.in_file) return to.write(std::string_view(memory_).substr(piece.at, piece.size));
  std::array<char, 1 << 16> block{};
  for (std::uint64_t done = 0; done < piece.size;) {
    const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), piece.size - done));
    read_at(file_.get(), piece.at + done, block.data(), size, beside_);
    to.write({block.data(), size});
    done += size;
  }
}

}  // namespace vbond
