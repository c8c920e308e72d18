// Bonds that touch as capsules: exact impacts, friction, random encounters, bonds that break and are made.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "campaigns/judge.hpp"
#include "fibres.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond::capsule_motion_test {
namespace {

using namespace testing;

// Bars that meet at their middles do not bend: Hertz's impact of two masses of 2 m, m* = m.
TEST(Capsules, MeetHeadOnAsTheOneDimensionalFormulaSays) {
  const double v = 2.0 * 0.05, m = 1.0, k = K * std::sqrt(0.1);
  const double deepest = std::pow(1.25 * m * v * v / k, 0.4), duration = 2.9432751 * deepest / v;
  const double dt = duration / 2000;
  Specimen s = crossed_bars(hertz(), 0.05);
  Simulation run(s.model, plain_stage(dt, 1.0), s.state);
  double overlap = 0.0;
  int touching = 0;
  for (int step = 0; step < 3500; ++step) {
    run.step();
    const double d = 0.4 - (run.state().r[ParticleId{2}].z - run.state().r[ParticleId{0}].z);
    overlap = std::max(overlap, d), touching += d > 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(overlap / deepest, 1.0, 1e-6);
  EXPECT_NEAR(touching * dt / duration, 1.0, 2.0 / 2000);
  EXPECT_NEAR(run.state().v[ParticleId{0}].z, -0.05, 1e-9);
  EXPECT_LT(std::abs(run.balance_error()), 1e-6);
}

TEST(Capsules, PartWithTheirRestitution) {
  for (const double e : {0.9, 0.5}) {
    ContactModel contact = hertz();
    contact.surface.restitution = e;
    Specimen s = crossed_bars(contact, 0.05);
    Simulation run(s.model, plain_stage(2e-4, 1.0), s.state);
    for (int step = 0; step < 20000; ++step) run.step();
    EXPECT_TRUE(run.state().fibre_history.empty());
    EXPECT_NEAR(run.state().v[ParticleId{2}].z / 0.05, e, 1e-3);
    EXPECT_LT(std::abs(run.balance_error()), 1e-3);
  }
}

/// A stage in which these particles move as said.
Stage moving(const std::vector<ParticleId>& still, const std::vector<ParticleId>& moved,
             const Vec3d& velocity, double dt, double duration) {
  Stage stage = plain_stage(dt, duration);
  stage.supports = {held(still, clamped), held(moved, clamped, velocity)};
  return stage;
}

// A fibre that is drawn along a held one feels mu N, also as it slides from bond to bond.
TEST(Capsules, KeepFrictionFromBondToBond) {
  const double mu = 0.4, d = 0.02, N = K * std::sqrt(0.1) * std::pow(d, 1.5), dt = 1e-3;
  Specimen s = fibres({line({0, 0, 0}, {0.5, 0, 0}, 7), line({-1.2, 0, 0.4 - d}, {0, 0.5, 0}, 2)}, rough(mu));
  std::vector<ParticleId> still, moved{ParticleId{7}, ParticleId{8}};
  for (std::size_t k = 0; k < 7; ++k) still.push_back(ParticleId{k});
  Simulation run(s.model, moving(still, moved, {0.5, 0, 0}, dt, 10.0), s.state);
  for (int step = 0; step < 200; ++step) run.step();  // until it slides
  for (int step = 0; step < 4000; ++step) {
    run.step();
    const Loads loads = run.loads();
    const Vec3d F = loads.F[moved[0]] + loads.F[moved[1]];
    ASSERT_NEAR(F.x, -mu * N, 1e-9) << step;
    ASSERT_NEAR(F.z, N, 1e-9) << step;
  }
  EXPECT_GT(run.state().r[moved[0]].x, 0.8);
  EXPECT_LT(std::abs(run.balance_error()), 1e-5);
}

// Fibres that lie along each other touch in many bonds: normal force and friction are those of one contact.
TEST(Capsules, SideBySideHaveTheFrictionOfOneContact) {
  const double mu = 0.4, d = 0.02, N = K * std::sqrt(0.1) * std::pow(d, 1.5);
  for (const double angle : {0.0, 1e-3, 0.02}) {
    Specimen s = fibres({line({0, 0, 0}, {0.5, 0, 0}, 7),
                         line({-0.3, 0, 0.4 - d}, {0.5 * std::cos(angle), 0.5 * std::sin(angle), 0}, 7)},
                        rough(mu));
    std::vector<ParticleId> still, moved;
    for (std::size_t k = 0; k < 14; ++k) (k < 7 ? still : moved).push_back(ParticleId{k});
    Simulation run(s.model, moving(still, moved, {0.1, 0, 0}, 1e-3, 10.0), s.state);
    double most = 0.0, mean = 0.0;
    for (int step = 0; step < 4000; ++step) {
      run.step();
      Vec3d F;
      for (const ParticleId p : moved) F += run.loads().F[p];
      ASSERT_NEAR(F.z / N, 1.0, 1e-9) << step;
      if (step < 1000) continue;
      most = std::max(most, -F.x / N), mean += -F.x / N / 3000;
    }
    EXPECT_LT(most, mu * (1.0 + 1e-9)) << angle;
    EXPECT_GT(mean, 0.9 * mu) << angle;
    EXPECT_LT(std::abs(run.balance_error()), 1e-3);
  }
}

// Along closed paths over the particles of bent fibres friction takes energy and never gives any.
TEST(Capsules, FrictionNeverMakesEnergyOnClosedPaths) {
  Dice dice(4);
  int slid = 0;
  for (int k = 0; k < 30; ++k) {
    std::vector<Vec3d> chain = line({0, 0, 0}, {0.5, 0, 0}, 5);
    for (Vec3d& x : chain) x.z += dice(-0.05, 0.05);
    const double angle = dice(0.4, 2.7);
    Specimen s = fibres(
        {chain, line({dice(-0.5, 0.5), 0, 0.42}, {0.5 * std::cos(angle), 0.5 * std::sin(angle), 0}, 3)},
        rough(dice(0.1, 1.0)));
    std::vector<ParticleId> still, moved;
    for (std::size_t p = 0; p < 8; ++p) (p < 5 ? still : moved).push_back(ParticleId{p});
    std::vector<Vec3d> corners{{}};
    for (int c = 0; c < 5; ++c) corners.push_back({dice(-0.4, 0.4), dice(-0.1, 0.1), dice(-0.08, 0.02)});
    corners.push_back({});
    corners.push_back({});  // and rests there
    for (std::size_t c = 0; c + 1 < corners.size(); ++c) {
      Simulation run(s.model, moving(still, moved, corners[c + 1] - corners[c], 2e-3, 1.0), s.state);
      const double start = run.books().dissipated;
      run.run();
      EXPECT_GE(run.books().dissipated, start - 1e-9);
      EXPECT_LT(std::abs(run.energies().total() + run.books().dissipated - run.books().work_supports -
                         run.books().at_start),
                2e-3 * std::max(run.books().dissipated, 1e-3));
      s.state = std::move(run).handover().state;
      s.state.clock = {.step = s.state.clock.step, .stage = s.state.clock.stage + 1};
    }
    EXPECT_GE(s.state.books.work_supports, -1e-6);
    slid += s.state.books.dissipated > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(slid, 15);
}

Tally throw_fibres(bool as_capsules, unsigned count, double fraction) {
  return testing::campaign("thrown fibres", count, [&](unsigned seed, Tally& all) {
    Dice dice(seed);
    const auto thrown = [&](double z) {
      const double angle = dice(0, pi);
      std::vector<Vec3d> r =
          line({dice(-0.5, 0.5), dice(-0.5, 0.5), z}, {0.5 * std::cos(angle), 0.5 * std::sin(angle), 0}, 7);
      for (Vec3d& x : r) x += dice.vector(0.06);
      return r;
    };
    ContactModel contact = dice(0, 1) < 0.5 ? rough(dice(0, 1), dice(0.3, 1)) : hertz();
    contact.E = 400.0;
    Specimen s = fibres({thrown(0.0), thrown(dice(0.7, 0.9))}, contact);
    const Vec3d v{dice(-0.2, 0.2), dice(-0.2, 0.2), -dice(0.1, 0.6)};
    for (std::size_t p = 7; p < 14; ++p) s.state.v[ParticleId{p}] = v + dice.vector(0.05);
    if (!as_capsules)
      for (Bond& b : s.state.bonds) set_capsule(b, 0.0);
    const double dt = fraction * step_bound(s.model, s.state).dt;
    Simulation run(s.model, plain_stage(dt, 8.0), s.state);
    Vec3d before, after;
    for (const Vec3d& x : s.state.v) before += x;
    double least = INFINITY;
    while (run.clock().time() < 8.0) {
      run.step();
      least = std::min(least, least_distance(run.state(), 7));
    }
    for (const Vec3d& x : run.state().v) after += x;
    all.most("balance", std::abs(run.balance_error()));
    if (least < 0.4) all.add("met");
    const bool through = least < 0.2;  // half through; a step goes less than 0.06
    if (through) all.add("passed through");
    EXPECT_FALSE(as_capsules && through);
    all.below("change of momentum", norm(after - before), 1e-11);
  });
}

// Fibres thrown at one another at random. As balls on strings most pass through. The
// balance is of the order of the step: nearly parallel fibres, whose contact jumps along them, are the worst,
// and more throws find worse ones (of 1000 0.12).
TEST(Capsules, NeverPassThroughEachOther) {
  const Tally coarse = throw_fibres(true, 60, 0.3), fine = throw_fibres(true, 60, 0.03);
  for (const Tally& found : {coarse, fine}) EXPECT_GT(3 * found.sum("met"), found.full ? 2 * found.cases : 0);
  EXPECT_LT(coarse.largest("balance"), 0.3);
  EXPECT_LT(fine.largest("balance"), 0.1 * coarse.largest("balance"));
  const Tally strings = throw_fibres(false, 20, 0.3);
  if (!strings.full) return;
  EXPECT_GT(4 * strings.sum("passed through"), strings.cases);
}

/// A straight fibre is led across a held one, so fast that it is within reach for a few steps or none. Where
/// it comes down is drawn: on the other, within the inner part of both; or beside it, out of its reach of
/// 0.2.
struct Throw {
  Specimen s;
  Stage stage;
  bool passes = false;
};
Throw draw_throw(Dice& dice) {
  const double R = 0.1, angle = dice(0.2, pi - 0.2), z = dice(0.3, 1.0);
  const Vec3d along{std::cos(angle), std::sin(angle), 0}, v{dice(-1, 1), dice(-1, 1), -1};
  const bool passes = dice(0, 1) < 0.5;
  // at z = 0: where on the held fibre, -1.5 to 1.5, and where on its own length it crosses the x axis
  const double x = dice(-1.3, 1.3),
               own = passes ? dice(-1.3, 1.3)
                            : (dice(0, 1) < 0.5 ? 1 : -1) * (1.5 + dice(0.25, 2) / std::sin(angle));
  const Vec3d middle = Vec3d{x, 0, 0} - own * along - z * v;  // -v takes it up to z
  Throw t{
      fibres({line({0, 0, 0}, {0.5, 0, 0}, 7), line({middle.x, middle.y, z}, 0.5 * along, 7)}, hertz(), R),
      {},
      passes};
  std::vector<ParticleId> still, moved;
  for (std::size_t p = 0; p < 14; ++p) (p < 7 ? still : moved).push_back(ParticleId{p});
  t.stage = moving(still, moved, v, std::exp(dice(std::log(0.02), std::log(3.0))), 8.0);
  return t;
}

// However far it goes in a step, the run ends as it passes, and only then.
TEST(Capsules, EndTheRunWhereTheyPassWithinAStep) {
  const Tally all = testing::campaign("fibres led across", 500, [](unsigned seed, Tally& passing) {
    Dice dice(seed);
    const Throw t = draw_throw(dice);
    bool told = false;
    Simulation run(t.s.model, t.stage, t.s.state);
    try {
      while (run.clock().time() < 2.0 + t.stage.dt) run.step();
    } catch (const Diverged& e) {
      told = std::string(e.what()).find("have passed through one another") != std::string::npos;
    }
    passing.add("pass", t.passes);
    return testing::Verdict{t.passes == told ? "right" : t.passes ? "missed" : "wrong"};
  });
  EXPECT_GT(3 * all.sum("pass"), all.full ? all.cases : 0);
}

/// A bond that breaks at this elongation.
BondRecipe weak(double elongation) {
  BondRecipe recipe = capsules(0.2);
  recipe.rules.strength = elongation_strength(elongation);
  return recipe;
}

// A fibre that breaks under another one lets it through, and the books close.
TEST(Capsules, OfBrokenBondsAreGone) {
  ContactModel contact = rough();
  contact.E = 2000.0;
  Specimen s = fibres({line({0, 0, 0}, {0.8, 0, 0}, 3), line({0.1, 0, 0.41}, {0, 0.8, 0}, 2)}, contact);
  for (Bond& b : s.state.bonds)
    if (b.i.value < 2)
      b = make_bond(weak(0.02), bond_site(s.model, s.state, b.i), bond_site(s.model, s.state, b.j)).value();
  for (const std::size_t p : {3u, 4u}) s.state.v[ParticleId{p}] = {0, 0, -1.5};
  Stage stage = plain_stage(1e-3, 4.0);
  stage.supports = {held({ParticleId{0}, ParticleId{2}}, clamped)};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_GE(run.breaks(), 1);
  EXPECT_LT(run.state().r[ParticleId{3}].z, -0.5);
  EXPECT_LT(std::abs(run.balance_error()), 2e-3);
}

// Two bonds that are made in the run: from then on a fibre that comes later rests on them.
TEST(Capsules, OfBondsMadeInTheRunTouch) {
  Specimen s = fibres({{{-0.5, 0, 0}}, {{0.5, 0, 0}}, line({0, 0, 0.5}, {0, 0.8, 0}, 2)}, hertz());
  for (const std::size_t p : {2u, 3u}) s.state.v[ParticleId{p}] = {0, 0, -0.2};
  Stage stage = plain_stage(2e-3, 6.0);
  stage.bonding = {{"late", {1, 1, 0, 0}, {1, 1, 0, 0}, 1.1, capsules(0.2)}};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_EQ(run.state().bonds.size(), 2u);
  EXPECT_GT(run.state().v[ParticleId{2}].z, -0.1);  // as it bounced, by equal masses
  EXPECT_GT(least_distance(run.state(), 2), 0.3);
  EXPECT_LT(std::abs(run.balance_error()), 1e-5);
}

// A fibre that lies on a held one breaks: the support's load before that counts the capsules that were there.
TEST(CapsulesBreak, LoadBeforeTheBreakCountsTheirContacts) {
  Specimen s = fibres({line({0, 0, 0}, {1, 0, 0}, 2), line({0.1, 0.2, 0.35}, {0, 1, 0}, 2)}, hertz());
  BondRecipe weak = capsules(0.2);
  weak.rules.strength = elongation_strength(0.01);
  s.state.bonds[BondId{1}] =
      make_bond(weak, bond_site(s.model, s.state, ParticleId{2}), bond_site(s.model, s.state, ParticleId{3}))
          .value();
  const std::vector<ParticleId> lower{ParticleId{0}, ParticleId{1}};
  Stage stage = plain_stage(1e-3, 100.0);
  stage.supports = {held(lower, clamped), held({ParticleId{2}}, clamped),
                    held({ParticleId{3}}, clamped, {0, 0.1, 0})};
  stage.stops.breaks = BreakStop{1};
  Simulation run(s.model, stage, s.state);
  Reaction before;
  for (int k = 0; run.breaks() == 0 && k < 1000; ++k) before = run.reaction(lower), run.step();
  ASSERT_EQ(run.breaks(), 1);
  EXPECT_GT(before.force.z, 0.1);  // the upper one pushes down: K sqrt(R) d^1.5 with d = 0.05
  const Reaction told = run.reaction(lower, LastBreaks::counted);
  EXPECT_NEAR(norm(told.force - before.force), 0.0, 1e-3 * norm(before.force));
  EXPECT_NEAR(norm(told.moment - before.moment), 0.0, 1e-3 * norm(before.moment));
  EXPECT_EQ(norm(run.reaction(lower).force), 0.0);
}

}  // namespace
}  // namespace vbond::capsule_motion_test
