// Paths, fracture and critical loads of bodies whose cell moves with the load factor.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "packings.hpp"
#include "periodic.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/physics/laws.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::moving_cell_test {
namespace {

using namespace testing;
using Drive = std::array<CellComponent, 6>;

BondRecipe with_stiffness(const BondStiffness<double>& c) {
  BondRecipe recipe;
  recipe.parameters = c;
  return recipe;
}
const BondStiffness<double> soft{1.0, 0.35, 0.05, 0.02}, papers{1.0, 0.03, 0.0025, 1.0 / 480};

constexpr double section = 25.0;  // of the cell of a chain

/// A straight chain along x that repeats after `cells` particles, one apart; open across.
Specimen chain(int cells, const std::vector<BondRecipe>& bonds) {
  std::vector<Vec3d> r;
  for (int k = 0; k < cells; ++k) r.push_back({static_cast<double>(k), 0.0, 0.0});
  Specimen s = periodic_body({Vec3d{static_cast<double>(cells), 0, 0}, Vec3d{0, 5, 0}, Vec3d{0, 0, 5}}, r);
  s.model.cell.periodic = {true, false, false};
  for (int k = 0; k < cells; ++k)
    bond_image(s, static_cast<std::size_t>(k), static_cast<std::size_t>((k + 1) % cells),
               {k + 1 == cells ? 1 : 0, 0, 0}, bonds[static_cast<std::size_t>(k) % bonds.size()]);
  return s;
}

StaticStage staged(StageKind kind, const Drive& drive) {
  StaticStage stage = cell_stage(drive);
  stage.kind = kind;
  stage.path.above = 1.0;
  return stage;
}

Specimen packed(const Packing& p, const BondRecipe& recipe) {
  Specimen s = periodic_body(p.edges, p.r);
  for (std::size_t k = 0; k < p.radius.size(); ++k) s.model.radius[ParticleId{k}] = p.radius[k];
  for (const PackingBond& b : p.bonds) bond_image(s, b.i, b.j, {b.a, b.b, b.c}, recipe);
  return s;
}

// HG1 is compressed, and its sides give way to a stress that grows as well: each point of the path is the
// equilibrium that another stage finds there from the start.
TEST(MovingCell, PathsGoThroughEquilibria) {
  const Specimen s = packed(packing_of_equals(), with_stiffness(soft));
  Drive drive{};
  drive[2] = strained(-0.03), drive[0] = stressed(-0.004), drive[1] = stressed(-0.002),
  drive[4] = strained(0.01);
  for (const bool strains_alone : {false, true}) {
    if (strains_alone) drive[0] = drive[1] = {};
    const StaticStage stage = staged(StageKind::path, drive);
    int points = 0;
    StaticHooks hooks;
    hooks.point = [&](const StaticPoint& p) {
      ++points;
      if (p.load_factor == 0.0 || points % 3 != 2) return;
      Drive so_far = drive;
      for (CellComponent& c : so_far) c.value *= p.load_factor;
      const State end = run_static_stage(s.model, cell_stage(so_far), s.state, {}).state;
      for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(stress_of(s, p.state)[k], stress_of(s, end)[k], 1e-11);
        EXPECT_NEAR(cell_strain(s, p.state)[k], cell_strain(s, end)[k], 1e-10);
      }
    };
    const StaticOutcome out = run_static_stage(s.model, stage, s.state, hooks);
    EXPECT_EQ(out.result.ended, "load factor");
    EXPECT_GE(points, 3);
    EXPECT_NEAR(cell_strain(s, out.state)[2], 0.97, 1e-15);
    if (!strains_alone) {
      EXPECT_NEAR(stress_of(s, out.state)[0], -0.004, 1e-12);
    }
  }
}

// Sides that are under a stress already keep it, on the way as at its end.
TEST(MovingCell, StressesGoOnFromWhereTheyAre) {
  const Specimen s = packed(packing_of_equals(), with_stiffness(soft));
  Drive confined{}, pressed{};
  for (std::size_t k = 0; k < 6; ++k) confined[k] = stressed(k < 3 ? -0.01 : 0.0), pressed[k] = confined[k];
  const State start = run_static_stage(s.model, cell_stage(confined), s.state, {}).state;
  pressed[2] = strained(-0.01);
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) {
    EXPECT_NEAR(stress_of(s, p.state)[0], -0.01, 1e-12);
    EXPECT_NEAR(stress_of(s, p.state)[1], -0.01, 1e-12);
    EXPECT_NEAR(stress_of(s, p.state)[5], 0.0, 1e-12);
  };
  for (const StageKind kind : {StageKind::path, StageKind::fracture})
    EXPECT_NEAR(cell_strain(s, run_static_stage(s.model, staged(kind, pressed), start, hooks).state)[2],
                cell_strain(s, start)[2] - 0.01, 1e-15);
}

// A chain of Morse bonds, stiffness 1 and alpha 5, carries 1/(4 alpha) at most, at the stretch ln 2/alpha.
TEST(MovingCell, PathsGoThroughALimitPoint) {
  BondRecipe morse = with_stiffness({1.0, 0.03, 0.0025, 0.002});
  morse.rules.stretch.form = StretchForm::morse;
  morse.rules.stretch.alpha = 5.0;
  for (const int cells : {1, 3}) {
    const Specimen s = chain(cells, {morse});
    Drive drive{};
    drive[0] = stressed(1.0 / section);  // a load factor of the force in the chain
    StaticStage stage = staged(StageKind::path, drive);
    stage.path.first_step = 0.005;
    stage.path.above.reset();
    stage.path.below = 0.02;
    double stretch = 0.0;
    StaticHooks hooks;
    hooks.point = [&](const StaticPoint& p) {
      const double x = cell_strain(s, p.state)[0] - 1.0;
      EXPECT_NEAR(p.load_factor, (std::exp(-5 * x) - std::exp(-10 * x)) / 5, 1e-9);
      if (p.kind == PointKind::limit_point) stretch = x;
    };
    const StaticOutcome out = run_static_stage(s.model, stage, s.state, hooks);
    ASSERT_EQ(out.result.special_points.size(), 1u);
    EXPECT_NEAR(out.result.special_points[0].load_factor, 0.05, 1e-10);
    EXPECT_NEAR(stretch, std::log(2.0) / 5, 1e-6);
    EXPECT_EQ(out.result.ended, "load factor");
    EXPECT_GT(cell_strain(s, out.state)[0], 1.3);
  }
}

constexpr double unbreakable = 1e30;
BondRecipe breakable(double tension) {
  BondRecipe recipe = with_stiffness(soft);
  recipe.law = &bond_law<WithRules<VModel>::Law>;
  recipe.rules.strength = linear_strength(tension, unbreakable, unbreakable, unbreakable);
  return recipe;
}

// Chains side by side, each a bond to its own image, which a strain stretches alike: each breaks at its
// strength, and the force is that of those that are left.
TEST(MovingCell, ChainsBreakOneByOne) {
  const std::vector<double> strengths{0.31, 0.12, 0.55, 0.2};
  const std::vector<std::size_t> order{1, 3, 0, 2};
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < strengths.size(); ++k) r.push_back({0, static_cast<double>(k), 0});
  Specimen s = periodic_body({Vec3d{1, 0, 0}, Vec3d{0, 5, 0}, Vec3d{0, 0, 5}}, r, 0.1);
  s.model.cell.periodic = {true, false, false};
  for (std::size_t k = 0; k < strengths.size(); ++k) bond_image(s, k, k, {1, 0, 0}, breakable(strengths[k]));
  Drive drive{};
  drive[0] = strained(1.0);
  const FractureResult f =
      run_static_stage(s.model, staged(StageKind::fracture, drive), s.state, {}).result.fracture;
  ASSERT_EQ(f.breaks.size(), strengths.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double u = strengths[order[k]];
    EXPECT_EQ(f.breaks[k].use.bond.value, order[k]);
    EXPECT_NEAR(f.breaks[k].use.load_factor, u, 1e-9);
    EXPECT_NEAR(f.breaks[k].load, static_cast<double>(4 - k) * u / section, 1e-9);
    EXPECT_NEAR(f.breaks[k].released, 0.5 * u * u, 1e-9);
  }
  EXPECT_NEAR(f.peak_load, 2 * 0.31 / section, 1e-9);  // of two chains, as the third one is about to break
  EXPECT_LT(std::abs(f.books.error()), 1e-9);
}

/// The largest utilisation of these bonds' tension in a state, and of which bond.
std::pair<double, BondId> most_used(const State& s) {
  std::pair<double, BondId> most{-1.0, BondId{0}};
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (b.broken) continue;
    const double u = b.law->failure(b, bond_pose(b, s), {}).utilisation;
    if (u > most.first) most = {u, k};
  }
  return most;
}

// Packings with random strengths, under strain in one direction and strain or stress in others: where a bond
// breaks the equilibrium of a stage of its own, from the start and without the bonds that had broken before,
// has it at its strength and no other beyond.
TEST(MovingCellCampaign, BondsBreakWhereEquilibriaBringThemToTheirStrength) {
  const Tally all =
      campaign("fracture of packings in a cell", 12, [&](unsigned seed, Tally& tally) -> Verdict {
        Dice dice(seed);
        const Packing p = packing_of_equals();
        Specimen s = periodic_body(p.edges, p.r);
        for (const PackingBond& b : p.bonds)
          bond_image(s, b.i, b.j, {b.a, b.b, b.c}, breakable(dice(0.01, 0.03)));
        Drive drive{};
        drive[dice.below(3)] = strained(0.03);
        for (CellComponent& c : drive)
          if (c.by == CellComponent::By::held && dice.chance(0.3)) c = strained(dice(-0.005, 0.01));
        StaticStage stage = staged(StageKind::fracture, drive);
        stage.fracture.most_breaks = 6;
        stage.fracture.control = dice.chance(0.5) ? FractureControl::load : FractureControl::crack;
        const StaticResult r = run_static_stage(s.model, stage, s.state, {}).result;
        Specimen left = s;
        bool first_of_avalanche = true;
        int avalanche = 0;
        for (const BrokenBond& b : r.fracture.breaks) {
          first_of_avalanche = b.avalanche != avalanche;
          avalanche = b.avalanche;
          Drive so_far = drive;
          for (CellComponent& c : so_far) c.value *= b.use.load_factor;
          const State there = run_static_stage(left.model, cell_stage(so_far, 4), left.state, {}).state;
          const auto [u, bond] = most_used(there);
          tally.below("utilisation beside what was told", std::abs(u - b.use.utilisation), 1e-7);
          if (first_of_avalanche) tally.below("utilisation beside 1", std::abs(u - 1.0), 1e-7);
          EXPECT_EQ(bond, b.use.bond);
          left.state.bonds[b.use.bond].broken = true;
          tally.add("breaks");
        }
        tally.below("books", std::abs(r.fracture.books.error()), 1e-7);
        if (r.fracture.breaks.empty()) return {"no bond broke"};
        return {};
      });
  EXPECT_GE(all.sum("breaks"), all.full ? 40 : 0);
}

/// The force at which a straight V-model chain with spacing l of its particles buckles in waves of phase k
/// from one to the next. With x = 2 sin(k/2) W/l of the deflection W, and the turn T, the energy of a bond is
/// half of
///     -N l x^2 + 4 c_B sin^2(k/2) T^2 + c_D a^2 (x - cos(k/2) T)^2.
double critical_force(double k, double l) {
  const double s2 = sq(std::sin(0.5 * k)), c2 = sq(std::cos(0.5 * k));
  const double bending = 4 * papers.c_B * s2, shear = papers.c_D;
  return bending * shear / (bending + shear * c2) / l;
}

// Strained: the force is c_A (1 - l). Under a stress: the load factor times what it says over the section.
TEST(MovingCell, InfiniteColumnsBuckleInTheirWaves) {
  for (const int cells : {1, 2, 3}) {
    const Specimen s = chain(cells, {with_stiffness(papers)});
    std::vector<double> phases;
    for (int k = 1; k <= 6; ++k) phases.push_back(0.5 * k / 6.5);  // of one cell
    for (const bool by_stress : {false, true}) {
      Drive drive{};
      drive[0] = by_stress ? stressed(-0.1 / section) : strained(-0.1);
      StaticStage stage = staged(StageKind::buckling, drive);
      stage.count = 1;
      stage.waves.of_edges = true;
      for (const double x : phases) stage.waves.q.push_back({x, 0, 0});
      const StaticResult r = run_static_stage(s.model, stage, s.state, {}).result;
      EXPECT_EQ(r.ended, "converged");
      for (std::size_t w = 0; w < phases.size(); ++w) {
        double first = 1e30;
        for (int branch = 0; branch < cells; ++branch) {
          const double k = 2 * M_PI * (phases[w] + branch) / cells;
          double l = 1.0;
          for (int look = 0; look < 100; ++look)
            l = 1.0 - critical_force(k, l);  // contracts: force/l is small
          first = std::min(first, (by_stress ? critical_force(k, l) : 1.0 - l) / 0.1);
        }
        const auto found = std::find_if(r.critical_loads.begin(), r.critical_loads.end(),
                                        [&](const auto& c) { return c.wave == static_cast<int>(w) + 1; });
        ASSERT_NE(found, r.critical_loads.end());
        EXPECT_NEAR(found->load_factor, first, 1e-10 * first) << cells << " particles, wave " << w;
        // deflections across, in two planes at once
        const auto same = std::count_if(r.critical_loads.begin(), r.critical_loads.end(), [&](const auto& c) {
          return c.wave == found->wave && std::abs(c.load_factor - first) < 1e-8 * first;
        });
        EXPECT_EQ(same, 2);
      }
    }
  }
}

// What repeats with the cell, in a cell of ten particles: the longest wave is that of phase 2 pi/10.
TEST(MovingCell, StrainedColumnsBuckleInsideTheirCell) {
  const Specimen s = chain(10, {with_stiffness(papers)});
  Drive drive{};
  drive[0] = strained(-0.1);
  StaticStage stage = staged(StageKind::buckling, drive);
  stage.count = 4;  // sine and cosine in two planes
  const StaticResult r = run_static_stage(s.model, stage, s.state, {}).result;
  double l = 1.0;
  for (int look = 0; look < 100; ++look) l = 1.0 - critical_force(2 * M_PI / 10, l);
  ASSERT_EQ(r.critical_loads.size(), 4u);
  for (const CriticalLoad& c : r.critical_loads) EXPECT_NEAR(c.load_factor, (1.0 - l) / 0.1, 1e-9);
}

// A heated lattice whose cell bears no stress grows with its bonds: the tangent foresees it, so that a load
// step leads there, and no shorter ones are tried.
TEST(MovingCell, GrowsAsItIsHeatedInOneStep) {
  BondRecipe recipe = with_stiffness(soft);
  recipe.expansion = 1e-3;
  Specimen s = periodic_body(cube(1), {{0, 0, 0}});
  for (const Image& n : {Image{1, 0, 0}, Image{0, 1, 0}, Image{0, 0, 1}})
    add_bond(s.model,
             make_bond(recipe, bond_site(s.model, s.state, ParticleId{0}),
                       bond_site(s.model, s.state, ParticleId{0}, n))
                 .value(),
             recipe, s.state);
  Drive drive{};
  for (CellComponent& c : drive) c = stressed(0.0);
  StaticStage stage = cell_stage(drive);
  stage.heating = {{{ParticleId{0}}, 10.0, {}}};
  const StaticOutcome out = run_static_stage(s.model, stage, s.state, {});
  EXPECT_EQ(out.result.points, 2);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(cell_strain(s, out.state)[k], 1.01, 1e-13);
    EXPECT_NEAR(stress_of(s, out.state)[k], 0.0, 1e-13);
  }
}

TEST(MovingCell, RefusesWhatHasNoPotential) {
  const Specimen s = chain(2, {with_stiffness(papers)});
  Drive drive{};
  drive[0] = stressed(-0.01);
  StaticStage stage = staged(StageKind::buckling, drive);
  const auto mistakes = mistakes_in(s.model, stage);
  ASSERT_FALSE(mistakes.empty());
  EXPECT_NE(mistakes[0].find("no potential"), std::string::npos) << mistakes[0];
  stage.waves.q = {{0.1, 0, 0}};
  EXPECT_TRUE(mistakes_in(s.model, stage).empty());
  stage.kind = StageKind::modes;
  EXPECT_FALSE(mistakes_in(s.model, stage).empty());
}

}  // namespace
}  // namespace vbond::moving_cell_test
