// Bodies that come in during a run and particles that are taken out: random cases of both, held against plain
// formulas; the same bits for any number of threads and after a stop.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "campaigns/case_text.hpp"
#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "temporary_folder.hpp"
#include "vbond/case/read.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/run/run.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::passage_test {
namespace {

using testing::Dice;
using testing::number;
using testing::vector;

/// Of one grain, and of a bonded tetrahedron.
const std::string bodies =
    "[[specimen]]\nname = \"grain\"\nkind = \"list\"\npositions = [[0, 0, 0]]\nradius = 0.5\nmass = 1.0\n"
    "[[specimen]]\nname = \"cluster\"\nkind = \"list\"\n"
    "positions = [[0, 0, 0], [1, 0, 0], [0.5, 0.866, 0], [0.5, 0.289, 0.816]]\nradius = 0.4\nmass = 0.6\n";
std::string glue(const std::string& more = {}) {
  return "[[bonds]]\nname = \"glue\"\nbetween = [\"cluster\", \"cluster\"]\ndistance = 1.05\nE = 300.0\nnu = "
         "0.2\n"
         "theory = \"bernoulli-euler\"\nsection = { shape = \"circle\", diameter = 0.4 }\n" +
         more;
}
const std::string smooth = "[contact]\nlaw = \"linear\"\nk = 3000.0\n";
const std::string rough =
    "[contact]\nlaw = \"linear\"\nk = 3000.0\ntangential = \"linear\"\nk_t = 900.0\nfriction = "
    "0.4\nrestitution = 0.6\n";

/// A case and the body that it makes.
struct Made {
  Case c;
  Built built;
  explicit Made(const std::string& text) : c(parse_case(text, "case.toml")), built(build(c)) {}
  vbond::Run run(int threads = 1) const {
    return vbond::Run(built.model, built.state, stages_of(c), threads);
  }
};

/// Some pair that overlaps, or a particle and a wall, among these; plain loops over all and over images.
std::optional<std::string> overlap_of(const Model& m, const State& s, const std::vector<ParticleId>& news) {
  std::vector<Vec3d> ways{{}};
  if (!s.cell.empty()) {
    ways.clear();
    for (int a = -2; a <= 2; ++a)
      for (int b = -2; b <= 2; ++b)
        for (int c = -2; c <= 2; ++c)
          ways.push_back(double(a) * s.cell[0].along + double(b) * s.cell[1].along +
                         double(c) * s.cell[2].along);
  }
  const auto body = [&m](ParticleId p) {
    for (std::size_t k = 0; k < m.sources.size(); ++k)
      if (const auto n = m.sources[k].body_of(p)) return std::pair(k, *n);
    return std::pair(m.sources.size(), std::size_t{p.value});
  };
  for (const ParticleId p : news)
    for (const ParticleId q : s.r.ids()) {
      if (is_dropped(s, q) || is_waiting(s, q)) continue;
      for (const Vec3d& way : ways) {
        if (norm(way) == 0.0 && body(p) == body(q)) continue;
        if (p == q && norm(way) == 0.0) continue;
        if (norm(s.r[q] + way - s.r[p]) < (m.radius[p] + m.radius[q]) * (1.0 - 1e-12))
          return "particles " + std::to_string(p.value) + " and " + std::to_string(q.value);
      }
    }
  for (const ParticleId p : news)
    for (const Wall& w : m.walls)
      if (const auto* plane = std::get_if<PlaneWall>(&w.shape))
        if (dot(s.r[p] - plane->point, plane->normal) < m.radius[p] * (1.0 - 1e-12))
          return "particle " + std::to_string(p.value) + " and wall " + w.name;
  return std::nullopt;
}

std::vector<ParticleId> who_came(const State& before, const State& after) {
  std::vector<ParticleId> news;
  std::set_difference(before.waiting.begin(), before.waiting.end(), after.waiting.begin(),
                      after.waiting.end(), std::back_inserter(news));
  return news;
}

Vec3d momentum(const Model& m, const State& s) {
  Vec3d sum;
  for (const ParticleId p : m.mass.ids())
    if (!is_absent(s, p)) sum += m.mass[p] * s.v[p];
  return sum;
}

// ---- what comes in --------------------------------------------------------------------------------------

// One cluster, as it stands in the case, thrown and spinning under gravity, against the same body at that
// place from the start.
TEST(Passage, ABodyThatComesInFliesAsOneThatWasThereFromTheStart) {
  const std::string rest = glue("damping = { ratio = 0.1 }\n") + smooth +
                           "[time]\nstep = 0.002\n[[stage]]\nduration = 2.0\ngravity = [0, 0, -1]\n";
  const Made comes(bodies.substr(bodies.find("[[specimen]]\nname = \"cluster\"")) + rest +
                   "[[source]]\nname = \"s\"\nspecimen = \"cluster\"\ncount = 1\nvelocity = [0.3, 0.1, 1]\n"
                   "angular_velocity = [0.5, -1, 2]\norientation = \"given\"\nbox = { min = [-5, -5, -5], "
                   "max = [5, 5, 5] }\nseed = 3\n"
                   "every = 0.2\n");
  vbond::Run run = comes.run();
  run.step(100);
  ASSERT_EQ(run.current().waiting.size(), 4u) << "it is visited before the step that follows";
  run.step(600);
  const State& now = run.current();
  ASSERT_TRUE(now.waiting.empty());
  ASSERT_EQ(now.bonds.size(), 6u);
  // the same place: what the source draws follows from its key
  const Source& source = comes.built.model.sources[0];
  const auto at = place_of_try(comes.built.model, comes.built.state, source, 0, 100, 0);
  ASSERT_TRUE(at.has_value());
  std::string positions;
  for (const Vec3d& r : at->r) positions += (positions.empty() ? "" : ", ") + vector(r);
  const Made there("[[specimen]]\nname = \"cluster\"\nkind = \"list\"\npositions = [" + positions +
                   "]\nradius = 0.4\nmass = 0.6\n" + rest);
  State start = there.built.state;
  for (const ParticleId p : start.r.ids()) {
    start.v[p] = Vec3d{0.3, 0.1, 1} + cross(Vec3d{0.5, -1, 2}, at->r[p.value] - at->centre);
    start.omega[p] = {0.5, -1, 2};
  }
  vbond::Run flies(there.built.model, start, stages_of(there.c), 1);
  flies.step(600);
  const State& then = flies.current();
  for (const ParticleId p : then.r.ids()) {
    EXPECT_LT(norm(now.r[p] - then.r[p]), 1e-11) << "particle " << p.value;  // bonds are made in another pose
    EXPECT_LT(norm(now.v[p] - then.v[p]), 1e-11);
    EXPECT_LT(norm(now.omega[p] - then.omega[p]), 1e-11);
  }
  const double mass = 4 * 0.6;
  EXPECT_NEAR(now.mass.mass_in, mass, 1e-12);
  EXPECT_LT(norm(now.mass.momentum_in - mass * Vec3d{0.3, 0.1, 1}), 1e-12);
  // kinetic energy of a rigid body: of its centre, of its turning, and of each particle's own
  double kinetic = 0.5 * mass * norm2(Vec3d{0.3, 0.1, 1});
  for (const Vec3d& r : at->r)
    kinetic += 0.5 * 0.6 * norm2(cross(Vec3d{0.5, -1, 2}, r - at->centre)) +
               0.5 * 0.4 * 0.6 * 0.16 * norm2(Vec3d{0.5, -1, 2});
  EXPECT_NEAR(now.books.inserted, kinetic, 1e-9 * kinetic);
}

TEST(Passage, WhatWaitsTouchesNothingAndIsTouchedByNothing) {
  // a heap right at the place where grains wait that never come in, and the same without them
  const std::string heap =
      "[[specimen]]\nname = \"heap\"\nkind = \"block\"\ncells = [3, 3, 3]\nspacing = 0.98\norigin = [-1, -1, "
      "0.4]\n"
      "radius = 0.5\nmass = 1.0\n[[wall]]\nname = \"floor\"\nshape = \"plane\"\nnormal = [0, 0, 1]\n" +
      rough + "[time]\nstep = 0.002\n[[stage]]\nduration = 1.0\ngravity = [0, 0, -1]\n";
  const Made without(heap);
  const std::string grain = bodies.substr(0, bodies.find("[[specimen]]\nname = \"cluster\""));
  const Made with(heap + grain +
                  "[[source]]\nspecimen = \"grain\"\ncount = 40\nfrom = 0.9\nevery = 5\n"
                  "box = { min = [-5, -5, 20], max = [5, 5, 25] }\n");
  vbond::Run a = with.run();
  vbond::Run b = without.run();
  a.step(400), b.step(400);
  ASSERT_EQ(a.current().waiting.size(), 40u);
  for (const ParticleId p : b.current().r.ids()) {
    // their rows are in another order, and so are sums
    EXPECT_LT(norm(a.current().r[p] - b.current().r[p]), 1e-12);
    EXPECT_LT(norm(a.current().v[p] - b.current().v[p]), 1e-11);
  }
  EXPECT_NEAR(a.simulation()->energies().total(), b.simulation()->energies().total(), 1e-11);
  for (const ParticleId p : a.current().waiting) EXPECT_EQ(a.current().v[p], Vec3d{});
}

// ---- random cases -----------------------------------------------------------------------------------------

/// Sources and sinks of any kind over a floor, in a box, or in a periodic cell.
std::string random_case(Dice& dice) {
  const bool cell = dice.chance(0.3);
  std::string text = bodies;
  text += glue(dice.chance(0.5) ? "damping = { ratio = 0.1 }\n" : "");
  if (dice.chance(0.3))
    text +=
        "strength = { criterion = \"linear\", axial_force = 4, shear_force = 3, bending_moment = 1, torque = "
        "1 }\n";
  text += dice.chance(0.5) ? rough : smooth;
  if (cell) {
    text += "[cell]\na = [6, 0, 0]\nb = [0, 6, 0]\nc = [0, 0, 20]\ncorner = [-3, -3, 0]\nopen = [\"c\"]\n";
  } else {
    for (const auto& [name, point, normal] : {std::tuple("left", "[-3, 0, 0]", "[1, 0, 0]"),
                                              {"right", "[3, 0, 0]", "[-1, 0, 0]"},
                                              {"front", "[0, -3, 0]", "[0, 1, 0]"},
                                              {"back", "[0, 3, 0]", "[0, -1, 0]"}})
      text += std::string("[[wall]]\nname = \"") + name + "\"\nshape = \"plane\"\npoint = " + point +
              "\nnormal = " + normal + "\n";
  }
  text += "[[wall]]\nname = \"floor\"\nshape = \"plane\"\nnormal = [0, 0, 1]\n";
  text += "[time]\nstep = 0.001\n";
  const double half = cell && dice.chance(0.5) ? 3.5 : 2.9;
  for (const char* specimen : {"grain", "cluster"}) {
    text += std::string("[[source]]\nname = \"of_") + specimen + "s\"\nspecimen = \"" + specimen +
            "\"\ncount = " + std::to_string(dice.whole(1, 12)) + "\n";
    if (dice.chance(0.7)) text += "rate = " + number(dice(2.0, 40.0)) + "\n";
    if (dice.chance(0.4)) text += "stages = [\"one\"]\n";
    if (dice.chance(0.3)) text += "from = " + number(dice(0.05, 0.3)) + "\n";
    text += "every = " + number(dice(0.01, 0.1)) + "\n";
    const double low = dice(3.0, 5.0);
    if (dice.chance(0.7))
      text += "box = { min = " + vector({-half, -half, low}) + ", max = " + vector({half, half, low + 2.0}) +
              " }\n";
    else
      text += "sphere = { centre = " + vector({0, 0, low}) + ", radius = 2.2 }\n";
    if (dice.chance(0.3)) text += "fit = \"centre\"\n";
    if (dice.chance(0.3)) text += "orientation = \"given\"\n";
    text += "velocity = " + vector(Vec3d{0, 0, -1} + dice.vector(1.0)) + "\n";
    if (dice.chance(0.5)) text += "velocity_spread = 0.3\n";
    if (dice.chance(0.5)) text += "angular_velocity = " + vector(dice.vector(2.0)) + "\n";
    if (dice.chance(0.3)) text += "angular_velocity_spread = 0.5\n";
    text += "tries = " + std::to_string(dice.whole(1, 30)) +
            "\nseed = " + std::to_string(dice.whole(1, 1000)) + "\n";
  }
  if (dice.chance(0.8)) {
    text += "[[sink]]\n";
    if (dice.chance(0.3)) text += "group = \"grain\"\n";
    if (dice.chance(0.5)) text += "stages = [\"two\"]\n";
    text += "every = " + number(dice(0.01, 0.1)) + "\n";
    text += dice.chance(0.5)
                ? "half_space = { point = [0, 0, 0.7], normal = [0.2, 0, 1] }\n"
                : "box = { min = [-1, -10, -10], max = [100, 10, " + number(dice(1.0, 4.0)) + "] }\n";
  }
  text += "[[stage]]\nname = \"one\"\nduration = 0.6\ngravity = [0, 0, -10]\n";
  text +=
      "[[stage]]\nname = \"two\"\nduration = 0.6\ngravity = [0, 0, -10]\ndamping = { translation = 0.5 }\n";
  return text;
}

double error_of(const vbond::Run& run) {
  return run.simulation() != nullptr ? std::abs(run.simulation()->balance_error()) : 0.0;
}

testing::Verdict judge(unsigned seed, testing::Tally& tally) {
  Dice dice(seed);
  const std::string text = random_case(dice);
  const Made made(text);
  const Model& m = made.built.model;
  vbond::Run run = made.run();
  std::vector<State> stops;
  std::optional<State> last;
  double mass = 0.0;
  State before = run.current();
  while (!run.complete()) {
    if (run.step(1) == 0) continue;
    if (run.simulation() == nullptr) {  // the stage has ended
      before = run.current();
      continue;
    }
    const State& now = run.current();
    const std::vector<ParticleId> came = who_came(before, now);
    if (!came.empty()) {  // as it was right after the visit: one step back
      State at_visit = before;
      const Passage passed = visit(m, run.simulation()->stage(), at_visit);
      if (!passed.any_come || who_came(before, at_visit) != came)
        return testing::wrong("others came than are due");
      if (const auto who = overlap_of(m, at_visit, came)) return testing::wrong("overlap of " + *who);
      tally.add("came in", static_cast<double>(came.size()));
    }
    if (dice.chance(0.01)) stops.push_back(now);
    tally.below("error of the balance", error_of(run), 1e-2);
    before = now;
  }
  const State end = run.state();
  for (const ParticleId p : m.mass.ids())
    if (!is_absent(end, p)) mass += m.mass[p];
  if (std::abs(mass - end.mass.mass_in + end.mass.mass_out) > 1e-9) return testing::wrong("mass is missing");
  if (end.mass.particles_in - end.mass.particles_out != static_cast<std::int64_t>(present(end)))
    return testing::wrong("particles are missing");
  tally.add("taken out", static_cast<double>(end.mass.particles_out));
  for (const Bond& b : end.bonds)
    if (!b.broken && (is_absent(end, b.i) || is_absent(end, b.j)))
      return testing::wrong("a bond of who is absent");
  vbond::Run together = made.run();  // in one go
  together.run();
  if (!(together.state() == end)) return testing::wrong("another end in one go than step by step");
  for (const int threads : {2, 3}) {
    vbond::Run others = made.run(threads);
    others.run();
    if (!(others.state() == end))
      return testing::wrong("other bits with " + std::to_string(threads) + " threads");
  }
  const test::TemporaryFolder folder("vbond_passage");
  for (const State& stop : stops) {
    write_checkpoint(folder / "c.h5", m, {stop, {}}, "test");
    vbond::Run again(m, read_checkpoint(folder / "c.h5", m).state, stages_of(made.c), 1);
    again.run();
    if (!(again.state() == end))
      return testing::wrong("other bits after a stop at step " + std::to_string(stop.clock.step));
    tally.add("stops");
  }
  return {};
}

TEST(Passage, CampaignOfRandomSourcesAndSinks) {
  const testing::Tally all = testing::campaign("sources and sinks", 12, judge);
  EXPECT_EQ(all["wrong"] + all["missed"] + all["aborted"] + all["given up"], 0u);
  if (!all.full) return;
  EXPECT_GT(all.sum("came in"), 150.0);
  EXPECT_GT(all.sum("taken out"), 50.0);
  EXPECT_GT(all.sum("stops"), 60.0);
}

// What is due by `until` comes in, also if no visit falls on that time: rate (until - from), in all stages
// alike.
TEST(Passage, AllThatIsDueUntilTheEndOfASourceComesIn) {
  struct {
    const char* times;
    std::size_t in;
  } const cases[] = {{"rate = 10\nuntil = 1.3\n", 13},
                     {"rate = 10\nfrom = 0.2\nuntil = 1.3\n", 11},
                     {"from = 0.6\nuntil = 0.9\n", 40},
                     {"until = 0.1\n", 40},
                     {"rate = 10\nuntil = 1.0\n", 10}};
  for (const auto& [times, in] : cases) {
    const Made made(
        bodies.substr(0, bodies.find("[[specimen]]\nname = \"cluster\"")) +
        "[time]\nstep = 0.01\n[[stage]]\nduration = 3\n[[source]]\nspecimen = \"grain\"\ncount = 40\n"
        "every = 0.5\nbox = { min = [-50, -50, -50], max = [50, 50, 50] }\n" +
        times);
    vbond::Run run = made.run();
    run.step(299);
    EXPECT_EQ(40 - run.current().waiting.size(), in) << times;
  }
}

// Two grains that fly apart, one spinning: the sink takes its energy of motion, while a prestrained pair
// comes in at the same visit with its own. Overlaps inside of a body count as what it brings.
TEST(Passage, EnergyThatGoesIsThatOfWhatGoes) {
  const Made made(
      "[[specimen]]\nname = \"one\"\nkind = \"list\"\npositions = [[9, 0, 0]]\nradius = 0.5\nmass = 2.0\n"
      "[[specimen]]\nname = \"other\"\nkind = \"list\"\npositions = [[-9, 0, 0]]\nradius = 0.5\nmass = 1.0\n"
      "[[specimen]]\nname = \"pair\"\nkind = \"list\"\npositions = [[0, 0, 0], [0.9, 0, 0]]\nradius = "
      "0.5\nmass = 1.0\n" +
      smooth +
      "[[velocities]]\ngroup = \"one\"\nvelocity = [3, 0, 0]\nangular_velocity = [0, 4, 0]\n"
      "[time]\nstep = 0.001\n[[stage]]\nduration = 1\n"
      "[[source]]\nspecimen = \"pair\"\ncount = 1\norientation = \"given\"\nevery = 0.5\nvelocity = [0, 1, "
      "0]\n"
      "box = { min = [-3, -3, -3], max = [3, 3, 3] }\n"
      "[[sink]]\nbox = { min = [-10, -10, -10], max = [10, 10, 10] }\ntakes = \"outside\"\nevery = 0.5\n");
  vbond::Run run = made.run();
  run.step(501);
  const EnergyBooks& books = run.simulation()->books();
  EXPECT_EQ(run.current().mass.particles_out, 1);
  const double goes = 0.5 * 2.0 * 9.0 + 0.5 * made.built.model.inertia[ParticleId{0}] * 16.0,
               comes = 0.5 * 2.0 * 1.0 + 0.5 * 3000.0 * sq(0.1);
  EXPECT_NEAR(books.removed, goes, 1e-10);
  EXPECT_NEAR(books.inserted, comes, 1e-10);
}

// Without walls, gravity and friction with the outside the momentum of what is there is what came in less
// what went.
TEST(Passage, MomentumIsWhatCameInLessWhatWent) {
  const Made made(
      bodies + glue() + rough +
      "[time]\nstep = 0.001\n[[stage]]\nduration = 3\n"
      "[[source]]\nspecimen = \"grain\"\ncount = 60\nrate = 60\nevery = 0.05\nvelocity = [2, 0, 0]\n"
      "velocity_spread = 1\nbox = { min = [-3, -2, -2], max = [0, 2, 2] }\n"
      "[[source]]\nspecimen = \"cluster\"\ncount = 15\nrate = 20\nevery = 0.05\nvelocity = [-2, 0, 0]\n"
      "angular_velocity_spread = 1\nbox = { min = [2, -2, -2], max = [5, 2, 2] }\nseed = 2\n"
      "[[sink]]\nsphere = { centre = [0, 0, 0], radius = 4 }\ntakes = \"outside\"\nevery = 0.1\n");
  vbond::Run run = made.run();
  run.step(2800);
  const State& s = run.current();
  EXPECT_GT(s.mass.particles_out, 10);
  EXPECT_GT(s.mass.particles_in, 60);
  const Vec3d missing = momentum(made.built.model, s) - s.mass.momentum_in + s.mass.momentum_out;
  EXPECT_LT(norm(missing), 1e-11);  // of momenta of some hundred
  EXPECT_LT(error_of(run), 1e-3);   // of the scheme: it falls with the square of the step
}

}  // namespace
}  // namespace vbond::passage_test
