#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "campaigns/dice.hpp"
#include "vbond/packing/sizes.hpp"

namespace vbond::packing::sizes_test {
namespace {

double volume(double R) {
  return 4.0 / 3.0 * std::numbers::pi * R * R * R;
}

/// Sums over many small steps of the distribution, without its closed forms.
double mean_volume_by_steps(const Sizes& s) {
  double sum = 0.0;
  constexpr int steps = 200'000;
  for (int k = 0; k < steps; ++k) {
    const double a = s.least() + (s.largest() - s.least()) * k / steps,
                 b = s.least() + (s.largest() - s.least()) * (k + 1) / steps;
    sum += (s.number_below(b) - s.number_below(a)) * volume(0.5 * (a + b));
  }
  return sum;
}

TEST(Sizes, MeanVolumeIsTheSumOverTheDistribution) {
  for (const SizeLaw& law : {SizeLaw(UniformSizes{0.5, 2}), SizeLaw(NormalSizes{1, 0.3, 0.4, 1.9}),
                             SizeLaw(LognormalSizes{1, 0.4, 0.3, 3}),
                             SizeLaw(TableSizes{{{0.5, 0}, {1, 0.2}, {1.2, 0.9}, {3, 1}}, false}),
                             SizeLaw(TableSizes{{{0.5, 0}, {1, 0.2}, {1.2, 0.9}, {3, 1}}, true})}) {
    const Sizes s(law);
    // midpoints of 200,000 steps: their square times the curvature of R^3, some 1e-9
    EXPECT_NEAR(mean_volume_by_steps(s) / s.mean_volume(), 1.0, 1e-7) << law.index();
    EXPECT_NEAR(s.number_below(s.quantile(0.37)), 0.37, 1e-12);
  }
}

TEST(Sizes, CurvesComeOutAsTheyWentIn) {
  // as many as leave no grain of these curves more than a thousandth of the mass
  constexpr std::size_t grains = 50'000;
  vbond::testing::Dice dice(41);
  for (int curve = 0; curve < 10; ++curve) {  // random sieve curves
    TableSizes t{{{dice.ratio(0.2, 1), 0.0}}, true};
    const std::size_t sieves = dice.count(2, 6);
    for (std::size_t k = 0; k < sieves; ++k)
      t.points.emplace_back(
          t.points.back().first * dice.ratio(1.1, 1.6),
          k + 1 == sieves ? 1.0 : t.points.back().second + dice(0.0, (1.0 - t.points.back().second)));
    const Sizes s{SizeLaw(t)};
    const std::vector<double> radii = s.radii(grains);
    EXPECT_TRUE(std::is_sorted(radii.begin(), radii.end()));
    // the same by the definition, at the sieves and between them
    double all = 0.0;
    for (const double R : radii) all += volume(R);
    for (std::size_t k = 0; k < t.points.size(); ++k) {
      double passing = 0.0;
      for (const double R : radii) passing += R <= t.points[k].first ? volume(R) : 0.0;
      EXPECT_NEAR(passing / all, t.points[k].second, 0.01) << "curve " << curve << ", sieve " << k;
    }
    EXPECT_LT(s.distance(radii), 0.01) << "curve " << curve;
    EXPECT_NEAR(all / static_cast<double>(grains) / s.mean_volume(), 1.0, 1e-9);
  }
}

TEST(Sizes, MediansByMassAndByNumberKeepHatchAndChoatesRatio) {
  const double spread = 0.25;
  const Sizes s{SizeLaw(LognormalSizes{1, spread, std::exp(-7 * spread), std::exp(9 * spread)})};
  EXPECT_NEAR(s.quantile(0.5), 1.0, 1e-6);
  EXPECT_NEAR(s.volume_below(std::exp(3.0 * spread * spread)), 0.5, 1e-6);  // D_mass = D_number exp(3 s^2)
}

TEST(Sizes, WrongOnesAreRefused) {
  EXPECT_THROW(Sizes(EqualSizes{0}), std::invalid_argument);
  EXPECT_THROW(Sizes(UniformSizes{2, 1}), std::invalid_argument);
  EXPECT_THROW(Sizes(NormalSizes{1, 0, 0.5, 2}), std::invalid_argument);
  EXPECT_THROW(Sizes(LognormalSizes{1, 0.2, 0, 2}), std::invalid_argument);
  EXPECT_THROW(Sizes(TableSizes{{{1, 0}, {2, 0.5}}, true}), std::invalid_argument);
  EXPECT_THROW(Sizes(TableSizes{{{1, 0}, {0.9, 0.5}, {2, 1}}, true}), std::invalid_argument);
}

}  // namespace
}  // namespace vbond::packing::sizes_test
