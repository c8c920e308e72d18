// Random bodies that lose particles: the rest goes on as if they had been taken out by hand, with the same
// bits on any number of threads and after a checkpoint.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "campaigns/judge.hpp"
#include "run/dropping.hpp"
#include "temporary_folder.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/observe/checkpoint.hpp"

namespace vbond::drop_test {
namespace {

// ---- random bodies --------------------------------------------------------------------------------------

/// A heap of balls, in part bonded, between two walls, and one to three light ones that are shot at it or at
/// a wall, too fast for any contact to hold.
struct Shot {
  Specimen s;
  Stage stage;
  explicit Shot(unsigned seed, std::size_t side = 3) {
    Dice dice(seed);
    std::vector<Vec3d> r;
    std::vector<char> is_bullet;
    const auto n = static_cast<double>(side);
    for (std::size_t k = 0; k < side * side * side; ++k)
      r.push_back(Vec3d{static_cast<double>(k % side), static_cast<double>(k / side % side),
                        static_cast<double>(k / side / side)} +
                  dice.vector(0.02));
    is_bullet.resize(r.size(), 0);
    const int bullets = dice.whole(1, 3);
    for (int b = 0; b < bullets; ++b) {
      const auto at = static_cast<std::ptrdiff_t>(dice.below(r.size() + 1));
      const Vec3d from{n + 0.5 - 1.5 * b, b > 0 ? n + 1.0 : dice(0, n - 1), dice(0, n - 1)};
      r.insert(r.begin() + at, from);
      is_bullet.insert(is_bullet.begin() + at, static_cast<char>(1 + b));
    }
    s = testing::particles_at(r, dice(0.47, 0.5));
    const double k = dice(5.0, 20.0);
    s.model.contact = linear(k, dice(0.0, 0.6), dice(0.5, 1.0));
    if (dice.chance(0.3)) s.model.contact = {ContactLaw::paper_hertz, ContactPairs::unbonded, k, 1.0, 0, 0};
    s.model.contact.pairs = ContactPairs::unbonded;
    s.model.walls = {{"floor", PlaneWall{{0, 0, -0.5}, {0, 0, 1}}, 0, {}},
                     {"side", PlaneWall{{n + 1.5, 0, 0}, {-1, 0, 0}}, 0, {}}};
    double fastest = 0.0;
    for (const ParticleId p : s.model.mass.ids()) {
      const bool shot = is_bullet[p.value] != 0;
      s.model.mass[p] = shot ? dice(0.05, 0.3) : dice(0.7, 1.3);
      if (!shot) continue;
      // its motion is some ten times what a contact stores, k/2 of the radius squared at a wall
      const double speed = dice(3.0, 6.0) * std::sqrt(k / s.model.mass[p]);
      fastest = std::max(fastest, speed);
      s.state.v[p] = is_bullet[p.value] > 1 ? Vec3d{0, -speed, 0}
                     : dice.chance(0.5)     ? Vec3d{speed, 0, 0}
                                            : Vec3d{-speed, dice(-0.05, 0.05) * speed, 0};
    }
    BondRecipe recipe = testing::papers_bond();
    if (dice.chance(0.5)) recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
    if (dice.chance(0.3)) recipe.damping = {DampingBy::coefficients, {0.02, 0.002, 2e-4, 2e-4}};
    if (dice.chance(0.3)) recipe.rules.yield.limit = {0.01, 1e-3, 2e-4, 1e-4};
    if (dice.chance(0.3)) recipe.expansion = 1e-3;
    if (dice.chance(0.3))
      for (const ParticleId p : s.model.mass.ids()) make_top(s.model, p, {{0.064, 0.07, 0.08}, {}});
    if (dice.chance(0.6))
      for (std::size_t i = 0; i < r.size(); ++i)
        for (std::size_t j = i + 1; j < r.size(); ++j)
          if (is_bullet[i] == 0 && is_bullet[j] == 0 && norm(r[j] - r[i]) < 1.1 && dice.chance(0.5)) {
            testing::bond(s, i, j, recipe);
            const Bond& b = s.state.bonds[BondId{s.state.bonds.size() - 1}];
            if (recipe.expansion > 0.0)
              s.state.warm_bonds.push_back(
                  {BondId{s.state.bonds.size() - 1}, recipe.expansion, b.a, b.R_i, b.R_j});
          }
    stage = dropping(0.02 * step_bound(s.model, s.state).dt, 0.0);
    stage.gravity = {0, 0, dice(-0.01, 0.0)};
    if (dice.chance(0.3)) stage.b_translation = dice(0.0, 0.05);
    if (recipe.expansion > 0.0)
      stage.heating = {{s.model.groups[0].particles, dice(-10.0, 10.0), {{{0, 0}, {10.0 * stage.dt, 1}}}}};
    if (dice.chance(0.2)) stage.local_damping = dice(0.0, 0.3);
    stage.stops.duration = 4.0 * n / fastest + 200.0 * stage.dt;
  }
};

std::vector<ParticleId> others(const Model& m, const std::vector<ParticleId>& gone) {
  std::vector<ParticleId> stay;
  for (const ParticleId p : m.mass.ids())
    if (std::find(gone.begin(), gone.end(), p) == gone.end()) stay.push_back(p);
  return stay;
}

/// Steps alone up to the first loss, which the stepping tells after the step; nothing if there is none.
std::optional<ParticlesLost> first_loss(Simulation& sim) {
  try {
    sim.run();
  } catch (const ParticlesLost& lost) {
    return lost;
  }
  return std::nullopt;
}

void look_at(unsigned seed, testing::Tally& tally) {
  const Shot shot(seed);
  Simulation alone(shot.s.model, shot.stage, shot.s.state);
  alone.add_observer(watch());
  const auto lost = first_loss(alone);
  Watched w(shot.s, shot.stage);
  if (!lost) {
    w.run.run();
    EXPECT_TRUE(w.run.state().dropped.empty());
    return;
  }
  if (!lost->lost[0].other) tally.add("by walls");
  const State before = alone.state();
  w.run.step(before.clock.step);
  const State at = w.run.state();
  const double scale = alone.energies().kinetic() + std::abs(alone.energies().contact);
  tally.below("books", std::abs(missing(*w.run.simulation()) - missing(alone)) / scale, 1e-12);
  EXPECT_FALSE(at.dropped.empty());
  for (const ParticleId p : others(shot.s.model, at.dropped))  // nothing is done to the others
    EXPECT_TRUE(at.r[p] == before.r[p] && at.v[p] == before.v[p] && at.q[p] == before.q[p] &&
                at.omega[p] == before.omega[p])
        << "particle " << p.value;

  const Specimen rest = without({shot.s.model, before}, at.dropped);
  Stage stage = shot.stage;
  for (Heating& h : stage.heating) h.particles = rest.model.groups[0].particles;
  Simulation by_hand(rest.model, stage, rest.state);
  // its books still have those that are gone
  by_hand.add_observer(watch(without(w.observer->watch().record(), at.dropped), 1e9));
  const std::vector<ParticleId> stay = others(shot.s.model, at.dropped);
  const double stage_time = 100.0 * shot.stage.dt;
  tally.below("books", std::abs(w.run.simulation()->energies().total() - by_hand.energies().total()) / scale,
              1e-12);
  for (int k = 0; k < 100 && !w.run.complete(); ++k) {
    w.run.step(1);
    bool lost_again = false;
    try {
      by_hand.step();
    } catch (const ParticlesLost&) {
      lost_again = true;
    }
    if (w.run.complete()) break;
    EXPECT_EQ(lost_again, w.run.current().dropped.size() > at.dropped.size());
    if (lost_again) break;
    if (k == 0) tally.add("compared");
    for (std::size_t i = 0; i < stay.size(); ++i) {
      const State &one = w.run.current(), &other = by_hand.state();
      const ParticleId p{i};
      tally.below("way apart",
                  std::max({norm(one.r[stay[i]] - other.r[p]), stage_time * norm(one.v[stay[i]] - other.v[p]),
                            stage_time * norm(one.omega[stay[i]] - other.omega[p])}),
                  1e-12);
    }
  }
  if (!w.run.complete()) w.run.run();
  EXPECT_EQ(w.run.results().back().stop, StopReason::duration);
  tally.add("dropped", static_cast<double>(w.run.state().dropped.size()));
  tally.add("bodies with a loss", !w.run.state().dropped.empty());
}

// The rest is compared over 100 steps after the loss. Two sums of the same loads in another order differ by
// some roundings of 1e-16 of their terms; a contact makes of them 1 + sqrt(k/m) dt in a step at most, and dt
// is 0.02 of the critical one: 100 steps make less than e^4 of it. So 1e-12 of the radii, and of the
// energies, is a hundredfold more.
TEST(Drop, CampaignTheRestGoesOnAsIfItHadBeenTakenOutByHand) {
  const testing::Tally all = testing::campaign("shots", 150, look_at);
  EXPECT_GE(all.sum("bodies with a loss"), all.full ? all.cases / 2 : 0);
  EXPECT_GE(all.sum("by walls"), all.full ? all.cases / 10 : 0);
}

// ---- the same bits --------------------------------------------------------------------------------------

// 18^3 balls with friction are 40,000 in the units of work of which a thread gets 8,192 at least: four parts.
TEST(Drop, BitsDoNotDependOnThreads) {
  std::optional<State> first;
  for (const int threads : {1, 2, 4}) {
    Shot shot(2, 18);
    shot.s.model.contact = linear(10.0, 0.3, 0.8);
    shot.s.model.contact.pairs = ContactPairs::unbonded;
    for (Vec3d& v : shot.s.state.v)
      if (norm(v) > 0.0) v = 0.02 / (shot.stage.dt * norm(v)) * v;
    shot.stage.stops.duration = 250.0 * shot.stage.dt;
    Watched w(shot.s, shot.stage, threads);
    w.run.step(245);
    EXPECT_EQ(w.run.simulation()->times().threads, threads);
    const State s = w.run.state();
    EXPECT_FALSE(s.dropped.empty());
    if (!first) first = s;
    EXPECT_TRUE(s == *first) << threads << " threads";
  }
}

// From a checkpoint before, at and after each loss.
TEST(Drop, AResumedRunIsTheSameToTheLastBit) {
  const test::TemporaryFolder folder("vbond_drop");
  int tried = 0, with_two = 0;
  for (unsigned seed = 1; tried < 12; ++seed) {
    const Shot shot(seed);
    Watched whole(shot.s, shot.stage);
    std::vector<std::int64_t> at;
    std::vector<Checkpoint> checkpoints;
    std::size_t dropped = 0;
    while (!whole.run.complete()) {
      const std::size_t now = whole.run.current().dropped.size();
      if (now != dropped || whole.run.clock().stage_step % 150 == 100)
        checkpoints.push_back({whole.run.state(), whole.observer->watch().record()});
      dropped = now;
      whole.run.step(1);
    }
    if (dropped == 0) continue;
    ++tried, with_two += dropped > 1;
    for (const Checkpoint& c : checkpoints) {
      write_checkpoint(folder / "c.h5", shot.s.model, c, "test");
      const Checkpoint read = read_checkpoint(folder / "c.h5", shot.s.model);
      EXPECT_TRUE(read.state == c.state) << seed << ", step " << c.state.clock.step;
      Watched resumed({shot.s.model, read.state}, shot.stage, 1, read.watch);
      resumed.run.run();
      EXPECT_TRUE(resumed.run.state() == whole.run.state()) << seed << ", from step " << c.state.clock.step;
      EXPECT_TRUE(resumed.observer->watch().record() == whole.observer->watch().record()) << seed;
    }
  }
  EXPECT_GE(with_two, 1);
}

}  // namespace
}  // namespace vbond::drop_test
