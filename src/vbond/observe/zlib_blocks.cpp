#include "vbond/observe/zlib_blocks.hpp"

#include <zlib.h>

#include <algorithm>
#include <new>

namespace vbond {
namespace {

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

}  // namespace

std::string zlib_block(std::string_view bytes) {
  std::string block;
  deflated(bytes, is_worth_it(bytes, block) ? fast : uncompressed, block);
  return block;
}

std::string bytes_of(const ZlibHead& head) {
  std::vector<std::uint64_t> numbers{head.blocks, head.block_size, head.last_size};
  numbers.insert(numbers.end(), head.compressed.begin(), head.compressed.end());
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(std::uint64_t)};
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
