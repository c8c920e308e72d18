#include "vbond/observe/zlib_blocks.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <new>

namespace vbond {
namespace {

constexpr std::size_t block_size = 1 << 18;   // a multiple of every number's size
constexpr std::size_t sample_size = 1 << 13;  // 3 % of the time that the whole block would take
constexpr int fast = 1, uncompressed = 0;     // levels of deflate

std::size_t deflated(std::string_view bytes, int level, std::string& to) {
  uLongf size = compressBound(bytes.size());
  to.resize(size);
  const auto* from = reinterpret_cast<const Bytef*>(bytes.data());
  // the room is enough, so only memory can be missing
  if (compress2(reinterpret_cast<Bytef*>(to.data()), &size, from, bytes.size(), level) != Z_OK)
    throw std::bad_alloc();
  to.resize(size);
  return size;
}

/// Whether at least a fifth is saved.
bool is_worth_it(std::string_view block, std::string& scratch) {
  const std::string_view sample = block.substr(0, sample_size);
  return deflated(sample, fast, scratch) < sample.size() - sample.size() / 5;
}

void put(std::uint64_t x, std::string& to, std::size_t at) {
  std::memcpy(to.data() + at, &x, sizeof x);
}

}  // namespace

std::string in_zlib_blocks(std::string_view bytes) {
  const std::uint64_t blocks = (bytes.size() + block_size - 1) / block_size;
  const ZlibHead head{blocks, block_size, bytes.size() % block_size, {}};
  std::string out(head.head_size(), '\0'), block;
  put(head.blocks, out, 0);
  put(head.block_size, out, sizeof(std::uint64_t));
  put(head.last_size, out, 2 * sizeof(std::uint64_t));
  for (std::uint64_t k = 0; k < blocks; ++k) {
    const std::string_view part = bytes.substr(k * block_size, block_size);
    const int level = is_worth_it(part, block) ? fast : uncompressed;
    put(deflated(part, level, block), out, ZlibHead::fixed + k * sizeof(std::uint64_t));
    out += block;
  }
  return out;
}

bool fits(const ZlibHead& head, std::uint64_t bytes, std::uint64_t in_file) {
  if (bytes == 0) return head.blocks == 0;
  return head.block_size > 0 && head.blocks == (bytes - 1) / head.block_size + 1 &&
         head.last_size == bytes % head.block_size && head.blocks <= in_file / sizeof(std::uint64_t) &&
         head.head_size() <= in_file;
}

bool inflate_block(std::string_view block, char* to, std::size_t size) {
  uLongf room = size, used = block.size();
  const auto* from = reinterpret_cast<const Bytef*>(block.data());
  return uncompress2(reinterpret_cast<Bytef*>(to), &room, from, &used) == Z_OK && room == size &&
         used == block.size();
}

}  // namespace vbond
