#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>

#include "vbond/core/scalar.hpp"
#include "vbond/core/simd.hpp"

namespace vbond {
namespace {

template <class P>
class PackOf : public ::testing::Test {};
using Packs = ::testing::Types<Pack<2>, Pack<4>, Pack<8>>;

struct WidthName {
  template <class P>
  static std::string GetName(int) {
    return std::to_string(sizeof(P) / sizeof(double));
  }
};
TYPED_TEST_SUITE(PackOf, Packs, WidthName);

std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
}

TYPED_TEST(PackOf, IsAScalar) {
  static_assert(Scalar<TypeParam>);
}

// W rows of four numbers as they come from memory, to four columns and back.
TYPED_TEST(PackOf, TransposesHalfRows) {
  constexpr std::size_t W = sizeof(TypeParam) / sizeof(double);
  const auto number = [](std::size_t row, std::size_t k) { return static_cast<double>(10 * row + k); };
  TypeParam x[4];
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<double, W> part;
    for (std::size_t l = 0; l < W; ++l)
      part[l] = W == 2 ? number(k % 2, k / 2 * 2 + l) : number(k + l / 4 * 4, l % 4);
    x[k] = TypeParam::load(part.data());
  }
  const auto rows = std::to_array(x);
  transpose_halves(x);
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<double, W> column;
    x[k].store(column.data());
    for (std::size_t l = 0; l < W; ++l) EXPECT_EQ(column[l], number(l, k));
  }
  transpose_halves(x);
  EXPECT_EQ(std::memcmp(x, rows.data(), sizeof x), 0);
}

// Every lane rounds as a double does: numbers of all sizes, zeros of both signs, subnormal and infinite ones.
TYPED_TEST(PackOf, RoundsAsDoublesDo) {
  constexpr std::size_t W = sizeof(TypeParam) / sizeof(double);
  std::mt19937_64 random(1);
  const double special[] = {0.0, -0.0, 1.0, 5e-324, 2e-308, std::numeric_limits<double>::infinity()};
  const auto number = [&] {
    if (random() % 8 == 0) return special[random() % std::size(special)];
    return std::ldexp(static_cast<double>(random() >> 11) * 0x1p-53 - 0.5,
                      static_cast<int>(random() % 200) - 100);
  };
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<double, W> a, b, got;
    for (std::size_t l = 0; l < W; ++l) a[l] = number(), b[l] = number();
    const TypeParam x = TypeParam::load(a.data()), y = TypeParam::load(b.data());
    const auto expect = [&](const TypeParam& result, auto by_double) {
      result.store(got.data());
      for (std::size_t l = 0; l < W; ++l) {
        const double e = by_double(a[l], b[l]);
        if (std::isnan(e))  // inf - inf: which NaN it is does not matter
          EXPECT_TRUE(std::isnan(got[l]));
        else
          EXPECT_EQ(bits(got[l]), bits(e)) << a[l] << " and " << b[l];
      }
    };
    expect(x + y, [](double p, double q) { return p + q; });
    expect(x - y, [](double p, double q) { return p - q; });
    expect(x * y, [](double p, double q) { return p * q; });
    expect(x / y, [](double p, double q) { return p / q; });
    expect(-x, [](double p, double) { return -p; });
    expect(sqrt(x), [](double p, double) { return std::sqrt(p); });
    expect(TypeParam(-0.0), [](double, double) { return -0.0; });
    expect(TypeParam(0.1) * x, [](double p, double) { return 0.1 * p; });
  }
}

}  // namespace
}  // namespace vbond
