// Laws whose bonded points are offset: what tests of all laws (gradient, invariance, tangent) do not see.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "random_law.hpp"
#include "vbond/physics/bond_step.hpp"
#include "vbond/physics/laws.hpp"
#include "vbond/physics/tangent.hpp"

namespace vbond::offsets_test {
namespace {

template <template <class> class Elastic>
using Offset = typename WithOffsets<WithRules<Elastic>::template Law>::template Law<double>;

/// The rest of a bond along x between particles that are not turned.
template <class Law>
BondPose<double> at_rest(const Law& law) {
  BondPose<double> rest =
      bond_pose(BondFrames<double>{}, Vec3d{law.a + law.R_i + law.R_j, 0, 0}, Quatd{}, Quatd{});
  if constexpr (OffsetLaw<Law>) rest.r_ij += law.offset_i(rest) - law.offset_j(rest);
  return rest;
}
template <class Law>
std::array<double, 4> offsets_of(const Law& law) {
  if constexpr (OffsetLaw<Law>)
    return {law.o_i2, law.o_i3, law.o_j2, law.o_j3};
  else
    return {};
}

// A bond from (0, 0, 0) to (1, 0, 0) between particles whose centres are 0.5 beside it, at opposite sides.
// The loads are those of a lever: a pull N along it gives each a moment of 0.5 N.
TEST(Offsets, MakeAPullALever) {
  Offset<VModel> law = Offset<VModel>::from({2.0, 1.0, 0.5, 0.3}, 1.0, 0.0, 0.0);
  law.o_i2 = -0.5, law.o_j2 = 0.5;
  BondPose<double> pose = at_rest(law);
  EXPECT_NEAR(norm(pose.r_ij - Vec3d{1, -1, 0}), 0.0, 1e-15);
  pose.r_ij.x += 0.1;
  const BondLoads<double> l = bond_loads(law, pose);
  EXPECT_NEAR(norm(l.F - Vec3d{0.2, 0, 0}), 0.0, 1e-15);
  EXPECT_NEAR(norm(l.M_ij - Vec3d{0, 0, 0.1}), 0.0, 1e-15);
  EXPECT_NEAR(norm(l.M_ji - Vec3d{0, 0, 0.1}), 0.0, 1e-15);
}

// The largest eigenvalue of M^-1 K of two particles and one bond at rest, by the power method from three
// starts: it comes from below, and the bound must lie above.
double largest_eigenvalue(const PairTangent<9>& t, const BondEnd& i, const BondEnd& j) {
  std::array<std::array<double, 12>, 12> K{};  // of r_i, turn of i, r_j, turn of j
  const auto minus = [](std::size_t k) { return k < 3 ? -1.0 : 1.0; };
  for (std::size_t row = 0; row < 9; ++row)
    for (std::size_t k = 0; k < 9; ++k) {
      const double d = t.d[row][k];  // loads F, M_ij, M_ji by r_ij and turns of i and j
      const std::size_t load_i = row < 6 ? row : 12, turn = k < 6 ? k : k + 3;
      const auto add = [&](std::size_t load, double sign) {
        if (k < 3)
          K[load][k] += sign * minus(k) * d, K[load][k + 6] += sign * d;
        else
          K[load][turn] += sign * d;
      };
      if (load_i < 12) add(load_i, -1.0);
      if (row < 3) add(row + 6, 1.0);
      if (row >= 6) add(row + 3, -1.0);
    }
  const auto inertia = [&](std::size_t k) { return k < 3 ? i.m : k < 6 ? i.Theta : k < 9 ? j.m : j.Theta; };
  double largest = 0.0;
  for (const double start : {1.0, 0.7, -0.4}) {
    std::array<double, 12> x{}, y{};
    for (std::size_t k = 0; k < 12; ++k) x[k] = std::cos(start * static_cast<double>(k * k + 1));
    for (int n = 0; n < 2000; ++n) {
      double size = 0.0;
      for (std::size_t row = 0; row < 12; ++row) {
        y[row] = 0.0;
        for (std::size_t k = 0; k < 12; ++k) y[row] += K[row][k] * x[k] / inertia(row);
        size = std::max(size, std::abs(y[row]));
      }
      double along = 0.0, all = 0.0;
      for (std::size_t k = 0; k < 12; ++k) along += inertia(k) * x[k] * y[k], all += inertia(k) * x[k] * x[k];
      largest = std::max(largest, along / all);
      for (std::size_t k = 0; k < 12; ++k) x[k] = y[k] / size;
    }
  }
  return largest;
}

template <template <class> class Elastic>
void expect_bound() {
  testing::PoseSource random(77);
  double loosest = 0.0;
  for (int trial = 0; trial < 300; ++trial) {
    Offset<Elastic> law = testing::random_law<Offset<Elastic>>(random);
    law.rules = &no_rules;
    const auto end = [&](double R, double o_2, double o_3) {
      return BondEnd{1.0, random.uniform(0.2, 2.0), random.uniform(0.02, 1.0), R + 0.5 * law.a, o_2, o_3};
    };
    const BondEnd i = end(law.R_i, law.o_i2, law.o_i3), j = end(law.R_j, law.o_j2, law.o_j3);
    const double bound = element_bound(stiffness(law), i, j);
    const double exact = largest_eigenvalue(bond_tangent(law, at_rest(law)), i, j);
    EXPECT_GE(bound, (1.0 - 1e-12) * exact) << trial;
    loosest = std::max(loosest, bound / exact);
  }
  EXPECT_LT(loosest, 2.0);  // six rows whose products may all have one sign; the step is its root
}
TEST(Offsets, ElementBoundIsNotBelowTheLargestEigenvalue) {
  expect_bound<VModel>();
  expect_bound<Evm>();
}

/// The largest ratio of bound and eigenvalue for a bond that is stretched along its axis; one that is pressed
/// is less stiff than the bound allows for.
template <class Law>
double loosest_under_pull(double R_largest) {
  testing::PoseSource random(78);
  double loosest = 0.0;
  for (int trial = 0; trial < 60; ++trial) {
    Law law = testing::random_law<Law>(random);
    law.rules = &no_rules;
    law.R_i = random.uniform(0.0, R_largest), law.R_j = random.uniform(0.0, R_largest);
    const double D = law.a * random.uniform(0.5, 2.0);
    BondPose<double> pose = at_rest(law);
    pose.r_ij.x += D - law.a;
    BondStiffness<double> c = stiffness(law);
    c.c_D *= sq(law.a / D);
    const auto end = [&](double R, double o_2, double o_3) {
      return BondEnd{1.0, random.uniform(0.2, 2.0), random.uniform(0.001, 1.0), R + 0.5 * D, o_2, o_3};
    };
    const auto [o_i2, o_i3, o_j2, o_j3] = offsets_of(law);
    const BondEnd i = end(law.R_i, o_i2, o_i3), j = end(law.R_j, o_j2, o_j3);
    const double bound = element_bound(c, i, j, {tension(law, D), D});
    const double exact = largest_eigenvalue(bond_tangent(law, pose), i, j);
    EXPECT_GE(bound, (1.0 - 1e-12) * exact) << trial;
    if (D > law.a) loosest = std::max(loosest, bound / exact);
  }
  return loosest;
}
// At most the sum of what stiffness and force give apart, and with offsets twice the one and thrice the
// other.
TEST(Pull, ElementBoundIsNotBelowTheLargestEigenvalue) {
  EXPECT_LT(loosest_under_pull<WithRules<VModel>::Law<double>>(2.0), 2.0);
  EXPECT_LT(loosest_under_pull<WithRules<Evm>::Law<double>>(2.0), 2.0);
  EXPECT_LT(loosest_under_pull<Offset<VModel>>(2.0), 3.0);
  EXPECT_LT(loosest_under_pull<Offset<Evm>>(2.0), 3.0);
}

// The rows of G that mix are those of shear and bending, two at a time: the sum of a row of a 2 x 2 matrix
// that is not negative is above its largest eigenvalue by (1 + sqrt 2)/2 at most.
TEST(Offsets, ElementBoundMeetsTheOneWithoutThem) {
  testing::PoseSource random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    const BondStiffness<double> c{random.uniform(0.1, 2.0), random.uniform(0.1, 2.0),
                                  random.uniform(0.01, 2.0), random.uniform(0.01, 2.0)};
    const auto end = [&] {
      return BondEnd{1.0, random.uniform(0.1, 2.0), random.uniform(0.01, 1.0), random.uniform(0.1, 2.0)};
    };
    BondEnd i = end();
    const BondEnd j = end();
    const double without = element_bound(c, i, j);
    i.o_2 = 1e-12;
    const double with = element_bound(c, i, j);
    EXPECT_GE(with, (1.0 - 1e-11) * without);
    EXPECT_LE(with, (1.0 + 1e-11) * 0.5 * (1.0 + std::sqrt(2.0)) * without);
  }
}

}  // namespace
}  // namespace vbond::offsets_test
