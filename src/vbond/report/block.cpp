#include "vbond/report/block.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "vbond/core/error.hpp"

namespace vbond::page {

static_assert(std::endian::native == std::endian::little, "f32 and u32 are written as they lie in memory");

void Span::add(double x) {
  if (!(std::abs(x) <= largest_shown))
    throw std::domain_error("a number that is not finite or too large to be shown");
  low = any ? std::min(low, x) : x;
  high = any ? std::max(high, x) : x;
  any = true;
}

Range range_of(const Span& span, double levels, bool is_signed) {
  if (!is_signed) return {span.low, (span.high - span.low) / levels};
  const double most = std::max(std::abs(span.low), std::abs(span.high));
  const double half = std::floor(levels / 2.0);
  return {-most, most / half};
}

std::uint16_t quantised(const Range& range, double x) {
  return range.step > 0.0 ? static_cast<std::uint16_t>(std::lround((x - range.low) / range.step)) : 0;
}

PackedArray Block::begin(const char* type, std::size_t count) {
  bytes_.resize((bytes_.size() + 3) / 4 * 4);
  PackedArray a;
  a.offset = bytes_.size();
  a.type = type;
  a.count = count;
  return a;
}

PackedArray Block::add(const std::vector<std::uint8_t>& q, const Range& range, std::size_t delta) {
  PackedArray a = begin("u8", q.size());
  a.low = {range.low};
  a.step = {range.step};
  a.delta = delta;
  bytes_.reserve(bytes_.size() + q.size());
  for (std::size_t k = 0; k < q.size(); ++k)
    bytes_.push_back(static_cast<char>(delta == 0 || k < delta ? q[k] : q[k] - q[k - delta]));
  return a;
}

PackedArray Block::add(const std::vector<std::uint16_t>& q, std::span<const Range> ranges,
                       std::size_t delta) {
  PackedArray a = begin("u16", q.size());
  for (const Range& range : ranges) a.low.push_back(range.low), a.step.push_back(range.step);
  a.delta = delta;
  bytes_.resize(a.offset + 2 * q.size());
  for (std::size_t k = 0; k < q.size(); ++k) {
    const unsigned d = delta == 0 || k < delta ? q[k] : static_cast<unsigned>(q[k] - q[k - delta]);
    bytes_[a.offset + k] = static_cast<char>(d & 0xffU);
    bytes_[a.offset + q.size() + k] = static_cast<char>(d >> 8U & 0xffU);
  }
  return a;
}

PackedArray Block::add(const std::vector<float>& values) {
  PackedArray a = begin("f32", values.size());
  bytes_.append(reinterpret_cast<const char*>(values.data()), 4 * values.size());
  return a;
}

PackedArray Block::add(const std::vector<std::uint32_t>& values) {
  PackedArray a = begin("u32", values.size());
  bytes_.append(reinterpret_cast<const char*>(values.data()), 4 * values.size());
  return a;
}

std::string gzip(const std::string& bytes) {
  constexpr int window_of_gzip = 15 + 16;  // zlib.h: 16 asks for gzip's head and tail
  z_stream z{};
  if (deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, window_of_gzip, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib cannot begin");
  std::string packed;
  std::string chunk(1 << 20, '\0');
  std::size_t at = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    if (z.avail_in == 0 && at < bytes.size()) {
      const std::size_t n = std::min<std::size_t>(bytes.size() - at, 1 << 30);  // avail_in has 32 bits
      z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + at));
      z.avail_in = static_cast<uInt>(n);
      at += n;
    }
    z.next_out = reinterpret_cast<Bytef*>(chunk.data());
    z.avail_out = static_cast<uInt>(chunk.size());
    status = deflate(&z, at == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    packed.append(chunk.data(), chunk.size() - z.avail_out);
  }
  deflateEnd(&z);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib cannot compress");
  return packed;
}

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  const auto byte = [&](std::size_t k) -> unsigned {
    return k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0U;
  };
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const unsigned three = byte(k) << 16U | byte(k + 1) << 8U | byte(k + 2);
    text += digits[three >> 18U & 63U];
    text += digits[three >> 12U & 63U];
    text += k + 1 < bytes.size() ? digits[three >> 6U & 63U] : '=';
    text += k + 2 < bytes.size() ? digits[three & 63U] : '=';
  }
  return text;
}

float as_float(double x, const std::filesystem::path& file) {
  if (!(std::abs(x) <= std::numeric_limits<float>::max()))
    throw IoError(file.string() + ": holds a number that is not finite or too large to be shown");
  return static_cast<float>(x);
}

}  // namespace vbond::page
