// Bonds break between particles that supports hold altogether: there is no unknown, and each bond breaks by
// itself where its own load at the given places reaches its strength.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bodies.hpp"
#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "dynamics/spheres_and_walls.hpp"
#include "vbond/physics/laws.hpp"
#include "walks.hpp"

namespace vbond {
namespace {

using testing::Dice;
using testing::Specimen;

constexpr double unbreakable = 1e30;

BondRecipe breakable(const BondStiffness<double>& c, double tension, const BondLaw* law) {
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = c;
  recipe.rules.strength = linear_strength(tension, unbreakable, unbreakable, unbreakable);
  return recipe;
}

/// Fibres along z, one apart, each a bond of the lower to the upper plate.
Specimen fibres(const std::vector<double>& strengths) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < strengths.size(); ++k)
    for (const double z : {0.0, 1.0}) r.push_back({static_cast<double>(k), 0, z});
  Specimen s = testing::particles_at(r, 0.1);
  for (std::size_t k = 0; k < strengths.size(); ++k)
    testing::bond(s, 2 * k, 2 * k + 1,
                  breakable({1.0, 0.1, 0.01, 0.01}, strengths[k], &bond_law<WithRules<VModel>::Law>));
  return s;
}
Support plate(const Specimen& s, std::size_t first, const Vec3d& displacement = {},
              const Vec3d& rotation = {}) {
  Support support = testing::fixed({}, all_held, displacement, rotation);
  for (std::size_t k = first; k < s.model.particles(); k += 2) support.particles.push_back(ParticleId{k});
  return support;
}

// A bundle drawn out by 1 between plates: fibre k breaks at the displacement strength / stiffness, and gives
// up strength^2 / 2. Both controls are the same, as nothing moves when a fibre breaks.
TEST(HeldFracture, FibresBetweenPlatesBreakOneByOne) {
  const std::vector<double> strengths{0.31, 0.12, 0.55, 0.2, 0.7};
  const std::vector<std::size_t> order{1, 3, 0, 2, 4};
  for (const bool rigid : {false, true})
    for (const FractureControl control : {FractureControl::load, FractureControl::crack}) {
      const Specimen s = fibres(strengths);
      StaticStage stage = testing::static_stage(StageKind::fracture, {plate(s, 0), plate(s, 1, {0, 0, 1.0})});
      stage.supports[0].rigid = stage.supports[1].rigid = rigid;
      stage.fracture.control = control;
      const testing::Walked w = testing::walk(s, stage);
      const FractureResult& f = w.result.fracture;
      ASSERT_EQ(f.breaks.size(), strengths.size());
      double released = 0.0;
      for (std::size_t k = 0; k < order.size(); ++k) {
        EXPECT_EQ(f.breaks[k].use.bond.value, order[k]);
        EXPECT_NEAR(f.breaks[k].use.load_factor, strengths[order[k]], 1e-9);
        EXPECT_NEAR(f.breaks[k].released, 0.5 * sq(strengths[order[k]]), 1e-9);
        released += 0.5 * sq(strengths[order[k]]);
      }
      EXPECT_NEAR(f.books.work, released, 1e-9);  // nothing else takes it
      EXPECT_LT(std::abs(f.books.error()), 1e-9);
      EXPECT_EQ(w.result.ended, "parted");
      EXPECT_NEAR(f.peak_load, 2 * 0.55, 1e-9);  // of two fibres, as the fourth is about to break
    }
}

/// The load factor at which the tension of a bond between held particles first reaches this strength; above 1
/// if it does not.
double breaks_at(const Specimen& s, const StaticStage& stage, BondId bond, double strength) {
  const auto tension = [&](double f) {
    State placed = s.state;
    for (const Support& support : stage.supports)
      for (const ParticleId p : support.particles) {
        placed.r[p] += f * support.velocity;
        placed.q[p] = rotation_of(f * support.angular_velocity) * placed.q[p];
      }
    const Bond& b = placed.bonds[bond];
    const BondPose<double> pose = bond_pose(b, placed);
    const Vec3d D = bonded_points(pose, b.R_i, b.R_j);
    return dot(bond_loads(placed, bond).F, D) / norm(D);
  };
  constexpr int parts = 2000;
  for (int k = 1; k <= parts; ++k) {
    double low = (k - 1.0) / parts, high = static_cast<double>(k) / parts;
    if (!(tension(high) >= strength)) continue;
    for (int halvings = 0; halvings < 60; ++halvings)
      (tension(0.5 * (low + high)) >= strength ? high : low) = 0.5 * (low + high);
    return high;
  }
  return 2.0;
}

// Random bodies, all of whose particles are held: two plates that move and turn each for itself.
TEST(HeldFracture, EachBondBreaksWhereItsOwnLoadSaysSo) {
  const testing::Tally all = testing::campaign("held bodies", 30, [](unsigned seed, testing::Tally& tally) {
    Dice dice(seed);
    Specimen s = testing::random_body(dice);
    s.state.bonds = {};
    std::vector<double> strengths;
    const std::size_t n = s.model.particles();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j)
        if ((i + j) % 2 == 1 && norm(s.state.r[ParticleId{j}] - s.state.r[ParticleId{i}]) < 1.7) {
          strengths.push_back(dice(0.02, 0.3));
          testing::bond(
              s, i, j,
              breakable(
                  {dice(0.5, 1), dice(0.05, 0.2), dice(0.02, 0.1), dice(0.02, 0.1)}, strengths.back(),
                  dice(0, 1) < 0.5 ? &bond_law<WithRules<VModel>::Law> : &bond_law<WithRules<Evm>::Law>));
        }
    StaticStage stage = testing::static_stage(StageKind::fracture,
                                              {plate(s, 0), plate(s, 1, dice.vector(0.4), dice.vector(0.3))});
    stage.steps = 100;  // tension may rise and fall again
    std::vector<std::pair<double, std::size_t>> expected;
    for (const BondId b : s.state.bonds.ids())
      if (const double f = breaks_at(s, stage, b, strengths[b.value]); f <= 1.0)
        expected.push_back({f, b.value});
    std::sort(expected.begin(), expected.end());
    const FractureResult f = testing::walk(s, stage).result.fracture;
    ASSERT_EQ(f.breaks.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      tally.add("breaks");
      ASSERT_EQ(f.breaks[k].use.bond.value, expected[k].second);
      ASSERT_NEAR(f.breaks[k].use.load_factor, expected[k].first, 1e-7);
    }
    ASSERT_LT(std::abs(f.books.error()), 1e-6);
  });
  EXPECT_EQ(all["given up"], 0u);
  EXPECT_GT(all.sum("breaks"), all.full ? all.cases : 0);
}

// Two bars drawn by grips, of which one may twist: once its bar has parted nothing holds it in that, so that
// it is held where it is, and the other bar is drawn on.
TEST(HeldFracture, AGripThatNothingTurnsAnyMoreIsHeld) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 3, 0}, {1, 3, 0}, {1, 4, 0}}, 0.1);
  const BondStiffness<double> c{1.0, 0.1, 0.01, 0.01};
  testing::bond(s, 0, 1, breakable(c, 0.1, &bond_law<VModel>));
  testing::bond(s, 3, 4, breakable(c, 0.2, &bond_law<VModel>));
  const auto grip = [](std::size_t p, std::size_t q, const HeldDofs& held) {
    Support support = testing::fixed({ParticleId{p}, ParticleId{q}}, held, {1, 0, 0});
    support.rigid = true;
    return support;
  };
  const StaticStage stage = testing::static_stage(
      StageKind::fracture, {testing::fixed({ParticleId{0}, ParticleId{3}}, testing::clamped),
                            grip(1, 2, {true, true, true, false, true, true}), grip(4, 5, testing::clamped)});
  const testing::Walked w = testing::walk(s, stage);
  const FractureResult& f = w.result.fracture;
  ASSERT_EQ(f.breaks.size(), 2u);
  EXPECT_NEAR(f.breaks[0].use.load_factor, 0.1, 1e-9);
  EXPECT_NEAR(f.breaks[1].use.load_factor, 0.2, 1e-9);
  EXPECT_EQ(f.released_parts, 1);
  EXPECT_EQ(w.result.ended, "parted");
  EXPECT_NEAR(f.books.work, 0.5 * (sq(0.1) + sq(0.2)), 1e-9);
  EXPECT_LT(std::abs(f.books.error()), 1e-9);
}

// A held bundle goes with the wall that just touches it: overlaps are rounding, and so is what they store,
// some 1e-17 of the least energy that the books compare an error with, a thousand roundings of the bonds'.
TEST(HeldFracture, BooksOfNothingButRoundingClose) {
  Dice dice(3);
  double stored = 0.0;
  for (int k = 0; k < 30; ++k) {
    Specimen s = fibres({1.0, 1.0});
    s.model.contact = testing::linear(1.0, 0.0);
    s.model.walls = {testing::floor_at(-0.1)};
    for (double& R : s.model.radius) R = 0.1;
    const Vec3d way{dice(-0.3, 0.3), dice(-0.3, 0.3), dice(0.001, 0.5)};
    StaticStage stage = testing::static_stage(StageKind::fracture, {plate(s, 0, way), plate(s, 1, way)});
    stage.walls = {{"floor", 0, {0, 0, way.z}, {}, {}}};
    const FractureBooks books = testing::walk(s, stage).result.fracture.books;
    EXPECT_LT(std::abs(books.error()), 1e-9) << k;
    stored = std::max(stored, books.stored);
  }
  EXPECT_GT(stored, 0.0);  // some did overlap
  EXPECT_LT(stored, 1e-30);
}

}  // namespace
}  // namespace vbond
