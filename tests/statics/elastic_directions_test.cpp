// Moduli by direction: the least and the largest over what lies across.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "campaigns/dice.hpp"
#include "crystals.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/statics/elastic_constants.hpp"

namespace vbond::elastic_directions_test {
namespace {

using testing::cubic;

/// A^T A of random numbers, and a tenth of the unit: eigenvalues from 0.1 to some 10.
Constants positive_definite(testing::Dice& dice) {
  Constants A{}, C{};
  for (auto& row : A)
    for (double& x : row) x = dice(-1.0, 1.0);
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      C[i][j] = i == j ? 0.1 : 0.0;
      for (std::size_t k = 0; k < 6; ++k) C[i][j] += A[k][i] * A[k][j];
    }
  return C;
}

/// The least and the largest of f over `count` directions across n, which end the half turn that repeats.
template <class F>
std::pair<double, double> among(int count, const Vec3d& n, const F& f) {
  const Vec3d a = normalised(across(std::abs(n.z) < 0.8 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0}, n)),
              b = cross(n, a);
  double least = HUGE_VAL, largest = -HUGE_VAL;
  for (int k = 0; k < count; ++k) {
    const double t = std::numbers::pi * k / count, value = f(std::cos(t) * a + std::sin(t) * b);
    least = std::min(least, value), largest = std::max(largest, value);
  }
  return {least, largest};
}

// Among 2000 directions one is within h = pi/4000 of the extreme of a + r cos 2t, and its value within
// r (1 - cos 2h) < 2 r h^2 = 1.3e-6 r; r is half of what the least and the largest are apart.
TEST(DirectionalExtremes, AreThoseAmongManyDirections) {
  testing::Dice dice(11);
  for (int k = 0; k < 50; ++k) {
    const ElasticConstants C(positive_definite(dice));
    const Vec3d n = dice.direction();
    const auto shear = [&](const Vec3d& m) { return 1.0 / C.shear_modulus(n, m); };
    const auto thins = [&](const Vec3d& m) { return C.poissons_ratio(n, m); };
    const Extremes G = C.shear_moduli(2.0 * n), nu = C.poissons_ratios(-n);
    const auto expect = [](double value, double found, double apart) {
      EXPECT_NEAR(value, found, 0.65e-6 * apart + 1e-12 * (1.0 + std::abs(value)));
    };
    const auto [stiff, soft] = among(2000, n, shear);
    expect(1.0 / G.largest.value, stiff, soft - stiff);
    expect(1.0 / G.least.value, soft, soft - stiff);
    EXPECT_GE(G.largest.value, (1.0 - 1e-12) / stiff);
    const auto [least, largest] = among(2000, n, thins);
    expect(nu.least.value, least, largest - least);
    expect(nu.largest.value, largest, largest - least);
    EXPECT_LE(nu.least.value, least + 1e-12 * (1.0 + std::abs(least)));
    for (const Directed& m : {G.least, G.largest, nu.least, nu.largest}) {
      EXPECT_NEAR(norm(m.along), 1.0, 1e-14);
      EXPECT_NEAR(dot(m.along, n), 0.0, 1e-14);
    }
    EXPECT_NEAR(1.0 / G.least.value, shear(G.least.along), 1e-12 / G.least.value);
    EXPECT_NEAR(nu.largest.value, thins(nu.largest.along), 1e-12 * (1.0 + std::abs(nu.largest.value)));
  }
}

// Copper. Along a face and along a body diagonal all directions across are alike; along 110 they are not
// (Nye, Physical Properties of Crystals; Baughman et al., Nature 392 (1998) 362, for the negative ratio).
TEST(DirectionalExtremes, OfACubicCrystalAreItsClosedForms) {
  const double C11 = 168.4, C12 = 121.4, C44 = 75.4;
  const ElasticConstants C(cubic(C11, C12, C44));
  const double d = (C11 - C12) * (C11 + 2 * C12), S11 = (C11 + C12) / d, S12 = -C12 / d, S44 = 1 / C44;

  EXPECT_NEAR(C.youngs_modulus({1, 0, 0}), 1 / S11, 1e-11);
  EXPECT_NEAR(C.youngs_modulus({1, 1, 0}), 4 / (2 * S11 + 2 * S12 + S44), 1e-11);
  EXPECT_NEAR(C.youngs_modulus({1, 1, 1}), 3 / (S11 + 2 * S12 + S44), 1e-11);

  for (const Vec3d& face : {Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}}) {
    const Extremes G = C.shear_moduli(face), nu = C.poissons_ratios(face);
    EXPECT_NEAR(G.least.value, C44, 1e-11);
    EXPECT_NEAR(G.largest.value, C44, 1e-11);
    EXPECT_NEAR(nu.least.value, -S12 / S11, 1e-13);
    EXPECT_NEAR(nu.largest.value, -S12 / S11, 1e-13);
  }
  const Extremes G = C.shear_moduli({1, 1, 0}), nu = C.poissons_ratios({1, 1, 0});
  const double three = 2 * S11 + 2 * S12 + S44;
  EXPECT_NEAR(G.least.value, (C11 - C12) / 2, 1e-11);
  EXPECT_NEAR(G.largest.value, C44, 1e-11);
  EXPECT_NEAR(std::abs(G.largest.along.z), 1, 1e-12);
  EXPECT_NEAR(nu.least.value, -(2 * S11 + 2 * S12 - S44) / three, 1e-13);
  EXPECT_LT(nu.least.value, -0.1);
  EXPECT_NEAR(nu.largest.value, -4 * S12 / three, 1e-13);
  EXPECT_NEAR(std::abs(nu.largest.along.z), 1, 1e-12);

  const Extremes diagonal = C.shear_moduli({1, 1, 1}), thins = C.poissons_ratios({1, 1, 1});
  EXPECT_NEAR(diagonal.least.value, 3 / (4 * S11 - 4 * S12 + S44), 1e-11);
  EXPECT_NEAR(diagonal.largest.value, diagonal.least.value, 1e-11);
  EXPECT_NEAR(thins.least.value, -(2 * S11 + 4 * S12 - S44) / (2 * (S11 + 2 * S12 + S44)), 1e-13);
  EXPECT_NEAR(thins.largest.value, thins.least.value, 1e-13);
}

TEST(DirectionalExtremes, OfAnIsotropicMaterialAreAllTheSame) {
  const double K = 50, shear = 30;
  const ElasticConstants C(cubic(K + 4 * shear / 3, K - 2 * shear / 3, shear));
  testing::Dice dice(3);
  for (int k = 0; k < 100; ++k) {
    const Vec3d n = dice.direction();
    const Extremes G = C.shear_moduli(n), nu = C.poissons_ratios(n);
    EXPECT_NEAR(C.youngs_modulus(n), 75, 1e-12);
    EXPECT_NEAR(G.least.value, 30, 1e-12);
    EXPECT_NEAR(G.largest.value, 30, 1e-12);
    EXPECT_NEAR(nu.least.value, 0.25, 1e-14);
    EXPECT_NEAR(nu.largest.value, 0.25, 1e-14);
  }
}

TEST(DirectionalExtremes, NeedADirection) {
  const ElasticConstants C(cubic(3, 1, 1));
  EXPECT_THROW((void)C.shear_moduli({0, 0, 0}), std::invalid_argument);
  EXPECT_THROW((void)C.poissons_ratios({NAN, 0, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace vbond::elastic_directions_test
