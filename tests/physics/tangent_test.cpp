// Tangents of one pair against differences of its loads, and poses against the frames that they are made of.
#include "vbond/physics/tangent.hpp"
#include "vbond/physics/hertz.hpp"
#include "vbond/physics/laws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "random_pose.hpp"
#include "vbond/core/cell.hpp"

namespace vbond {
namespace {

using Numbers = std::array<double, 9>;

Numbers numbers(const BondLoads<double>& l) {
  return {l.F.x, l.F.y, l.F.z, l.M_ij.x, l.M_ij.y, l.M_ij.z, l.M_ji.x, l.M_ji.y, l.M_ji.z};
}

/// The pair with one of r_ij, the turn of i and the turn of j changed by x.
BondPose<double> moved(testing::RandomPair p, int variable, double x) {
  Vec3d step[3];
  component(step[variable / 3], variable % 3) = x;
  p.r_j += step[0];
  p.q_i = rotation_of(step[1]) * p.q_i;
  p.q_j = rotation_of(step[2]) * p.q_j;
  return p.pose();
}

// h = 1e-5: truncation is h^2 = 1e-10 times third derivatives of order 1 to 10, rounding 1e-16 / h = 1e-11.
constexpr double h = 1e-5, tolerance = 1e-8;

template <class Law>
double largest_error(const Law& law) {
  testing::PoseSource source(7);
  double largest = 0.0;
  for (int trial = 0; trial < 20; ++trial) {
    const testing::RandomPair pair = source.pair(1.0, 0.2, 0.8);
    const PairTangent<9> t = bond_tangent(law, pair.pose());
    EXPECT_EQ(numbers(t.loads), numbers(bond_loads(law, pair.pose())));
    for (int k = 0; k < 9; ++k) {
      const Numbers before = numbers(bond_loads(law, moved(pair, k, -h)));
      const Numbers after = numbers(bond_loads(law, moved(pair, k, h)));
      for (std::size_t row = 0; row < 9; ++row)
        largest = std::max(largest, std::abs(t.d[row][static_cast<std::size_t>(k)] -
                                             (after[row] - before[row]) / (2.0 * h)));
    }
  }
  return largest;
}

TEST(BondTangent, IsTheDerivativeOfTheLoads) {
  BondLaws::for_each([]<template <class> class Law>(LawTag<Law>) {
    Law<double> law = Law<double>::from({1.0, 0.6, 0.55, 0.2}, 1.0, 0.3, 0.2);
    for (const LawField<Law<double>>& field : Law<double>::fields())
      if (field.info.input == LawInput::given) law.*field.at = 0.4;
    EXPECT_LE(largest_error(law), tolerance) << Law<double>::name;
  });
}

// The contact pushes i away from j. Hertz's second derivative grows as 1 / sqrt(overlap), which is 0.3 here.
TEST(ContactTangent, IsTheDerivativeOfAForceThatPushesApart) {
  const Vec3d r_ij{0.3, -0.5, 0.6};
  const double R_j = 0.6, R_i = norm(r_ij) + 0.3 - R_j;
  TouchNumbers<double> numbers;
  numbers.stiffness = 2.0;
  for (const NormalForm form : {NormalForm::hertz, NormalForm::one_hertz, NormalForm::linear}) {
    const TouchForms forms{form};
    const auto at = [&](const Vec3d& r) { return contact_tangent(forms, numbers, r, R_i, R_j); };
    const double repulsion = form == NormalForm::linear      ? 2.0 * 0.3
                             : form == NormalForm::one_hertz ? contact_force(HertzContact<double>{2.0}, 0.3)
                                                             : contact_force(hertz(2.0, R_i, R_j), 0.3);
    const PairTangent<3> t = at(r_ij);
    EXPECT_LE(norm(t.loads.F + repulsion / norm(r_ij) * r_ij), 1e-15);
    EXPECT_EQ(t.loads.M_ij, Vec3d{});
    EXPECT_EQ(t.loads.M_ji, Vec3d{});
    for (int k = 0; k < 3; ++k) {
      Vec3d step;
      component(step, k) = h;
      const Vec3d slope = (at(r_ij + step).loads.F - at(r_ij - step).loads.F) / (2.0 * h);
      for (int row = 0; row < 3; ++row)
        EXPECT_NEAR(t.d[static_cast<std::size_t>(row)][static_cast<std::size_t>(k)], component(slope, row),
                    tolerance);
    }
  }
}

// At rest the triads are n_i and (-n_i1, n_i2, n_i3); turned particles take their own along.
TEST(BondPose, HasTheFramesOfItsParticles) {
  testing::PoseSource source(3);
  const Vec3d unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, r_i = source.vector(2.0), r_j = source.vector(2.0);
  const Quatd world = source.rotation(3.0), q_i = source.rotation(3.0), q_j = source.rotation(3.0);
  const BondFrames<double> frames{conjugate(q_i) * world, conjugate(q_j) * world};
  const Quatd turn_i = source.rotation(2.0), turn_j = source.rotation(2.0);
  const BondPose<double> pose = bond_pose(frames, between(r_i, r_j), turn_i * q_i, turn_j * q_j);
  EXPECT_EQ(pose.r_ij, r_j - r_i);
  for (int k = 0; k < 3; ++k) {
    const Vec3d n = rotate(world, unit[k]);
    EXPECT_LE(norm(pose.n_i[k] - rotate(turn_i, n)), 1e-14) << k;
    EXPECT_LE(norm(pose.n_j[k] - rotate(turn_j, k == 0 ? -n : n)), 1e-14) << k;
  }
}

}  // namespace
}  // namespace vbond
