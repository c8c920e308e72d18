// Bonds that touch as capsules: forces against the energy, conservation, what counts once, near pairs, bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "fibres.hpp"
#include "teams.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond::capsules_test {
namespace {

using namespace testing;

TEST(NearestOnSegments, IsTheLeastOfAllPoints) {
  Dice dice(1);
  const auto point = [&] { return Vec3d{dice(-1, 1), dice(-1, 1), dice(-1, 1)}; };
  for (int k = 0; k < 3000; ++k) {
    const Vec3d p = point(), q = point();
    Vec3d p_1 = point(), q_1 = point();
    if (k % 3 == 0) q_1 = q + dice(-2, 2) * (p_1 - p) + (k % 2 == 0 ? 0.0 : 1e-4) * point();  // near parallel
    if (k % 7 == 0) p_1 = p;
    const NearestOnSegments at = nearest_on_segments(p, p_1, q, q_1);
    EXPECT_GE(std::min(at.s, at.t), 0.0);
    EXPECT_LE(std::max(at.s, at.t), 1.0);
    EXPECT_NEAR(at.distance2, norm2(on_segment(q, q_1, at.t) - on_segment(p, p_1, at.s)), 1e-15);
    for (int l = 0; l < 50; ++l) {
      const double s = dice(0, 1), t = nearest_on_segment(on_segment(p, p_1, s), q, q_1);
      EXPECT_LE(at.distance2, norm2(on_segment(q, q_1, t) - on_segment(p, p_1, s)) + 1e-14);
    }
    const double distance = std::sqrt(at.distance2);
    const Vec3d apart = (on_segment(q, q_1, at.t) - on_segment(p, p_1, at.s)) / distance, other = point();
    EXPECT_TRUE(distance < 1e-3 || farther_apart_along(apart, p, p_1, q, q_1, distance - 1e-9));
    for (const Vec3d& n : {apart, other / norm(other)})
      EXPECT_FALSE(farther_apart_along(n, p, p_1, q, q_1, distance + 1e-14));
  }
}

/// Two bent fibres, one with a branch, and a ball, at random, that overlap at some places.
Specimen tangle(Dice& dice, const ContactModel& contact) {
  const auto bent = [&](const Vec3d& middle, const Vec3d& along, double by) {
    std::vector<Vec3d> r = line(middle, along, 5);
    for (Vec3d& x : r) x += Vec3d{dice(-by, by), dice(-by, by), dice(-by, by)};
    return r;
  };
  const double angle = dice(0, 1) < 0.3 ? dice(0.001, 0.02) : dice(0.1, 3.0);
  Specimen s = fibres({bent({0, 0, 0}, {0.7, 0, 0}, 0.1),
                       bent({dice(-2, 2), dice(-0.5, 0.5), dice(0.2, 0.45)},
                            {0.7 * std::cos(angle), 0.7 * std::sin(angle), 0}, 0.1),
                       {{dice(-1.5, 1.5), dice(-0.4, 0.4), dice(-0.45, -0.2)}},
                       {{dice(-0.3, 0.3), 0.7, dice(-0.2, 0.2)}}},
                      contact);
  bond(s, 2, 11, capsules(0.2));  // a branch of the first
  return s;
}

// Forces are the gradient of the energy wherever two fibres and a ball touch: inside bonds, at particles
// within a fibre, at ends, nearly parallel. Central differences err by 1e-10 for the least overlaps seen
// here.
TEST(Capsules, ForcesAreTheGradientOfTheEnergy) {
  Dice dice(2);
  int looked_at = 0, several = 0;
  double worst = 0.0, largest = 0.0;
  for (int k = 0; k < 300; ++k) {
    Specimen s = tangle(dice, hertz());
    const std::size_t contacts = fibre_contacts(s.model, s.state).size();
    if (contacts == 0) continue;
    ++looked_at, several += contacts > 1 ? 1 : 0;
    const Loads loads = loads_of(s);
    for (const Vec3d& M : loads.M) EXPECT_LT(norm(M), 1e-13);
    EXPECT_LT(norm(total(loads.F)), 1e-13);
    EXPECT_LT(norm(total_moment(s, s.state, loads)), 1e-12);
    constexpr double h = 1e-6;
    for (const ParticleId p : s.model.mass.ids())
      for (int axis = 0; axis < 3; ++axis) {
        const double x = component(s.state.r[p], axis);
        component(s.state.r[p], axis) = x + h;
        const double above = energy_of(s);
        component(s.state.r[p], axis) = x - h;
        const double below = energy_of(s);
        component(s.state.r[p], axis) = x;
        worst = std::max(worst, std::abs(component(loads.F[p], axis) + (above - below) / (2.0 * h)));
        largest = std::max(largest, std::abs(component(loads.F[p], axis)));
      }
  }
  EXPECT_GT(looked_at, 150);
  EXPECT_GT(several, 50);
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(worst, 1e-7);
}

// With friction and damping, too: what one feels the others give, about every point.
TEST(Capsules, KeepMomentumAndAngularMomentum) {
  Dice dice(3);
  int touched = 0;
  for (int k = 0; k < 40; ++k) {
    Specimen s = tangle(dice, rough(0.5, 0.4));
    for (const ParticleId p : s.model.mass.ids()) {
      s.state.v[p] = {dice(-1, 1), dice(-1, 1), dice(-1, 1)};
      s.state.omega[p] = {dice(-2, 2), dice(-2, 2), dice(-2, 2)};
    }
    Simulation run(s.model, plain_stage(2e-3, 1.0), s.state);
    for (int step = 0; step < 20; ++step) run.step();
    for (const FibreMemory& m : run.state().fibre_history) touched += m.history[0] != 0.0 ? 1 : 0;
    const Loads loads = run.loads();
    EXPECT_LT(norm(total(loads.F)), 1e-12);
    EXPECT_LT(norm(total_moment(s, run.state(), loads)), 1e-12);
  }
  EXPECT_GT(touched, 20);
}

// A straight fibre is touched as one cylinder, however many bonds it has: to the bit of rounding.
TEST(Capsules, OnAStraightFibreCountOnce) {
  const double d = 0.03;
  for (int k = 0; k <= 200; ++k) {
    const double x = -1.4 + 0.014 * k;  // over all bonds and particles
    for (const double angle : {0.5 * pi, 0.3}) {
      const Vec3d along{std::cos(angle), std::sin(angle), 0};
      const Specimen s =
          fibres({line({0, 0, 0}, {0.5, 0, 0}, 7), line({x, 0, 0.4 - d}, 0.5 * along, 4)}, hertz());
      EXPECT_NEAR(energy_of(s), 0.4 * K * std::sqrt(0.1) * std::pow(d, 2.5), 1e-15) << x;
    }
    const Specimen ball = fibres({line({0, 0, 0}, {0.5, 0, 0}, 7), {{x, 0, 0.4 - d}}}, hertz());
    EXPECT_NEAR(energy_of(ball), 0.4 * K * std::sqrt(0.1) * std::pow(d, 2.5), 1e-15) << x;
  }
}

// Where four fibres meet a ball is held by one contact, too.
TEST(Capsules, WhereFibresMeetCountOnce) {
  const double d = 0.03;
  for (double x = -0.3; x <= 0.3; x += 0.01) {
    Specimen s =
        fibres({line({0, 0, 0}, {0.7, 0, 0}, 3), {{0, 0.7, 0}}, {{0, -0.7, 0}}, {{x, 0, 0.4 - d}}}, hertz());
    bond(s, 1, 3, capsules(0.2));
    bond(s, 4, 1, capsules(0.2));
    EXPECT_NEAR(energy_of(s), 0.4 * K * std::sqrt(0.1) * std::pow(d, 2.5), 1e-15) << x;
  }
}

// Bonds thicker than they are long, 0.3 between particles of radius 0.2: neighbours of neighbours overlap.
TEST(Capsules, OfThickFibresDoNotTouchTheirNeighbours) {
  std::vector<Vec3d> bent;
  for (int k = 0; k < 10; ++k) bent.push_back({std::sin(0.2 * k) * 1.5, std::cos(0.2 * k) * 1.5, 0});
  EXPECT_EQ(energy_of(fibres({line({0, 0, 3}, {0.3, 0, 0}, 10), bent}, hertz())), 0.0);
}

// A fibre touches itself where it comes back, not where it bends.
TEST(Capsules, OfOneFibreTouchWhereItCrossesItself) {
  const std::vector<Vec3d> loop{{0, 0, 0},        {0.5, 0, 0},      {1, 0, 0},
                                {1.4, 0.3, 0.05}, {1.3, 0.8, 0.1},  {0.9, 1, 0.2},
                                {0.6, 0.7, 0.3},  {0.6, 0.2, 0.35}, {0.6, -0.3, 0.35}};
  const Specimen s = fibres({loop}, hertz());
  const std::vector<FibreContact> contacts = fibre_contacts(s.model, s.state);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].a.i.particle, ParticleId{1});
  EXPECT_EQ(contacts[0].b.i.particle, ParticleId{7});
  EXPECT_NEAR(energy_of(s), 0.4 * K * std::sqrt(0.1) * std::pow(0.05, 2.5), 1e-15);
}

// Over a fibre bent to either side, and over its end, force goes on without a jump: its change from place to
// place falls with their distance.
TEST(Capsules, SlideOverParticlesOfAFibreWithoutAJump) {
  for (const double bend : {-0.4, -0.1, 0.1, 0.4}) {  // against the side where it is touched
    const auto largest_change = [&](double step, double& largest) {
      double change = 0.0;
      std::optional<Vec3d> before;
      for (double x = -0.6; x < 1.0; x += step) {
        std::vector<Vec3d> chain = line({0, 0, 0}, {0.5, 0, 0}, 3);
        chain[1].z = bend * 0.25;
        const Specimen s = fibres(
            {chain, line({x, 0, 0.37 + chain[1].z * (1.0 - std::abs(x) / 0.5)}, {0, 0.6, 0}, 2)}, hertz());
        const Loads loads = loads_of(s);
        const Vec3d F = loads.F[ParticleId{3}] + loads.F[ParticleId{4}];
        if (before) change = std::max(change, norm(F - *before));
        before = F, largest = std::max(largest, norm(F));
      }
      return change;
    };
    double largest = 0.0;
    const double coarse = largest_change(2e-3, largest), fine = largest_change(2.5e-4, largest);
    EXPECT_GT(largest, 0.1) << bend;
    EXPECT_LT(fine, 0.25 * coarse) << bend;
    EXPECT_LT(fine, 0.02 * largest) << bend;
  }
}

TEST(Capsules, ThatPassThroughEachOtherEndTheRunByName) {
  Specimen s = crossed_bars(hertz(0.5), 1.0);
  Simulation run(s.model, plain_stage(1e-3, 5.0), s.state);
  try {
    run.run();
    FAIL() << "no force of this contact holds such bars";
  } catch (const Diverged& e) {
    EXPECT_NE(std::string(e.what()).find("bond 0 (particles 0, 1) and bond 1 (particles 2, 3)"),
              std::string::npos)
        << e.what();
  }
}

TEST(Capsules, ThatAreDeepOrFastAreTold) {
  Specimen s = crossed_bars(hertz(), 1.0);
  for (const std::size_t p : {0u, 1u}) s.state.r[ParticleId{p}].z = -0.05;
  Simulation slow(s.model, plain_stage(1e-3, 5.0), s.state);
  slow.step();
  ASSERT_EQ(slow.deep().capsules.deeper_than(0.1).size(), 1u);  // 0.15 of 0.2
  EXPECT_TRUE(slow.deep().capsules.deeper_than(0.8).empty());
  EXPECT_EQ(slow.deep().capsules.deeper_than(0.1)[0].first, "bond 0 (particles 0, 1)");
  EXPECT_EQ(slow.deep().capsules.deeper_than(0.1)[0].second, "bond 1 (particles 2, 3)");
  EXPECT_NEAR(slow.deep().capsules.deeper_than(0.1)[0].overlap, 0.151, 1e-3);
  EXPECT_FALSE(slow.deep().particles.fastest());
  // a quarter of the least radius in a step, against the mean of all
  Simulation fast(s.model, plain_stage(0.06, 5.0), s.state);
  fast.step();
  EXPECT_TRUE(fast.deep().particles.fastest());
}

TEST(Capsules, AreInTheStepBound) {
  Specimen s = crossed_bars(hertz(1e6), 0.0);
  const StepBound with = step_bound(s.model, s.state);
  EXPECT_NE(with.source.find("contacts"), std::string::npos);
  // a tenth of the sum of radii deep, k = 3/2 F/d; each bar's lighter end alone carries it: lambda <= 2 k/m
  const double k = 1.5 * (4.0 / 3.0 * 0.5e6) * std::sqrt(0.1) * std::sqrt(0.04);
  EXPECT_LT(with.dt, 2.0 / std::sqrt(2.0 * k));
  EXPECT_GT(with.dt, 0.5 * 2.0 / std::sqrt(2.0 * k));
}

/// Layers of short fibres, each across the one below.
Specimen felt(std::size_t per_side, std::size_t layers) {
  std::vector<std::vector<Vec3d>> chains;
  Dice dice(6);
  for (std::size_t z = 0; z < layers; ++z)
    for (std::size_t x = 0; x < per_side; ++x)
      for (std::size_t y = 0; y < per_side; ++y) {
        const bool turned = z % 2 == 1;
        const Vec3d middle{2.6 * double(x) + dice(0, 0.2), 2.6 * double(y) + dice(0, 0.2), 0.41 * double(z)};
        chains.push_back(line(middle, turned ? Vec3d{0, 0.5, 0} : Vec3d{0.5, 0, 0}, 5));
      }
  return fibres(chains, rough(0.4, 0.7));
}

// 18,000 particles: parts for two threads. Also with a resumption, by which pairs are listed anew.
TEST(Capsules, HaveTheSameBitsWithAnyThreadsAndAfterAnyResumption) {
  Specimen s = felt(30, 4);
  Dice dice(7);
  for (const ParticleId p : s.model.mass.ids()) s.state.v[p] = {dice(-1, 1), dice(-1, 1), dice(-1, 1)};
  const auto run_on = [&](State state, int threads, int steps) {
    Simulation run(s.model, plain_stage(5e-3, 1e9), std::move(state), threads);
    EXPECT_EQ(run.times().threads > 1, threads > 1);
    for (int k = 0; k < steps; ++k) run.step();
    return std::move(run).handover().state;
  };
  const State whole = run_on(s.state, 1, 60);
  EXPECT_GT(whole.fibre_history.size(), 300u);
  EXPECT_TRUE(run_on(s.state, 3, 60) == whole);
  const State middle = run_on(s.state, 2, 25);
  EXPECT_TRUE(run_on(middle, 1, 35) == whole);
}

// Pairs with particles within fibres follow from those of capsules, whatever the margin is.
TEST(CapsulesNear, PairsOfASmallMarginAreThoseOfALargeOneThatAreNear) {
  Dice dice(11);
  std::vector<std::vector<Vec3d>> chains{{{0.3, 0.2, 0.1}}};  // and a ball
  for (int k = 0; k < 40; ++k)
    chains.push_back(
        line({dice(-3, 3), dice(-3, 3), dice(-1, 1)}, {dice(-0.5, 0.5), dice(-0.5, 0.5), 0.2}, 6));
  const Specimen s = fibres(chains, hertz());
  using Pair = std::tuple<std::uint32_t, std::uint32_t, Image, int>;
  const auto near = [&s](double margin, double gap) {
    std::vector<Pair> pairs;
    for (const FibrePair& p : FibreParts(s.model, s.state.bonds).near_pairs(s.state.r, s.state.cell, margin))
      if (p.gap <= gap) pairs.emplace_back(p.first, p.second, p.of_second, p.weight);
    std::sort(pairs.begin(), pairs.end());
    EXPECT_TRUE(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end());
    return pairs;
  };
  const auto touching = near(0.0, 0.0);
  const auto is_within = [](const Pair& p) { return std::get<3>(p) < 0; };
  EXPECT_GT(std::count_if(touching.begin(), touching.end(), is_within), 20);
  EXPECT_EQ(touching, near(0.7, 0.0));
  EXPECT_EQ(near(0.3, 0.3), near(0.7, 0.3));
}

// Bonds without capsules say who may touch, and not who is near: when one breaks, the bodies that were near
// serve again. Loads are those of a list made anew, also after a capsule has gone.
TEST(CapsulesNear, AreTheSameAsListedAnewAfterAnyBondBreaks) {
  Specimen s = fibres({line({0, 0, -0.15}, {0.7, 0, 0}, 6), line({0, 0, 0.15}, {0.1, 0.7, 0}, 6)}, rough());
  bond(s, 2, 8, papers_bond());
  const BondId glue{s.state.bonds.size() - 1};
  const Bodies bodies(s.model);
  const Stage stage;
  const Team team = team_of(1, s.model.particles());
  Capsules kept(s.model, stage, bodies, s.state.cell);
  const auto look_at = [&](Capsules& of) {
    of.bonds_changed(s.state.bonds);
    of.refresh();
    of.work_out(team, 0.0);
    return of.near_pairs();
  };
  const std::size_t glued = look_at(kept);
  EXPECT_TRUE(kept.shares().empty());
  for (const BondId broken : {glue, BondId{2}}) {
    s.state.bonds[broken].broken = true;
    Capsules anew(s.model, stage, bodies, s.state.cell);
    EXPECT_EQ(look_at(kept), look_at(anew));
    EXPECT_GT(kept.near_pairs(), broken == glue ? glued : 0);
    ASSERT_EQ(kept.shares().size(), anew.shares().size());
    EXPECT_EQ(kept.shares().empty(), broken != glue);
    for (std::size_t k = 0; k < kept.shares().size(); ++k) {
      EXPECT_EQ(kept.shares()[k].F, anew.shares()[k].F);
      EXPECT_EQ(kept.shares()[k].M, anew.shares()[k].M);
    }
  }
}

// Few large balls among thin fibres make neither the cells nor the lists of these larger: as many pairs are
// near as without them, but for their own.
TEST(CapsulesNear, ListsOfFibresDoNotGrowWithTheLargestBall) {
  Dice dice(5);
  std::vector<std::vector<Vec3d>> chains;
  for (int k = 0; k < 60; ++k)
    chains.push_back(line({dice(-20, 20), dice(-20, 20), dice(0, 10)}, {0.7, 0, 0}, 8));
  const Specimen thin = fibres(chains, hertz());
  chains.push_back({{0, 0, -60}});
  Specimen with_ball = fibres(chains, hertz());
  with_ball.model.radius[ParticleId{with_ball.model.particles() - 1}] = 50.0;
  const auto pairs = [](const Specimen& s, double margin) {
    return FibreParts(s.model, s.state.bonds).near_pairs(s.state.r, s.state.cell, margin).size();
  };
  EXPECT_EQ(pairs(thin, 0.08), pairs(with_ball, 0.08));
  const auto listed = [](const Specimen& s) {
    const Bodies bodies(s.model);
    const Stage stage;
    Capsules of(s.model, stage, bodies, s.state.cell);
    of.bonds_changed(s.state.bonds);
    of.refresh();
    return of.near_pairs();
  };
  EXPECT_LT(listed(with_ball), 3 * listed(thin));
}

}  // namespace
}  // namespace vbond::capsules_test
