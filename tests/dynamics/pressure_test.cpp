// Pressure in motion: the books close, closed skins push nothing away, and threads and resuming change no
// bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "rods.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/terms/pressure/pressed.hpp"

namespace vbond::pressure_in_motion {
namespace {

using testing::Dice;
using testing::Specimen;

Facet triangle(std::size_t i, std::size_t j, std::size_t k) {
  return {ParticleId{i}, ParticleId{j}, ParticleId{k}};
}

/// An octahedron with a particle in its middle, bonded all round, facets outwards.
Specimen octahedron() {
  Specimen s = testing::particles_at(
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0.05, 0.02, -0.03}});
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{0.6, 0.1, 0.05, 0.05};
  testing::bond_near(s, 1.6, recipe);
  return s;
}
std::vector<Facet> sides() {
  return {triangle(0, 2, 4), triangle(2, 1, 4), triangle(1, 3, 4), triangle(3, 0, 4),
          triangle(2, 0, 5), triangle(1, 2, 5), triangle(3, 1, 5), triangle(0, 3, 5)};
}

Pressure pressure(PressureKind kind, std::vector<Facet> facets = sides()) {
  Pressure p;
  p.group = "body", p.facets = std::move(facets), p.pressure = 0.02, p.kind = kind;
  p.centre = {0.1, 0.2, 3.0}, p.across = {0, 0.3, 1};
  p.factor.points = {{0, 0.3}, {15, 1}, {30, -0.5}};
  return p;
}

Stage stage_with(const Pressure& p, double dt, double duration) {
  Stage stage = testing::plain_stage(dt, duration);
  stage.pressures = {p};
  return stage;
}

Specimen lively(Specimen s) {
  Dice dice(5);
  for (const ParticleId p : s.state.r.ids())
    s.state.v[p] = dice.vector(0.05), s.state.omega[p] = dice.vector(0.05);
  return s;
}

double largest_error(const Pressure& p, double dt) {
  const Specimen s = lively(octahedron());
  Simulation run(s.model, stage_with(p, dt, 40.0), s.state);
  double largest = 0.0;
  while (run.state().clock.time() < 40.0 - 0.5 * dt) {
    run.step();
    largest = std::max(largest, std::abs(run.balance_error()));
  }
  EXPECT_GT(std::abs(run.state().books.work_loads), 1e-4);
  return largest;
}

// Leap-frog's error is of second order; what the pressure does is in the books to rounding. Its work is some
// hundredth of the energies: without it the error would not depend on the step.
TEST(PressureInMotion, BooksClose) {
  const std::vector<Facet> open{
      triangle(0, 2, 4), triangle(1, 3, 5), {ParticleId{0}, ParticleId{6}, ParticleId{0}}};
  for (const auto& p : {pressure(PressureKind::follower), pressure(PressureKind::dead, open),
                        pressure(PressureKind::central), pressure(PressureKind::follower, open)}) {
    const double coarse = largest_error(p, 0.1), fine = largest_error(p, 0.05);
    EXPECT_LT(coarse, 5e-3);
    EXPECT_NEAR(coarse / fine, 4.0, 0.5);
  }
}

// The work of a constant pressure on a closed skin is what the volume loses, up to the curvature of the way
// in a step, which is of third order in it.
TEST(PressureInMotion, WorkIsThatOfTheVolume) {
  const Specimen s = lively(octahedron());
  Pressure p = pressure(PressureKind::follower);
  p.factor = {};
  const double before = size_of(p.facets, {}, s.state.r).volume;
  double error[2];
  for (const int k : {0, 1}) {
    Simulation run(s.model, stage_with(p, k == 0 ? 0.1 : 0.05, 20.0), s.state);
    run.run();
    const double lost = before - size_of(p.facets, {}, run.state().r).volume;
    EXPECT_GT(std::abs(lost), 1e-3);
    error[k] = std::abs(run.state().books.work_loads - p.pressure * lost) / (p.pressure * std::abs(lost));
  }
  EXPECT_LT(error[0], 1e-2);
  EXPECT_LT(error[1], 0.35 * error[0]);
}

// A closed skin that is pressed on stays where it is and does not begin to turn.
TEST(PressureInMotion, ClosedSkinsKeepMomentumAndAngularMomentum) {
  const Specimen s = octahedron();
  Simulation run(s.model, stage_with(pressure(PressureKind::follower), 0.1, 30.0), s.state);
  run.run();
  Vec3d momentum, turning;
  double moved = 0.0;
  for (const ParticleId p : s.state.r.ids()) {
    const Vec3d P = s.model.mass[p] * run.state().v[p];
    momentum += P;
    turning += cross(run.state().r[p], P) + s.model.inertia[p] * run.state().omega[p];
    moved = std::max(moved, norm(run.state().r[p] - s.state.r[p]));
  }
  EXPECT_GT(moved, 1e-3);
  EXPECT_LE(norm(momentum), 1e-13);  // 300 steps of some ten forces of 1e-2, each rounded
  EXPECT_LE(norm(turning), 1e-13);
}

/// A sheet of 100 x 160 particles, its triangles pressed on from below; threads work on more than one block.
Specimen sheet(std::vector<Facet>& facets) {
  constexpr std::size_t width = 100, height = 160;
  std::vector<Vec3d> r;
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x)
      r.push_back(
          {static_cast<double>(x) + 0.5 * static_cast<double>(y % 2), 0.866 * static_cast<double>(y), 0});
  Specimen s = testing::particles_at(r);
  const auto at = [](std::size_t x, std::size_t y) { return x + width * y; };
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x + 1 < width; ++x) {
      testing::bond(s, at(x, y), at(x + 1, y), testing::papers_bond());
      if (y + 1 == height) continue;
      testing::bond(s, at(x, y), at(x, y + 1), testing::papers_bond());
      facets.push_back(triangle(at(x, y), at(x + 1, y), at(x, y + 1)));
      facets.push_back(triangle(at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)));
    }
  return s;
}

TEST(PressureInMotion, BitsDoNotDependOnThreads) {
  std::vector<Facet> facets;
  const Specimen s = sheet(facets);
  Pressure p = pressure(PressureKind::follower, facets);
  p.pressure = 1e-4;
  State ends[2];
  for (const int threads : {1, 4}) {
    Simulation run(s.model, stage_with(p, 0.1, 2.0), s.state, threads);
    run.run();
    ends[threads == 1 ? 0 : 1] = run.state();
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(PressureInMotion, ResumingChangesNoBit) {
  for (const PressureKind kind : {PressureKind::follower, PressureKind::dead, PressureKind::central}) {
    const Specimen s = lively(octahedron());
    const Stage stage = stage_with(pressure(kind), 0.1, 30.0);
    Simulation whole(s.model, stage, s.state);
    whole.run();
    Simulation first(s.model, stage, s.state);
    for (int k = 0; k < 137; ++k) first.step();
    Stage under_way = stage;  // as a case has it: its facets are in the state
    under_way.pressures[0].facets = {};
    Simulation second(s.model, under_way, first.state());
    second.run();
    EXPECT_EQ(whole.state(), second.state());
    EXPECT_FALSE(whole.state().pressed.empty());
  }
}

// The step bound knows what pressure adds: at a hundred times the stiffness of bonds it sets the step.
TEST(PressureInMotion, SetsTheStepWhereItIsLarge) {
  const Specimen s = octahedron();
  Stage stage = stage_with(pressure(PressureKind::follower), 0.1, 30.0);
  const double without = step_bound(s.model, s.state).dt,
               with_little = step_bound(s.model, s.state, stage).dt;
  EXPECT_LT(with_little, without);
  EXPECT_GT(with_little, 0.95 * without);
  stage.pressures[0].pressure = 100.0;
  const StepBound large = step_bound(s.model, s.state, stage);
  EXPECT_LT(large.dt, 0.3 * without);
  EXPECT_NE(large.source.find("pressure"), std::string::npos);
}

TEST(PressureInMotion, MistakesAreNamed) {
  const Specimen s = octahedron();
  const auto mistake = [&](const std::function<void(Stage&)>& change) {
    Stage stage = stage_with(pressure(PressureKind::follower), 0.1, 30.0);
    change(stage);
    const auto found = mistakes_in(s.model, stage);
    return found.empty() ? std::string("none") : found.front();
  };
  EXPECT_EQ(mistake([](Stage&) {}), "none");
  EXPECT_NE(mistake([](Stage& t) { t.pressures[0].pressure = NAN; }).find("is nan"), std::string::npos);
  EXPECT_NE(mistake([](Stage& t) { t.pressures[0].facets[3].j = ParticleId{99}; }).find("names particle 99"),
            std::string::npos);
  EXPECT_NE(mistake([](Stage& t) { t.pressures[0].facets[3].j = t.pressures[0].facets[3].i; }).find("twice"),
            std::string::npos);
  EXPECT_NE(mistake([](Stage& t) { t.pressures[0].constant = true; }).find("constant"), std::string::npos);
  EXPECT_NE(mistake([](Stage& t) { t.on_unphysical = OnUnphysical::drop; }).find("none may be dropped"),
            std::string::npos);
  Stage nowhere = stage_with(pressure(PressureKind::follower, {}), 0.1, 30.0);
  EXPECT_THROW(Simulation(s.model, nowhere, s.state), std::invalid_argument);
}

}  // namespace
}  // namespace vbond::pressure_in_motion
