#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "vbond/core/pack.hpp"
#include "vbond/core/scalar.hpp"

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

TYPED_TEST(PackOf, TransposesASquare) {
  constexpr std::size_t W = sizeof(TypeParam) / sizeof(double);
  std::array<TypeParam, W> square;
  for (std::size_t k = 0; k < W; ++k) {
    std::array<double, W> row;
    for (std::size_t l = 0; l < W; ++l) row[l] = static_cast<double>(10 * k + l);
    square[k] = TypeParam::load(row.data());
  }
  transpose(square.data());
  for (std::size_t k = 0; k < W; ++k) {
    std::array<double, W> row;
    square[k].store(row.data());
    for (std::size_t l = 0; l < W; ++l) EXPECT_EQ(row[l], static_cast<double>(10 * l + k));
  }
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
    expect(TypeParam(0.1) * x, [](double p, double) { return 0.1 * p; });
  }
}

}  // namespace
}  // namespace vbond
