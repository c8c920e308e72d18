// Bodies without stress, placed anywhere: all their forces are rounding, and none is a part of another.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bodies.hpp"
#include "dynamics/tops.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/physics/laws.hpp"
#include "vbond/statics/detail/dense.hpp"

namespace vbond::rest_test {
namespace {

using testing::Dice;
using testing::Specimen;

std::size_t drawn_number(Dice& dice, std::size_t low, std::size_t high) {
  return low + static_cast<std::size_t>(dice(0.0, 1.0) * static_cast<double>(high - low + 1));
}

/// Points no closer than 0.6, in a ball that has room for twice as many.
std::vector<Vec3d> drawn_cloud(Dice& dice, std::size_t n) {
  std::vector<Vec3d> r;
  const double size = 0.8 * std::cbrt(static_cast<double>(n));
  while (r.size() < n) {
    const Vec3d p = dice.vector(size);
    if (std::all_of(r.begin(), r.end(), [&](const Vec3d& q) { return norm(p - q) > 0.6; })) r.push_back(p);
  }
  return r;
}

BondRecipe drawn_recipe(Dice& dice) {
  BondRecipe recipe;
  recipe.law = dice(0, 1) < 0.5 ? &bond_law<VModel> : &bond_law<Evm>;
  recipe.parameters =
      BondStiffness<double>{dice(0.5, 2.0), dice(0.05, 1.0), dice(0.02, 0.3), dice(0.02, 0.3)};
  return recipe;
}

/// A body that hangs together, with a bond of its own kind for each particle to the nearest one before it and
/// to all others within 1.3.
Specimen drawn_body(Dice& dice, const std::vector<Vec3d>& r) {
  Specimen s = testing::particles_at(r, 0.25, 0.03);
  for (const ParticleId p : s.model.mass.ids()) s.model.mass[p] = dice(0.5, 2.0);
  for (std::size_t j = 1; j < r.size(); ++j) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < j; ++i)
      if (norm(r[i] - r[j]) < norm(r[nearest] - r[j])) nearest = i;
    for (std::size_t i = 0; i < j; ++i)
      if (i == nearest || norm(r[i] - r[j]) < 1.3) testing::bond(s, i, j, drawn_recipe(dice));
  }
  return s;
}

/// Turned at random, and moved by up to 1e4 times its size.
std::vector<Vec3d> placed_anywhere(Dice& dice, std::vector<Vec3d> r) {
  const Quatd turn = rotation_of(dice.vector(2.0));
  Vec3d away = dice.vector(1.0);
  const double size = std::cbrt(static_cast<double>(r.size()));
  away = (dice(0, 1) < 0.2 ? 0.0 : size * std::pow(10.0, dice(-1, 4)) / norm(away)) * away;
  for (Vec3d& p : r) p = away + rotate(turn, p);
  return r;
}

/// Squared frequencies, smallest first, of the bodies' stiffness by central differences of the loads of the
/// plain loop over bonds, without a part of the solvers. Turns are in units of 1.
Eigen::VectorXd frequencies_by_differences(const Specimen& s) {
  constexpr double h = 1e-4;
  const std::size_t n = s.model.particles();
  Eigen::MatrixXd K(6 * n, 6 * n);
  const auto loads_beside = [&](std::size_t dof, double by) {
    State beside = s.state;
    const ParticleId p{dof / 6};
    Vec3d way;
    component(way, static_cast<int>(dof % 3)) = by;
    if (dof % 6 < 3)
      beside.r[p] += way;
    else
      beside.q[p] = rotation_of(way) * beside.q[p];
    Loads loads{PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)};
    add_bond_loads(beside, loads);
    Eigen::VectorXd g(6 * n);
    for (const ParticleId q : loads.F.ids())
      for (int k = 0; k < 3; ++k) {
        g[static_cast<Eigen::Index>(6 * q.value) + k] = component(loads.F[q], k) / std::sqrt(s.model.mass[q]);
        g[static_cast<Eigen::Index>(6 * q.value) + 3 + k] =
            component(loads.M[q], k) / std::sqrt(s.model.inertia[q]);
      }
    return g;
  };
  for (std::size_t dof = 0; dof < 6 * n; ++dof) {
    const ParticleId p{dof / 6};
    const double root = std::sqrt(dof % 6 < 3 ? s.model.mass[p] : s.model.inertia[p]);
    K.col(static_cast<Eigen::Index>(dof)) = (loads_beside(dof, -h) - loads_beside(dof, h)) / (2 * h * root);
  }
  return dense_eigenvalues(0.5 * (K + K.transpose())).values;
}

StaticResult modes_of(const Specimen& s, int count) {
  StaticStage stage = testing::static_stage(StageKind::modes, {});
  stage.count = count;
  return run_static_stage(s.model, stage, s.state, {}).result;
}

// Seeds 1 to 1000: five to 60 particles. Differences are off by h^2 = 1e-8 of the largest of the stiffnesses,
// the body's places by up to 1e4 eps of its size: 1e-7 of the largest squared frequency covers both.
TEST(Modes, OfFreeBodiesWithoutStressAreSixRigidMotionsAndTheirSwingsWhereverTheBodyStands) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    Dice dice(seed);
    const std::vector<Vec3d> cloud = drawn_cloud(dice, drawn_number(dice, 5, 60));
    const unsigned bonds_seed = 1000 + seed;
    Dice of_bonds(bonds_seed), again(bonds_seed);
    const std::vector<Vec3d> placed = placed_anywhere(dice, cloud);
    std::vector<NaturalMode> modes;
    try {
      modes = modes_of(drawn_body(of_bonds, placed), 4).modes;
    } catch (const NoEquilibrium& e) {
      ADD_FAILURE() << "seed " << seed << ": " << e.what();
      continue;
    }
    ASSERT_EQ(modes.size(), 10u) << "seed " << seed;
    for (std::size_t k = 0; k < modes.size(); ++k)
      EXPECT_EQ(modes[k].rigid, k < 6) << "seed " << seed << ", mode " << k;
    if (cloud.size() > 12) continue;
    const Eigen::VectorXd all = frequencies_by_differences(drawn_body(again, cloud));
    for (int k = 6; k < 10; ++k)
      EXPECT_NEAR(modes[static_cast<std::size_t>(k)].omega2, all[k], 1e-7 * all[all.size() - 1])
          << "seed " << seed << ", mode " << k;
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

// Held in places and in one turn of a particle, whose reaction is rounding: neither a jump nor a moment from
// outside is told. Seeds 1 to 300.
TEST(Equilibrium, OfHeldBodiesWithoutStressTellsOfNothing) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    Dice dice(seed);
    const std::vector<Vec3d> placed = placed_anywhere(dice, drawn_cloud(dice, drawn_number(dice, 5, 20)));
    const Specimen s = drawn_body(dice, placed);
    for (const StageKind kind : {StageKind::equilibrium, StageKind::modes}) {
      StaticStage stage = testing::static_stage(
          kind, {testing::fixed({ParticleId{0}}, {true, true, true, true, false, false}),
                 testing::fixed({ParticleId{1}, ParticleId{2}}, {true, true, true, false, false, false})});
      stage.steps = 3;
      std::string told;
      StaticHooks hooks;
      hooks.tell = [&told](const std::string& text) { told += text; };
      const StaticResult result = run_static_stage(s.model, stage, s.state, hooks).result;
      EXPECT_FALSE(result.jumped) << "seed " << seed;
      EXPECT_EQ(told, "") << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace vbond::rest_test
