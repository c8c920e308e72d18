// Pressure at rest: its forces, its work, its part of the tangent.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "bodies.hpp"
#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "differences.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/statics/detail/body.hpp"
#include "vbond/terms/pressure/detail/rest_pressure.hpp"
#include "vbond/terms/pressure/pressed.hpp"

namespace vbond::pressure_at_rest {
namespace {

using testing::Dice;
using testing::Specimen;

Facet triangle(std::size_t i, std::size_t j, std::size_t k) {
  return {ParticleId{i}, ParticleId{j}, ParticleId{k}};
}
Facet strip(std::size_t i, std::size_t j) {
  return {ParticleId{i}, ParticleId{j}, ParticleId{i}};
}

/// The four sides of a tetrahedron: closed.
std::vector<Facet> tetrahedron(std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
  return {triangle(b, c, d), triangle(a, d, c), triangle(a, b, d), triangle(a, c, b)};
}

Pressure pressure(std::vector<Facet> facets, double p, PressureKind kind = PressureKind::follower) {
  Pressure on;
  on.group = "body", on.facets = std::move(facets), on.pressure = p, on.kind = kind;
  on.centre = {0.2, -3.0, 0.4};
  on.across = {0, 0.1, 1.2};
  return on;
}

enum class Surface { closed, open };

Pressure random_pressure(Dice& dice, std::size_t n, Surface surface, PressureKind kind) {
  const double p = dice(-0.02, 0.02);
  if (surface == Surface::closed) return pressure(tetrahedron(n - 1, n - 2, n - 3, n - 4), p, kind);
  std::vector<Facet> facets;
  while (facets.size() < 5) {
    const std::size_t i = dice.below(n), j = dice.below(n), k = dice.below(n);
    if (i != j && j != k && k != i) facets.push_back(dice.chance(0.5) ? triangle(i, j, k) : strip(i, j));
  }
  return pressure(std::move(facets), p, kind);
}

struct Case {
  Specimen body;
  StaticStage stage;
};

/// A random body, its first particle clamped and one held along slanted axes and moved; in each third some in
/// a rigid group.
Case random_case(unsigned seed, Surface surface, PressureKind kind) {
  Dice dice(seed);
  Case c{testing::random_body(dice), {}};
  const std::size_t n = c.body.model.particles();
  Support slanted = testing::fixed({ParticleId{1}}, {true, true, false, true, true, true});
  slanted.axes = testing::turned_axes(rotation_of(dice.vector(1.0)));
  slanted.velocity = 0.05 * slanted.axes->along[0];
  c.stage = testing::static_stage(StageKind::equilibrium,
                                  {testing::fixed({ParticleId{0}}, testing::clamped), slanted});
  if (seed % 3 == 0) {
    Support grip{"grip", {ParticleId{n - 1}, ParticleId{n - 2}}, {}, {}, {}, {}, true};
    c.stage.supports.push_back(grip);
  }
  c.stage.pressures = {random_pressure(dice, n, surface, kind), random_pressure(dice, n, surface, kind)};
  c.stage.pressures[1].constant = dice.chance(0.5);
  c.stage.newton.tolerance = 1e-12;
  return c;
}

// In balance the whole tangent is the derivative of the loads; where the surface is closed, or the forces are
// dead or central, it is symmetric.
void tangent_is_the_derivative(Surface surface, PressureKind kind) {
  const testing::Tally all = testing::campaign("tangent under pressure", 24, [&](unsigned seed) {
    const Case c = random_case(seed, surface, kind);
    const State end = run_static_stage(c.body.model, c.stage, c.body.state, {}).state;
    StaticBody body(c.body.model, c.stage, c.body.state);
    body.restore({end.r, end.q, 1.0});
    const testing::ByDifferences d = testing::by_differences(body);  // third derivatives are some 10
    EXPECT_LE((DenseMatrix(body.full_tangent()) - d.tangent).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LE((body.load_direction() - d.load_direction).cwiseAbs().maxCoeff(), 1e-7);
    const bool has_energy = surface == Surface::closed || kind != PressureKind::follower;
    EXPECT_EQ(body.has_moment_part(), !has_energy);
    EXPECT_EQ(body.terms().without_energy().has_value(), !has_energy);
  });
  EXPECT_LE(all["given up"], all.full ? all.cases / 6 : all.cases);
}

TEST(PressureAtRest, TangentOfClosedFollowersIsTheDerivative) {
  tangent_is_the_derivative(Surface::closed, PressureKind::follower);
}
TEST(PressureAtRest, TangentOfOpenFollowersIsTheDerivative) {
  tangent_is_the_derivative(Surface::open, PressureKind::follower);
}
TEST(PressureAtRest, TangentOfDeadForcesIsTheDerivative) {
  tangent_is_the_derivative(Surface::open, PressureKind::dead);
}
TEST(PressureAtRest, TangentOfCentralForcesIsTheDerivative) {
  tangent_is_the_derivative(Surface::open, PressureKind::central);
}

/// By plain formulas: what a pressure of 1 does to each particle.
std::vector<std::array<long double, 3>> plain_forces(const Pressure& p, const PerParticle<Vec3d>& found,
                                                     const PerParticle<Vec3d>& now) {
  using V = std::array<long double, 3>;
  const auto place = [](const PerParticle<Vec3d>& r, ParticleId q) { return V{r[q].x, r[q].y, r[q].z}; };
  const auto minus = [](const V& a, const V& b) { return V{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
  const auto times = [](const V& a, const V& b) {
    return V{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto length = [](const V& a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); };
  const PerParticle<Vec3d>& r = p.kind == PressureKind::follower ? now : found;
  std::vector<V> F(now.size(), V{});
  for (const Facet& f : p.facets) {
    const V ij = minus(place(r, f.j), place(r, f.i));
    const bool is_strip = f.k == f.i;
    const V area = is_strip ? times({p.across.x, p.across.y, p.across.z}, ij)  // z x r_ij: inwards
                            : times(minus(place(r, f.k), place(r, f.i)), ij);
    std::vector<ParticleId> corners{f.i, f.j};
    if (!is_strip) corners.push_back(f.k);
    for (const ParticleId q : corners)
      for (std::size_t x = 0; x < 3; ++x) F[q.value][x] += area[x] / (is_strip ? 2.0L : 6.0L);
  }
  if (p.kind != PressureKind::central) return F;
  for (const ParticleId q : now.ids()) {
    const V centre{p.centre.x, p.centre.y, p.centre.z};
    const V to = minus(centre, place(now, q)), first = minus(centre, place(found, q));
    long double size = 0.0L;  // of what points to the centre where the particle was found
    for (std::size_t x = 0; x < 3; ++x) size += F[q.value][x] * first[x] / length(first);
    for (std::size_t x = 0; x < 3; ++x) F[q.value][x] = size * to[x] / length(to);
  }
  return F;
}

// Places are of size 1 and known to 1e-16, forces some 1e-2: they differ by rounding.
TEST(PressureAtRest, ForcesAreThoseOfPlainFormulas) {
  testing::campaign("forces of pressure", 300, [](unsigned seed, testing::Tally& tally) {
    Dice dice(seed);
    Specimen s = testing::random_body(dice);
    StaticStage stage = testing::static_stage(StageKind::equilibrium, {});
    using enum PressureKind;
    const auto kind = dice.one_of({follower, dead, central});
    const auto surface = dice.one_of({Surface::closed, Surface::open});
    stage.pressures = {random_pressure(dice, s.model.particles(), surface, kind)};
    StaticBody body(s.model, stage, s.state);
    Vector x(body.unknowns().size());
    for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = dice(-0.3, 0.3);
    body.move(x, 0.7);
    const auto plain = plain_forces(stage.pressures[0], s.state.r, body.state().r);
    const Vector found = body.applied(0.7);
    double off = 0.0;
    for (std::size_t p = 0; p < plain.size(); ++p)
      for (std::size_t k = 0; k < 3; ++k) {
        const double wanted = static_cast<double>(0.7L * stage.pressures[0].pressure * plain[p][k]);
        off = std::max(off, std::abs(found[static_cast<Eigen::Index>(6 * p + k)] - wanted));
      }
    tally.below("error of a force", off, 1e-16);
  });
}

double volume_of(const std::vector<Facet>& facets, const PerParticle<Vec3d>& r) {
  double six = 0.0;
  for (const Facet& f : facets) six += dot(r[f.i], cross(r[f.j], r[f.k]));
  return six / 6.0;
}

// The work on any way between two placements: what the enclosed volume loses, times the pressure. It is that
// of the forces in between, here by Gauss's sum over the straight way of any surface.
TEST(PressureAtRest, WorkIsThatOfTheForces) {
  testing::campaign("work of pressure", 100, [](unsigned seed) {
    Dice dice(seed);
    Specimen s = testing::random_body(dice);
    StaticStage stage = testing::static_stage(StageKind::equilibrium, {});
    const bool closed = seed % 2 == 0;
    using enum PressureKind;
    stage.pressures = {random_pressure(dice, s.model.particles(), closed ? Surface::closed : Surface::open,
                                       closed ? follower : dice.one_of({follower, dead}))};
    StaticBody body(s.model, stage, s.state);
    Vector x(body.unknowns().size());
    for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = dice(-0.3, 0.3);
    const Placement from = body.placement();
    double gauss = 0.0;
    for (const double at : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
      body.restore(from);
      body.move(at * x, 1.0);
      const Vector F = body.applied(1.0);
      for (Eigen::Index k = 0; k < x.size(); ++k) gauss += 0.5 * F[k] * (k % 6 < 3 ? x[k] : 0.0);
    }
    body.restore(from);
    body.move(x, 1.0);
    const double work = body.work_of_loads(from, body.placement(), 1.0);
    EXPECT_NEAR(work, gauss, 1e-16);
    if (!closed) return;
    const auto& p = stage.pressures[0];
    EXPECT_NEAR(work, p.pressure * (volume_of(p.facets, from.r) - volume_of(p.facets, body.state().r)),
                1e-16);
  });
}

// An open surface has an energy where its edge is held; a lid on a box of six particles, of which the edge is
// held, and the same with one particle of the edge free.
TEST(PressureAtRest, HeldEdgesLeaveAnEnergy) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.4, 0.3}});
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.1, 0.05, 0.05};
  testing::bond_near(s, 1.2, recipe);
  StaticStage stage = testing::static_stage(StageKind::equilibrium, {});
  stage.pressures = {
      pressure({triangle(0, 1, 4), triangle(1, 2, 4), triangle(2, 3, 4), triangle(3, 0, 4)}, 0.1)};
  std::vector<ParticleId> edge{ParticleId{0}, ParticleId{1}, ParticleId{2}, ParticleId{3}};
  stage.supports = {testing::fixed(edge, testing::translations)};
  StaticBody held(s.model, stage, s.state, 1.0);
  EXPECT_FALSE(held.has_moment_part());
  stage.supports[0].particles.pop_back();
  StaticBody free(s.model, stage, s.state, 1.0);
  ASSERT_TRUE(free.terms().without_energy());
  EXPECT_NE(free.terms().without_energy()->find("free edge at particle 3"), std::string::npos);
  const Vec3d along = s.state.r[ParticleId{2}] - s.state.r[ParticleId{0}];  // of the edge that it is on
  // K_33 = p/6 [sum of the opposite edges]x, and their sum is the way between its two neighbours
  EXPECT_NEAR(free.terms().of<RestPressure>().largest_skew(),
              0.1 / 6.0 * (std::abs(along.x) + std::abs(along.y)), 1e-15);
}

// What a balance under followers is in statics it is in motion: the body stays. As followers_test.cpp.
TEST(PressureAtRest, MotionStaysInBalance) {
  const testing::Tally all = testing::campaign("pressure at rest", 12, [](unsigned k) {
    using enum PressureKind;
    Case c = random_case(3 * k - 1, k % 2 == 0 ? Surface::closed : Surface::open,
                         std::array{follower, dead, central}[k % 3]);
    c.stage.supports[1].velocity = {};
    for (Pressure& p : c.stage.pressures) p.constant = false;
    const State start = run_static_stage(c.body.model, c.stage, c.body.state, {}).state;
    Stage motion = testing::plain_stage(0.05, 20.0);
    for (const Support& held : c.stage.supports) {
      Support support;
      support.group = held.group, support.particles = held.particles, support.held = held.held;
      support.axes = held.axes;
      motion.supports.push_back(support);
    }
    motion.pressures = c.stage.pressures;
    // dead and central forces are those of the areas as the stage begins: those of the first state
    State begin = start;
    begin.pressed = facets_as_found(c.stage.pressures, c.body.state.r);
    begin.clock.stage_step = 1, begin.clock.dt = motion.dt;
    Simulation run(c.body.model, motion, begin);
    run.run();
    double moved = 0.0;
    for (const ParticleId p : start.r.ids()) moved = std::max(moved, norm(run.state().r[p] - start.r[p]));
    EXPECT_LE(moved, 1e-10);
  });
  EXPECT_LE(all["given up"], all.full ? all.cases / 6 : all.cases);
}

// A body that is turned, pressure and all, comes to rest turned.
TEST(PressureAtRest, DoesNotDependOnAxes) {
  testing::campaign("turned bodies under pressure", 12, [](unsigned seed) {
    Case c = random_case(seed, Surface::open, PressureKind::follower);
    c.stage.supports.resize(1);
    const State end = run_static_stage(c.body.model, c.stage, c.body.state, {}).state;
    Dice dice(seed + 1000);
    const Quatd turn = dice.rotation(3.0);
    const Specimen other = testing::turned(c.body, turn);
    StaticStage stage = c.stage;
    for (Pressure& p : stage.pressures) p.across = rotate(turn, p.across);
    const State there = run_static_stage(other.model, stage, other.state, {}).state;
    for (const ParticleId p : end.r.ids()) EXPECT_LE(norm(there.r[p] - rotate(turn, end.r[p])), 1e-9);
  });
}

}  // namespace
}  // namespace vbond::pressure_at_rest
