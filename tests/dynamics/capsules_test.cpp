// Bonds that touch as capsules: forces against the energy, conservation, exact impacts, sliding over the
// particles of a fibre, friction, random encounters, bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "rods.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond {
namespace {

using testing::Dice;
using testing::Specimen;

constexpr double pi = std::numbers::pi;

ContactModel hertz(double E = 100.0) {
  return {.law = ContactLaw::hertz, .pairs = ContactPairs::unbonded, .E = E, .nu = 0.0};
}
ContactModel rough(double friction = 0.4, double restitution = 1.0) {
  ContactModel c = hertz();
  c.surface = {.friction = friction, .restitution = restitution};
  c.tangential = TangentialForm::mindlin;
  return c;
}
/// 4/3 E* of hertz() for equal bodies.
constexpr double K = 4.0 / 3.0 * 50.0;

BondRecipe capsules(double radius) {
  BondRecipe recipe = testing::papers_bond();
  recipe.capsule = true, recipe.capsule_radius = radius;
  return recipe;
}

/// Chains of particles, each through these points, bonded as they stand; radius 0.2 unless said.
Specimen fibres(const std::vector<std::vector<Vec3d>>& chains, const ContactModel& contact, double R = 0.2,
                double mass = 1.0) {
  std::vector<Vec3d> r;
  for (const auto& chain : chains) r.insert(r.end(), chain.begin(), chain.end());
  Specimen s{equal_particles(r, mass, 0.4 * mass * sq(R), R), {}};
  s.model.contact = contact;
  s.state = at_rest(s.model);
  std::size_t first = 0;
  for (const auto& chain : chains) {
    for (std::size_t k = 0; k + 1 < chain.size(); ++k)
      testing::bond(s, first + k, first + k + 1, capsules(R));
    first += chain.size();
  }
  return s;
}
std::vector<Vec3d> line(const Vec3d& middle, const Vec3d& along, std::size_t particles) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < particles; ++k)
    r.push_back(middle + (static_cast<double>(k) - 0.5 * static_cast<double>(particles - 1)) * along);
  return r;
}
Loads loads_of(const Specimen& s) {
  return Simulation(s.model, testing::plain_stage(1e-3, 1.0), s.state).loads();
}
double energy_of(const Specimen& s) {
  return fibre_energy(s.model, s.state.bonds, s.state.r);
}
Vec3d total_moment(const Specimen& s, const State& state, const Loads& loads) {
  Vec3d sum;
  for (const ParticleId p : s.model.mass.ids()) sum += cross(state.r[p], loads.F[p]) + loads.M[p];
  return sum;
}
Vec3d total(const PerParticle<Vec3d>& F) {
  Vec3d sum;
  for (const Vec3d& x : F) sum += x;
  return sum;
}

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
  testing::bond(s, 2, 11, capsules(0.2));  // a branch of the first
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
    const std::size_t contacts = fibre_contacts(s.model, s.state.bonds, s.state.r).size();
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
    Simulation run(s.model, testing::plain_stage(2e-3, 1.0), s.state);
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
    testing::bond(s, 1, 3, capsules(0.2));
    testing::bond(s, 4, 1, capsules(0.2));
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
  const std::vector<FibreContact> contacts = fibre_contacts(s.model, s.state.bonds, s.state.r);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].a.i, ParticleId{1});
  EXPECT_EQ(contacts[0].b.i, ParticleId{7});
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

/// Two bars of two particles each, crossed at their middles.
Specimen crossed_bars(const ContactModel& contact, double speed) {
  Specimen s = fibres({line({0, 0, -0.201}, {0.8, 0, 0}, 2), line({0, 0, 0.201}, {0, 0.8, 0}, 2)}, contact);
  s.state.v = {{0, 0, speed}, {0, 0, speed}, {0, 0, -speed}, {0, 0, -speed}};
  return s;
}

// Bars that meet at their middles do not bend: Hertz's impact of two masses of 2 m, m* = m.
TEST(Capsules, MeetHeadOnAsTheOneDimensionalFormulaSays) {
  const double v = 2.0 * 0.05, m = 1.0, k = K * std::sqrt(0.1);
  const double deepest = std::pow(1.25 * m * v * v / k, 0.4), duration = 2.9432751 * deepest / v;
  const double dt = duration / 2000;
  Specimen s = crossed_bars(hertz(), 0.05);
  Simulation run(s.model, testing::plain_stage(dt, 1.0), s.state);
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
  EXPECT_LT(std::abs(run.balance_error(run.energies())), 1e-6);
}

TEST(Capsules, PartWithTheirRestitution) {
  for (const double e : {0.9, 0.5}) {
    ContactModel contact = hertz();
    contact.surface.restitution = e;
    Specimen s = crossed_bars(contact, 0.05);
    Simulation run(s.model, testing::plain_stage(2e-4, 1.0), s.state);
    for (int step = 0; step < 20000; ++step) run.step();
    EXPECT_TRUE(run.state().fibre_history.empty());
    EXPECT_NEAR(run.state().v[ParticleId{2}].z / 0.05, e, 1e-3);
    EXPECT_LT(std::abs(run.balance_error(run.energies())), 1e-3);
  }
}

/// A stage in which these particles move as said.
Stage moving(const std::vector<ParticleId>& still, const std::vector<ParticleId>& moved,
             const Vec3d& velocity, double dt, double duration) {
  Stage stage = testing::plain_stage(dt, duration);
  stage.supports = {testing::held(still, testing::clamped), testing::held(moved, testing::clamped, velocity)};
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
  EXPECT_LT(std::abs(run.balance_error(run.energies())), 1e-5);
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
    EXPECT_LT(std::abs(run.balance_error(run.energies())), 1e-3);
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
      s.state = std::move(run).take_state();
      s.state.clock = {.step = s.state.clock.step, .stage = s.state.clock.stage + 1};
    }
    EXPECT_GE(s.state.books.work_supports, -1e-6);
    slid += s.state.books.dissipated > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(slid, 15);
}

/// The least distance of the axes of two fibres, bond by bond.
double least_distance(const State& s, std::size_t particles_of_first) {
  double least = INFINITY;
  for (const Bond& a : s.bonds)
    for (const Bond& b : s.bonds)
      if (a.i.value < particles_of_first && b.i.value >= particles_of_first)
        least =
            std::min(least, std::sqrt(nearest_on_segments(s.r[a.i], s.r[a.j], s.r[b.i], s.r[b.j]).distance2));
  return least;
}

struct Campaign {
  int met = 0, passed = 0;
  double worst_balance = 0, momentum = 0;
};
Campaign throw_fibres(bool as_capsules, int count, double fraction) {
  Dice dice(5);
  Campaign found;
  for (int k = 0; k < count; ++k) {
    const auto any = [&](double size) {
      return Vec3d{dice(-size, size), dice(-size, size), dice(-size, size)};
    };
    const auto thrown = [&](double z) {
      const double angle = dice(0, pi);
      std::vector<Vec3d> r =
          line({dice(-0.5, 0.5), dice(-0.5, 0.5), z}, {0.5 * std::cos(angle), 0.5 * std::sin(angle), 0}, 7);
      for (Vec3d& x : r) x += any(0.06);
      return r;
    };
    ContactModel contact = dice(0, 1) < 0.5 ? rough(dice(0, 1), dice(0.3, 1)) : hertz();
    contact.E = 400.0;
    Specimen s = fibres({thrown(0.0), thrown(dice(0.7, 0.9))}, contact);
    const Vec3d v{dice(-0.2, 0.2), dice(-0.2, 0.2), -dice(0.1, 0.6)};
    for (std::size_t p = 7; p < 14; ++p) s.state.v[ParticleId{p}] = v + any(0.05);
    if (!as_capsules)
      for (Bond& b : s.state.bonds) b.capsule = 0.0;
    const double dt = fraction * step_bound(s.model, s.state).dt;
    Simulation run(s.model, testing::plain_stage(dt, 8.0), s.state);
    Vec3d before, after;
    for (const Vec3d& x : s.state.v) before += x;
    double least = INFINITY;
    while (run.clock().time() < 8.0) {
      run.step();
      least = std::min(least, least_distance(run.state(), 7));
    }
    for (const Vec3d& x : run.state().v) after += x;
    found.momentum = std::max(found.momentum, norm(after - before));
    found.met += least < 0.4 ? 1 : 0;
    found.passed += least < 0.2 ? 1 : 0;  // half through; a step goes less than 0.06
    found.worst_balance = std::max(found.worst_balance, std::abs(run.balance_error(run.energies())));
  }
  return found;
}

// Fibres thrown at one another at random. As balls on strings most pass through. The balance is of the order
// of the step: nearly parallel fibres, whose contact jumps along them, are the worst.
TEST(Capsules, NeverPassThroughEachOther) {
  const Campaign coarse = throw_fibres(true, 60, 0.3), fine = throw_fibres(true, 60, 0.03);
  for (const Campaign& found : {coarse, fine}) {
    EXPECT_GT(found.met, 40);
    EXPECT_EQ(found.passed, 0);
    EXPECT_LT(found.momentum, 1e-11);
  }
  EXPECT_LT(coarse.worst_balance, 0.1);
  EXPECT_LT(fine.worst_balance, 0.01);
  EXPECT_GT(throw_fibres(false, 20, 0.3).passed, 5);
}

TEST(Capsules, ThatPassThroughEachOtherEndTheRunByName) {
  Specimen s = crossed_bars(hertz(0.5), 1.0);
  Simulation run(s.model, testing::plain_stage(1e-3, 5.0), s.state);
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
  Simulation slow(s.model, testing::plain_stage(1e-3, 5.0), s.state);
  slow.step();
  ASSERT_EQ(slow.deep_capsules(0.1).size(), 1u);  // 0.15 of 0.2
  EXPECT_TRUE(slow.deep_capsules(0.8).empty());
  EXPECT_EQ(slow.deep_capsules(0.1)[0].first, "bond 0 (particles 0, 1)");
  EXPECT_EQ(slow.deep_capsules(0.1)[0].second, "bond 1 (particles 2, 3)");
  EXPECT_NEAR(slow.deep_capsules(0.1)[0].overlap, 0.151, 1e-3);
  EXPECT_FALSE(slow.fastest());
  // a quarter of the least radius in a step, against the mean of all
  Simulation fast(s.model, testing::plain_stage(0.06, 5.0), s.state);
  fast.step();
  EXPECT_TRUE(fast.fastest());
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
    Simulation run(s.model, testing::plain_stage(5e-3, 1e9), std::move(state), threads);
    EXPECT_EQ(run.threads() > 1, threads > 1);
    for (int k = 0; k < steps; ++k) run.step();
    return std::move(run).take_state();
  };
  const State whole = run_on(s.state, 1, 60);
  EXPECT_GT(whole.fibre_history.size(), 300u);
  EXPECT_TRUE(run_on(s.state, 3, 60) == whole);
  const State middle = run_on(s.state, 2, 25);
  EXPECT_TRUE(run_on(middle, 1, 35) == whole);
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
  Stage stage = testing::plain_stage(1e-3, 4.0);
  stage.supports = {testing::held({ParticleId{0}, ParticleId{2}}, testing::clamped)};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_GE(run.breaks(), 1);
  EXPECT_LT(run.state().r[ParticleId{3}].z, -0.5);
  EXPECT_LT(std::abs(run.balance_error(run.energies())), 2e-3);
}

// Two bonds that are made in the run: from then on a fibre that comes later rests on them.
TEST(Capsules, OfBondsMadeInTheRunTouch) {
  Specimen s = fibres({{{-0.5, 0, 0}}, {{0.5, 0, 0}}, line({0, 0, 0.5}, {0, 0.8, 0}, 2)}, hertz());
  for (const std::size_t p : {2u, 3u}) s.state.v[ParticleId{p}] = {0, 0, -0.2};
  Stage stage = testing::plain_stage(2e-3, 6.0);
  stage.bonding = {{"late", {1, 1, 0, 0}, {1, 1, 0, 0}, 1.1, capsules(0.2)}};
  Simulation run(s.model, stage, s.state);
  run.run();
  EXPECT_EQ(run.bonds().size(), 2u);
  EXPECT_GT(run.state().v[ParticleId{2}].z, -0.1);  // as it bounced, by equal masses
  EXPECT_GT(least_distance(run.state(), 2), 0.3);
  EXPECT_LT(std::abs(run.balance_error(run.energies())), 1e-5);
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
  Stage stage = testing::plain_stage(1e-3, 100.0);
  stage.supports = {testing::held(lower, testing::clamped), testing::held({ParticleId{2}}, testing::clamped),
                    testing::held({ParticleId{3}}, testing::clamped, {0, 0.1, 0})};
  stage.stops.breaks = BreakStop{1};
  Simulation run(s.model, stage, s.state);
  Reaction before;
  for (int k = 0; run.breaks() == 0 && k < 1000; ++k) before = run.reaction(lower), run.step();
  ASSERT_EQ(run.breaks(), 1);
  EXPECT_GT(before.force.z, 0.1);  // the upper one pushes down: K sqrt(R) d^1.5 with d = 0.05
  const Reaction told = run.reaction_before_breaks(lower);
  EXPECT_NEAR(norm(told.force - before.force), 0.0, 1e-3 * norm(before.force));
  EXPECT_NEAR(norm(told.moment - before.moment), 0.0, 1e-3 * norm(before.moment));
  EXPECT_EQ(norm(run.reaction(lower).force), 0.0);
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
    return FibreParts(s.model, s.state.bonds).near_pairs(s.state.r, margin).size();
  };
  EXPECT_EQ(pairs(thin, 0.08), pairs(with_ball, 0.08));
  const auto listed = [](const Specimen& s) {
    const Bodies bodies(s.model);
    Capsules of(s.model, bodies);
    of.bonds_changed(s.state.bonds);
    of.refresh();
    return of.near_pairs();
  };
  EXPECT_LT(listed(with_ball), 3 * listed(thin));
}

}  // namespace
}  // namespace vbond
