// Bonds with rules in random bodies: against a time loop with formulas of this test's own, and against the
// same body numbered and turned in another way.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "campaigns/plain_bodies.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/physics/far_from_breaking.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond::ruled_bonds_test {
namespace {

using testing::Body;
using testing::Dice;
using testing::draw_limits;
using testing::Specimen;
using testing::strength_of;

/// All forms of stretching, damping and criteria.
Body ruled_body(unsigned seed) {
  return testing::random_body(
      seed, {.damps_and_creeps = true, .breaks = true, .flows = false, .warms = false, .has_forms = true});
}

// The same bonds break in the same steps, and the particles are where the other loop has them: rounding of
// 1e-16 grows in 200 steps of such motion to well below 1e-9. A utilisation within 1e-9 of 1 could fall on
// either side: such a case would be counted as undecided, and must be rare.
TEST(RuledBonds, MoveAndBreakAsByFormulasOfTheTestsOwn) {
  const testing::Tally tally =
      testing::campaign("ruled bonds", 200, [](unsigned seed, testing::Tally& all) -> testing::Verdict {
        const Body body = ruled_body(seed);
        const Specimen& s = body.specimen;
        const double dt = 0.2 * step_bound(s.model, s.state).dt;
        Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
        testing::PlainMotion own(body);
        const auto off = [&own](const std::string& what) {
          return testing::Verdict{own.nearest < 1e-9 ? "undecided" : "wrong", what};
        };
        std::size_t seen = 0;
        for (int k = 0; k < 200; ++k) {
          run.step();
          const std::vector<std::size_t> broken = own.step(dt);
          if (run.events().size() != seen + broken.size()) return off("breaks at step " + std::to_string(k));
          for (const std::size_t b : broken)
            if (run.events()[seen++].bond != BondId{b}) return off("order of breaks");
        }
        all.add("breaks", static_cast<double>(seen));
        for (std::size_t p = 0; p < own.r.size(); ++p)
          if (!(norm(run.state().r[ParticleId{p}] - own.r[p]) < 1e-9))
            return off("place of " + std::to_string(p));
        return {};
      });
  EXPECT_LE(tally["undecided"], 1 + tally.cases / 500);
  EXPECT_GT(tally.sum("breaks"), tally.full ? tally.cases : 0.0);
}

// The loops work out the utilisation only of bonds whose bound is not below 1. Loads of these bonds are
// scaled until the criterion is reached exactly, or nearly so: there the bound must be past 1, and it must be
// of use far below.
TEST(RuledBonds, AreNearBreakingWhereverTheQuickBoundSaysThatTheyAreNot) {
  Dice dice(77);
  unsigned reached = 0, left_out = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    BondRules rules;
    testing::PlainLimits limits{1, 1, 1, 1};
    const auto criterion = static_cast<Criterion>(1 + trial % 7);
    draw_limits(criterion, dice, limits);
    rules.strength = strength_of(criterion, limits);
    if (trial % 2 == 0)
      rules.strength.compression = dice(0, 10), rules.strength.compression_bending = dice(0, 1e3);
    if (criterion == Criterion::mohr_coulomb && trial % 3 == 0) rules.strength.bending = dice(0, 10);
    const bool of_stresses = criterion == Criterion::stress || criterion == Criterion::fibre ||
                             criterion == Criterion::mohr_coulomb;
    rules.strength.own_section = of_stresses && trial % 4 < 2;
    auto law = WithRules<VModel>::Law<double>::from({1.0, dice(0.02, 0.5), dice(0.002, 0.1), 0.01}, 1.0,
                                                    dice(0, .3), dice(0, .3));
    law.rules = &rules, law.weakness = dice(-0.5, 1);
    const auto vector = [&](double size) { return dice.vector(size); };
    const Quatd q_i = rotation_of(vector(1.0)), q_j = rotation_of(vector(0.3)) * q_i;
    const BondFrames<double> frames{{1, 0, 0, 0}, {1, 0, 0, 0}};
    const Vec3d r_ij = rotate(q_i, Vec3d{1.0 + law.R_i + law.R_j, 0, 0}) + vector(0.1);
    const BondPose<double> pose = bond_pose(frames, r_ij, q_i, q_j);
    const BondAxis<double> axis = bond_axis(pose, law.R_i, law.R_j);
    const BondLoads<double> given{vector(dice(0, 1)), vector(dice(0, 0.1)), vector(dice(0, 0.1))};
    const auto scaled = [&](double x) {
      return BondLoads<double>{x * given.F, x * given.M_ij, x * given.M_ji};
    };
    double low = 0.0, high = 1.0;
    while (high < 1e6 && utilisation(law, pose, axis, scaled(high)) < 1.0) high *= 2.0;
    if (high >= 1e6) continue;  // in compression, or by its elongation
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (utilisation(law, pose, axis, scaled(middle)) < 1.0 ? low : high) = middle;
    }
    ++reached;
    EXPECT_GE(utilisation_bound(law, pose, axis, scaled(high)), 1.0)
        << "criterion " << static_cast<int>(criterion);
    left_out += utilisation_bound(law, pose, axis, scaled(0.2 * low)) < 1.0 ? 1 : 0;
  }
  EXPECT_GT(reached, 2000u);
  // at a fifth of these loads, a third was measured: `energy` has none, and random loads often press
  EXPECT_GT(left_out, reached / 4);
}

/// The same body, its particles numbered anew, its bonds in another order with their ends exchanged where
/// `swap` says so, and all of it turned.
Specimen renamed(const Specimen& s, const std::vector<std::size_t>& number, const Quatd& turn, Dice& dice) {
  Specimen to = s;
  for (const ParticleId p : s.state.r.ids()) {
    const ParticleId q{number[p.value]};
    to.state.r[q] = rotate(turn, s.state.r[p]);
    to.state.v[q] = rotate(turn, s.state.v[p]);
    to.state.omega[q] = rotate(turn, s.state.omega[p]);
    to.state.q[q] = turn * s.state.q[p];
  }
  to.model.r_0 = to.state.r;
  std::vector<Bond> bonds(s.state.bonds.begin(), s.state.bonds.end());
  for (std::size_t k = bonds.size(); k > 1; --k) {
    const auto other = static_cast<std::size_t>(dice(0, static_cast<double>(k)));
    std::swap(bonds[k - 1], bonds[other]);
  }
  to.state.bonds = {};
  for (Bond b : bonds) {
    b.i = ParticleId{number[b.i.value]}, b.j = ParticleId{number[b.j.value]};
    if (dice(0, 1) < 0.5) {               // by its own mirror: n_1 from the other end, n_2 as it was
      const Quatd half_turn{0, 0, 1, 0};  // about n_2
      std::swap(b.i, b.j), std::swap(b.R_i, b.R_j);
      set_frames(b, frame_j(b) * half_turn, b.frame_i * half_turn);
    }
    to.state.bonds.push_back(b);
  }
  return to;
}

using StepAndPairs = std::vector<std::pair<std::int64_t, std::pair<std::size_t, std::size_t>>>;

/// Steps and pairs of all bonds that break in 200 steps; pairs by these numbers, smaller first, in order.
StepAndPairs breaks_of(const Specimen& s, double dt, const std::vector<std::size_t>& number) {
  Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
  for (int k = 0; k < 200; ++k) run.step();
  StepAndPairs breaks;
  for (const BondEvent& e : run.events()) {
    const Bond& b = s.state.bonds[e.bond];
    const std::size_t i = number[b.i.value], j = number[b.j.value];
    breaks.push_back({e.step, {std::min(i, j), std::max(i, j)}});
  }
  std::sort(breaks.begin(), breaks.end());
  return breaks;
}

// A case could fall on the other side of a limit by rounding; with these seeds none does.
TEST(RuledBonds, BreakAlikeHoweverTheBodyIsNumberedAndTurned) {
  std::size_t breaks = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Specimen s = ruled_body(seed).specimen;
    Dice dice(seed + 1000);
    std::vector<std::size_t> same(s.model.particles()), number(s.model.particles()), back(number.size());
    for (std::size_t k = 0; k < same.size(); ++k) same[k] = number[k] = k;
    for (std::size_t k = number.size(); k > 1; --k)
      std::swap(number[k - 1], number[static_cast<std::size_t>(dice(0, static_cast<double>(k)))]);
    for (std::size_t k = 0; k < number.size(); ++k) back[number[k]] = k;
    const Quatd turn = rotation_of(dice.vector(2));
    const double dt = 0.2 * step_bound(s.model, s.state).dt;
    const StepAndPairs first = breaks_of(s, dt, same),
                       second = breaks_of(renamed(s, number, turn, dice), dt, back);
    EXPECT_EQ(first, second) << "seed " << seed;
    breaks += first.size();
  }
  EXPECT_GT(breaks, 100u);
}

}  // namespace
}  // namespace vbond::ruled_bonds_test
