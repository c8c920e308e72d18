#include "vbond/observe/vtp_array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/observe/zlib_blocks.hpp"

namespace vbond {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");
static_assert(sizeof(Vec3d) == 3 * sizeof(double), "a Vec3d is written as three doubles");
static_assert(sizeof(Image) == 3 * sizeof(std::int32_t), "an Image is written as three whole numbers");

namespace {

template <class T>
std::string_view bytes_of_all(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// Throws for a number that would become infinite, or another one, without a word.
void require_fits(const std::string& name, double value, float) {
  if (std::isfinite(value) && std::abs(value) > std::numeric_limits<float>::max())
    throw IoError(
        fmt::format("frames: {:g} of array \"{}\" is too large for single precision\n"
                    "  set output.frames.precision = \"float64\" in the case",
                    value, name));
}
void require_fits(const std::string& name, std::int64_t value, std::int32_t) {
  if (value != static_cast<std::int64_t>(static_cast<std::int32_t>(value)))
    throw std::logic_error(fmt::format("{} of array {} needs 64 bits", value, name));
}

}  // namespace

VtpArray::VtpArray(std::string name, Type type, int components, std::string unit, bool compressed,
                   std::shared_ptr<Spool> spool)
    : name_(std::move(name)),
      type_(type),
      components_(components),
      unit_(std::move(unit)),
      compressed_(compressed),
      spool_(std::move(spool)) {}

const char* VtpArray::type() const {
  constexpr const char* names[] = {"Float32", "Float64", "Int32", "Int64", "UInt8"};
  return names[static_cast<std::size_t>(type_)];
}

void VtpArray::require(bool type_is_right) const {
  if (!type_is_right) throw std::logic_error("array " + name_ + " is of another type");
}

template <class Stored, class From>
void VtpArray::append_as(std::span<const From> numbers) {
  constexpr std::size_t at_once = 1 << 12;
  std::vector<Stored> some;
  for (std::size_t first = 0; first < numbers.size(); first += at_once) {
    some.clear();
    for (const From x : numbers.subspan(first, std::min(at_once, numbers.size() - first))) {
      require_fits(name_, x, Stored{});
      some.push_back(static_cast<Stored>(x));
    }
    append_bytes(bytes_of_all(std::span<const Stored>(some)));
  }
}

void VtpArray::append_bytes(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::string_view some = bytes.substr(0, zlib_block_size - last_.size());
    last_ += some;
    bytes.remove_prefix(some.size());
    if (last_.size() < zlib_block_size) return;
    blocks_.push_back(spool_->keep(compressed_ ? zlib_block(last_) : last_));
    waiting_ += blocks_.back().size;
    last_.clear();
  }
}

void VtpArray::append(std::span<const double> values) {
  require((type_ == Type::Float32 || type_ == Type::Float64) && components_ == 1);
  type_ == Type::Float32 ? append_as<float>(values) : append_bytes(bytes_of_all(values));
  values_ += values.size();
}

void VtpArray::append(std::span<const Vec3d> values) {
  require((type_ == Type::Float32 || type_ == Type::Float64) && components_ == 3);
  const std::span numbers(reinterpret_cast<const double*>(values.data()), 3 * values.size());
  type_ == Type::Float32 ? append_as<float>(numbers) : append_bytes(bytes_of_all(numbers));
  values_ += values.size();
}

void VtpArray::append(std::span<const std::int64_t> values) {
  require((type_ == Type::Int32 || type_ == Type::Int64) && components_ == 1);
  type_ == Type::Int32 ? append_as<std::int32_t>(values) : append_bytes(bytes_of_all(values));
  values_ += values.size();
}

void VtpArray::append(std::span<const std::uint8_t> values) {
  require(type_ == Type::UInt8 && components_ == 1);
  append_bytes(bytes_of_all(values));
  values_ += values.size();
}

void VtpArray::append(std::span<const Image> values) {
  require(type_ == Type::Int32 && components_ == 3);
  append_bytes(bytes_of_all(values));
  values_ += values.size();
}

VtpArray::Ends VtpArray::ends() const {
  if (!compressed_) {
    const std::uint64_t size = waiting_ + last_.size();
    return {std::string(bytes_of_all(std::span(&size, 1))), last_};
  }
  ZlibHead head{blocks_.size(), zlib_block_size, last_.size(), {}};
  for (const Spool::Piece& block : blocks_) head.compressed.push_back(block.size);
  std::string tail;
  if (!last_.empty()) {
    tail = zlib_block(last_);
    ++head.blocks;
    head.compressed.push_back(tail.size());
  }
  return {bytes_of(head), std::move(tail)};
}

void VtpArray::write(const Ends& ends, Replacement& to) const {
  to.write(ends.head);
  for (const Spool::Piece& block : blocks_) spool_->copy(block, to);
  to.write(ends.tail);
}

}  // namespace vbond
