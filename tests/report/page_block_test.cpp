#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "page_reader.hpp"
#include "vbond/report/block.hpp"

namespace vbond::page {
namespace {

using test::base64_decoded;
using test::gunzipped;
using test::unpacked;

std::vector<double> waves(std::size_t n) {
  std::vector<double> x;
  for (std::size_t k = 0; k < n; ++k) x.push_back(3.0 * std::sin(0.7 * static_cast<double>(k)) - 1.0);
  return x;
}

Span span_of(const std::vector<double>& values) {
  Span s;
  for (const double x : values) s.add(x);
  return s;
}

TEST(PageBlock, BytesComeBackWithinHalfAStep) {
  const std::vector<double> x = waves(100);
  const Range range = range_of(span_of(x), 255, false);
  std::vector<std::uint8_t> q;
  for (const double v : x) q.push_back(static_cast<std::uint8_t>(quantised(range, v)));
  Block block;
  const PackedArray a = block.add(q, range, 25);
  const std::vector<double> back = unpacked(block.bytes(), a);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(back[k], x[k], 0.5000001 * range.step) << k;
  EXPECT_NEAR(range.step, 6.0 / 255.0, 1e-3);  // the sine comes close to 1 and -1
}

TEST(PageBlock, WordsComeBackWithinHalfAStepOfTheirComponent) {
  const std::vector<double> x = waves(90);  // 5 frames of 6 particles
  std::array<Range, 3> ranges;
  for (std::size_t c = 0; c < 3; ++c) {
    Span s;
    for (std::size_t k = 0; k < x.size(); ++k)
      if (k / 6 % 3 == c) s.add(x[k]);
    ranges[c] = range_of(s, 65535, false);
  }
  std::vector<std::uint16_t> q;
  for (std::size_t k = 0; k < x.size(); ++k) q.push_back(quantised(ranges[k / 6 % 3], x[k]));
  Block block;
  block.add(std::vector<std::uint8_t>{1, 2, 3}, {0, 1}, 0);  // what comes next does not begin at 0
  const PackedArray a = block.add(q, ranges, 18);
  EXPECT_EQ(a.offset % 4, 0U);
  const std::vector<double> back = unpacked(block.bytes(), a);
  for (std::size_t k = 0; k < x.size(); ++k)
    EXPECT_NEAR(back[k], x[k], 0.5000001 * ranges[k / 6 % 3].step) << k;
}

TEST(PageBlock, FramesThatDoNotChangeAreZeros) {
  const std::vector<std::uint16_t> q{700, 65535, 700, 65535};
  Block block;
  block.add(q, {{{0, 1}, {0, 1}, {0, 1}}}, 2);
  // low bytes of frame 0, of frame 1, then high bytes
  EXPECT_EQ(block.bytes(), std::string("\xbc\xff\0\0\x02\xff\0\0", 8));
}

TEST(PageBlock, ZeroOfASignedFieldIsExact) {
  const Range range = range_of(span_of({-0.3, 1.0}), 255, true);
  EXPECT_EQ(range.low + range.step * quantised(range, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(range.low + range.step * quantised(range, 1.0), 1.0);
}

TEST(PageBlock, AConstantFieldHasNoStep) {
  const Range range = range_of(span_of({2.5, 2.5}), 255, false);
  EXPECT_EQ(range.low, 2.5);
  EXPECT_EQ(range.step, 0.0);
  EXPECT_EQ(quantised(range, 2.5), 0);
}

TEST(PageBlock, NumbersThatAreNotFiniteAreRefused) {
  Span s;
  EXPECT_THROW(s.add(std::numeric_limits<double>::quiet_NaN()), std::domain_error);
}

TEST(PageBlock, GzipAndBase64GiveBackEveryLength) {
  for (const std::size_t n : {0, 1, 2, 3, 1000, 3'000'001}) {
    std::string bytes;
    for (std::size_t k = 0; k < n; ++k) bytes += static_cast<char>(k * k / 7 % 251);
    EXPECT_EQ(gunzipped(base64_decoded(base64(gzip(bytes)))), bytes) << n;
  }
  EXPECT_EQ(base64("any carnal pleas"), "YW55IGNhcm5hbCBwbGVhcw==");
}

}  // namespace
}  // namespace vbond::page
