#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Bytes in blocks as vtkZLibDataCompressor has them: three numbers (blocks, bytes of a block, bytes of a
/// last block that is not full, else 0), the compressed size of each block, then the blocks, each a zlib
/// stream. Numbers are UInt64, little-endian.
namespace vbond {

/// Bytes of a block before it is compressed: a multiple of every number's size.
inline constexpr std::size_t zlib_block_size = 1 << 18;

/// One block. If its beginning hardly shrinks, as that of numbers that differ in all digits, it is stored as
/// it is (deflate's stored blocks): to compress it would take 50 times as long.
std::string zlib_block(std::string_view bytes);

/// The numbers before the blocks.
struct ZlibHead {
  std::uint64_t blocks = 0, block_size = 0, last_size = 0;
  std::vector<std::uint64_t> compressed;  ///< of each block
  static constexpr std::size_t fixed = 3 * sizeof(std::uint64_t);
  /// Bytes of the head with the sizes of its blocks.
  std::uint64_t head_size() const { return fixed + blocks * sizeof(std::uint64_t); }
  /// Bytes of the k-th block when it is not compressed.
  std::uint64_t size_of(std::uint64_t k) const {
    return k + 1 == blocks && last_size > 0 ? last_size : block_size;
  }
};

/// These numbers as they stand in a file.
std::string bytes_of(const ZlibHead& head);

/// Whether the first three numbers can be those of so many bytes in all, which take `in_file` bytes
/// compressed.
bool fits(const ZlibHead& head, std::uint64_t bytes, std::uint64_t in_file);

/// Writes the content of one block to `to`, which has room for `size` bytes. False if it does not have
/// exactly so many, or is no zlib stream.
bool inflate_block(std::string_view block, char* to, std::size_t size);

}  // namespace vbond
