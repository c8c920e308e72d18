// Random small bodies that break at rest, against small load steps with plain equilibria.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "campaigns/judge.hpp"
#include "fracture_bodies.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond {
namespace {

using testing::clamp;
using testing::Dice;
using testing::fixed;
using testing::Specimen;
using testing::Walked;

struct Body {
  Specimen s;
  StaticStage stage;
};

Strength random_strength(Dice& dice) {
  const double N = dice(0.01, 0.03), V = dice(0.005, 0.03), M = dice(0.005, 0.03), T = dice(0.005, 0.03);
  return dice.chance(0.5) ? linear_strength(N, V, M, T) : quadratic_strength(N, V, M, T);
}

/// 4 to 12 particles, in a plane or not, bonded where they are near, between a clamp and a particle that is
/// drawn or pushed.
Body random_body(unsigned seed) {
  Dice dice(seed);
  const std::size_t n = dice.count(4, 12);
  const double depth = dice.chance(0.3) ? 0.0 : 1.0;
  std::vector<Vec3d> r{{0, 0, 0}};
  while (r.size() < n) {
    const Vec3d p{dice(0, 3), dice(-1, 1), depth * dice(-1, 1)};
    double nearest = 1e9;
    for (const Vec3d& q : r) nearest = std::min(nearest, norm(p - q));
    if (nearest > 0.6 && nearest < 1.2) r.push_back(p);  // bonded to one at least
  }
  Body body{testing::particles_at(r, 0.1), {}};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      if (norm(r[j] - r[i]) > 1.2) continue;
      BondRecipe recipe = testing::breakable({1.0, dice(0.02, 0.5), dice(0.02, 0.2), dice(0.02, 0.2)}, 1.0);
      if (dice.chance(0.3)) recipe.law = &bond_law<WithRules<Evm>::Law>;
      recipe.rules.strength = random_strength(dice);
      testing::bond(body.s, i, j, recipe);
    }
  const Vec3d way{dice(-0.2, 0.4), dice(-0.3, 0.3), dice(-0.3, 0.3)};
  if (dice.chance(0.6))
    body.stage = testing::static_stage(StageKind::fracture,
                                       {clamp(0), fixed({ParticleId{n - 1}}, testing::clamped, way)});
  else
    body.stage = testing::static_stage(StageKind::fracture, {clamp(0)}, {testing::pushed(n - 1, 0.2 * way)});
  return body;
}

struct Break {
  std::size_t bond;
  double load_factor;
};

/// A plain equilibrium from load factor f_0 to f_1; nothing if there is none.
std::optional<State> balance(const Body& body, const State& from, double f_0, double f_1) {
  StaticStage stage = body.stage;
  stage.kind = StageKind::equilibrium;
  for (Support& s : stage.supports) s.velocity = (f_1 - f_0) * s.velocity;
  for (PointLoad& l : stage.loads) l.force = f_1 * l.force, l.moment = f_1 * l.moment;
  try {
    StaticOutcome outcome = run_static_stage(body.s.model, stage, from, {});
    if (outcome.result.jumped || outcome.result.left_saddle) return std::nullopt;
    return std::move(outcome.state);
  } catch (const NoEquilibrium&) {
    return std::nullopt;
  }
}

std::optional<BondId> most_overloaded(const State& s) {
  std::optional<BondId> most;
  double largest = 1.0;
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (b.broken) continue;
    const double u = b.law->failure(b, bond_pose(b, s), no_history).utilisation;
    if (u >= largest) largest = u, most = k;
  }
  return most;
}

/// In this many equal steps of the load factor, one bond per balance.
std::vector<Break> by_small_steps(const Body& body, int steps, double up_to) {
  std::vector<Break> breaks;
  State s = body.s.state;
  double at = 0.0;
  for (int k = 1; k <= steps; ++k) {
    const double f = up_to * k / steps;
    std::optional<State> next = balance(body, s, at, f);
    for (; next; next = balance(body, s, f, f)) {
      s = *next;
      at = f;
      const std::optional<BondId> most = most_overloaded(s);
      if (!most) break;
      breaks.push_back({most->value, f});
      s.bonds[*most].broken = true;
    }
    if (!next) break;
  }
  return breaks;
}

/// Whether the order of breaks is the same as far as both go, and load factors are, within a step: those of
/// small steps are late, by less than one of them.
bool agree(const FractureResult& f, const std::vector<Break>& brute, double step) {
  if (f.breaks.size() != brute.size()) return false;
  for (std::size_t k = 0; k < brute.size(); ++k) {
    const BondUse& use = f.breaks[k].use;
    const double late = brute[k].load_factor - use.load_factor;
    if (use.bond.value != brute[k].bond || late < -1e-9 || late > step + 1e-9) return false;
  }
  return true;
}

// Bonds that come to their strength within one step of the brute force may break there in the other order:
// then steps are made finer. What ends a stage ends the small steps: no balance, or the load factor.
TEST(FractureCampaign, BreaksTheSameBondsAsSmallStepsDo) {
  constexpr int finest = 25600;
  const auto judge = [](unsigned seed, testing::Tally& tally) -> testing::Verdict {
    const Body body = random_body(seed);
    const Walked w = testing::walk(body.s, body.stage);
    const FractureResult& f = w.result.fracture;
    EXPECT_LT(std::abs(f.books.error()), 1e-9);
    tally.add("breaks", static_cast<double>(f.breaks.size()));
    const double reached = w.result.ended == "load factor" || f.breaks.empty()
                               ? w.result.load_factor
                               : f.breaks.back().use.load_factor;
    std::vector<Break> brute;
    for (int steps = 100; steps <= finest; steps *= 4) {
      const double up_to = std::min(1.0, reached + 1.0 / steps);
      brute = by_small_steps(body, steps, up_to);
      if (agree(f, brute, up_to / steps)) return {};
    }
    std::string text = "ended " + w.result.ended + ":";
    for (const BrokenBond& b : f.breaks)
      text += " " + std::to_string(b.use.bond.value) + "@" + std::to_string(b.use.load_factor);
    text += " | small steps:";
    for (const Break& b : brute) text += " " + std::to_string(b.bond) + "@" + std::to_string(b.load_factor);
    return testing::wrong(text);
  };
  const testing::Tally all = testing::campaign("fracture at rest", 50, judge);
  EXPECT_EQ(all["given up"], 0u);
  EXPECT_GT(all.sum("breaks"), all.full ? 2 * all.cases : 0);  // else little is compared
}

}  // namespace
}  // namespace vbond
