#include <random>

#include "cases.hpp"
#include "vbond/model/contact_bound.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/model/turn_bound.hpp"
#include "vbond/physics/bond_step.hpp"
#include "vbond/physics/hertz.hpp"

namespace vbond::test {
namespace {

// References of this rod: the element bound 0.15915494309189535 = 1/(2 pi) T_0 and the exact limit
// 0.16113882947731828 T_0 of its stiffness and mass matrices (tests/data/statics.json, stability_limits).
TEST(StepBound, OfThePapersRodIsJustBelowItsExactLimit) {
  const Built b = build(paper_rod());
  const StepBound bound = step_bound(b.model, b.state);
  EXPECT_NEAR(bound.dt / b.model.T_0, 0.15915494309189535, 1e-15);
  EXPECT_LT(bound.dt / b.model.T_0, 0.16113882947731828);
  ASSERT_TRUE(bound.bond.has_value());
  const Bond& bond = b.state.bonds[*bound.bond];
  EXPECT_EQ(bound.source, "stretching of bond " + std::to_string(bound.bond->value) + " (particles " +
                              std::to_string(bond.i.value) + ", " + std::to_string(bond.j.value) + ")");
}

Case pair_with(const BondStiffness<double>& c_ij) {
  Case c = case_of(RodSpecimen{2, 1.0, {}, {1, 0, 0}});
  c.bonds = {bonds_within(1.1)};
  c.bonds[0].recipe.parameters = c_ij;
  return c;
}

// Two equal particles and one bond: m = 1, Theta = 0.064, l = 1/2, frequencies known in closed form
// sqrt(2 c_A/m), sqrt(2 c_T/Th), sqrt(2 c_B/Th), sqrt(c_D (2/m + 2 l^2/Th)), and the bound is exact.
TEST(StepBound, OfAPairIsExactAndNamesTheMotion) {
  const double Th = 0.064, shear = 2.0 + 0.5 / Th;
  const std::tuple<BondStiffness<double>, double, std::string> cases[] = {
      {{1.0, 0.01, 0.001, 0.001}, 2.0, "stretching of bond 0 (particles 0, 1)"},
      {{1.0, 0.01, 0.001, 0.5}, 1.0 / Th, "torsion of bond 0 (particles 0, 1)"},
      {{1.0, 0.01, 0.3, 0.001}, 0.6 / Th, "shear and bending of bond 0 (particles 0, 1)"},
      {{1.0, 0.7, 0.001, 0.001}, 0.7 * shear, "shear and bending of bond 0 (particles 0, 1)"}};
  for (const auto& [c_ij, lambda, source] : cases) {
    const Built b = build(pair_with(c_ij));
    const StepBound bound = step_bound(b.model, b.state);
    EXPECT_DOUBLE_EQ(bound.dt, 2.0 / std::sqrt(lambda)) << source;
    EXPECT_EQ(bound.source, source);
  }
}

TEST(StepBound, IsInfiniteWhenNothingIsElastic) {
  const Built b = build(case_of(RodSpecimen{3, 1.0, {}, {1, 0, 0}}));
  const StepBound bound = step_bound(b.model, b.state);
  EXPECT_TRUE(std::isinf(bound.dt));
  EXPECT_FALSE(bound.bond.has_value());
}

// Equal particles, m = 1, R = 0.4, c_H = a = 1: at an overlap of 10 % of 2R the pair has
// lambda = 2 * 1.5 sqrt(0.08), added to the rod's 4.
TEST(StepBound, ContactsAddATenthOfOverlap) {
  Case c = paper_rod();
  c.contact.law = ContactLaw::paper_hertz;
  c.contact.c_H = 1.0;
  const Built b = build(c);
  const StepBound bound = step_bound(b.model, b.state);
  EXPECT_DOUBLE_EQ(bound.dt, 2.0 / std::sqrt(4.0 + 3.0 * std::sqrt(0.08)));
  EXPECT_TRUE(contains(bound.source, ", and contacts")) << bound.source;
}

// Three particles in a row overlap by 0.2 (a quarter of 2R); the middle one has two contacts.
TEST(StepBound, PresentOverlapCountsIfItIsMore) {
  Case c = case_of(RodSpecimen{3, 0.6, {}, {1, 0, 0}});
  c.contact.law = ContactLaw::paper_hertz;
  c.contact.c_H = 1.0;
  Built b = build(c);
  EXPECT_NEAR(step_bound(b.model, b.state).dt, 2.0 / std::sqrt(2.0 * 3.0 * std::sqrt(0.2)), 1e-14);
  // bonded neighbours do not touch if only unbonded pairs do, and second neighbours are 1.2 apart
  c.bonds = {bonds_within(0.7)};
  b = build(c);
  Model without_contact = b.model;
  without_contact.contact.law = ContactLaw::none;
  const double bonds_alone = step_bound(without_contact, b.state).dt;
  const double lambda = 4.0 / (bonds_alone * bonds_alone) + 3.0 * std::sqrt(0.08);
  EXPECT_NEAR(step_bound(b.model, b.state).dt, 2.0 / std::sqrt(lambda), 1e-14);
}

// The estimate for unequal spheres is never above what any pair of them gives, here all pairs by force.
TEST(StepBound, ContactsOfUnequalSpheresAreBoundedByTheWorstPair) {
  Case c = case_of(ListedSpecimen{{{0, 0, 0}}});
  c.specimens[0].mass.reset();
  c.specimens[0].density = 1.0;
  for (const double R : {0.4, 0.7, 1.9}) {
    c.specimens[0].radius = R;
    c.specimens[0].shape = ListedSpecimen{{{10.0 * R, 0, 0}}};
    c.specimens[0].name = "sphere " + std::to_string(R);
    c.specimens.push_back(c.specimens[0]);
  }
  c.specimens.pop_back();
  c.contact.law = ContactLaw::hertz;
  c.contact.E = 100.0;
  c.contact.nu = 0.3;
  const Built b = build(c);
  double worst = 0.0;
  for (const ParticleId i : b.model.mass.ids())
    for (const ParticleId j : b.model.mass.ids()) {
      const double R_i = b.model.radius[i], R_j = b.model.radius[j];
      const double k_c = contact_stiffness(hertz(100.0, 0.3, R_i, R_j), 0.1 * (R_i + R_j));
      worst = std::max(worst, k_c * (1.0 / b.model.mass[i] + 1.0 / b.model.mass[j]));
    }
  const double bound = step_bound(b.model, b.state).dt;
  EXPECT_LE(bound, critical_step(worst));
  EXPECT_GE(bound, 0.5 * critical_step(worst));  // sqrt of sqrt(1.9 / 0.4), and so less than a factor two
}

// Particles that may be bonded count as having twelve bonds: lambda = c_A (12 + 12) for the rod's c_A = 1.
TEST(StepBound, BondingRulesLeaveRoomForBondsToCome) {
  Case c = paper_rod();
  c.bonds[0].when = BondTime::approach;
  c.bonds[0].select.value = WithinDistance{1.0};
  c.time.fraction = 1.0;
  Built b = build(c);
  const Stage s = build_stage(c, b.model, 0, b.state);
  const double lambda = 4.0 / (s.critical * s.critical);
  EXPECT_NEAR(lambda, 24.0, 1e-12);
  EXPECT_TRUE(contains(step_bound(b.model, b.state, s).source, '"' + c.bonds[0].name + "\" may still make"));
}

// As bonds that are there: damped, and with a slope of 50 under compression.
TEST(StepBound, BondsToComeDampAndStretchAsTheirRuleSays) {
  const auto critical = [](const auto& change) {
    Case c = paper_rod();
    c.bonds[0].when = BondTime::approach;
    c.bonds[0].select.value = WithinDistance{1.0};
    c.time.fraction = 1.0;
    change(c.bonds[0].recipe);
    Built b = build(c);
    return build_stage(c, b.model, 0, b.state).critical;
  };
  const double plain = critical([](BondRecipe&) {}),
               stiff = critical([](BondRecipe&r) {
                 r.rules.stretch.form = StretchForm::two_slopes, r.rules.stretch.compression = 50.0;
               }),
               damped = critical([](BondRecipe&r) {
                 r.damping = {DampingBy::ratio, {5.0, 5.0, 5.0, 5.0}};
               });
  EXPECT_NEAR(stiff / plain, 1.0 / std::sqrt(50.0), 1e-12);
  EXPECT_LT(damped, 0.1 * plain);  // 1/(zeta + sqrt(1 + zeta^2)) of one bond
}

// Capsules that a rule may still make count like those that are there: of radius 1.5 between particles of
// 0.4.
TEST(StepBound, CountsThickCapsulesToCome) {
  Case c = paper_rod();
  c.specimens[0].shape = RodSpecimen{4, 3.0, {}, {1, 0, 0}};
  c.contact = {.law = ContactLaw::hertz, .E = 1e4, .nu = 0.2};
  c.bonds[0].select.value = WithinDistance{3.1};
  c.bonds[0].recipe.capsule = true, c.bonds[0].recipe.capsule_radius = 1.5;
  const Built now = build(c);
  c.bonds[0].when = BondTime::approach;
  Built later = build(c);
  const Stage stage = build_stage(c, later.model, 0, later.state);
  ASSERT_EQ(stage.bonding.size(), 1u);
  const auto of_contacts = [](const Built& b, const std::vector<BondingRule>& rules) {
    return contact_bound(b.model, b.state, {}, rules).lambda;
  };
  EXPECT_DOUBLE_EQ(of_contacts(later, stage.bonding), of_contacts(now, {}));
  EXPECT_GT(of_contacts(now, {}), 3.0 * of_contacts(later, {}));
}

// What turns fastest turns by at most half a radian in a step: bonded particles, tops, supports and walls,
// not particles that only touch.
TEST(StepBound, KeepsTurnsBelowHalfARadian) {
  Case c = paper_rod();
  Built b = build(c);
  Stage stage;
  const double elastic = step_bound(b.model, b.state, stage).dt;
  b.state.omega[ParticleId{4}] = {0, 3.0, 4.0};
  const StepBound bound = step_bound(b.model, b.state, stage);
  EXPECT_DOUBLE_EQ(bound.dt, longest_turn / 5.0);
  EXPECT_TRUE(contains(bound.source, "the turning of particle 4")) << bound.source;
  b.state.omega[ParticleId{4}] = {0, 0, 0.4};
  EXPECT_EQ(step_bound(b.model, b.state, stage).dt, elastic);

  Support grip;
  grip.group = "ends", grip.angular_velocity = {0, 2, 0}, grip.factor.points = {{0, 1}, {2, -5}};
  stage.supports = {grip};
  EXPECT_DOUBLE_EQ(step_bound(b.model, b.state, stage).dt, longest_turn / 10.0);
  EXPECT_TRUE(contains(step_bound(b.model, b.state, stage).source, "the support of group \"ends\""));
  WallDrive drum;
  drum.wall = "drum", drum.angular_velocity = {20, 0, 0};
  stage.walls = {drum};
  EXPECT_TRUE(contains(fastest_turn(b.model, b.state, stage).source, "wall \"drum\""));

  Case alone = case_of(RodSpecimen{2, 3.0, {}, {1, 0, 0}});
  alone.specimens[0].inertia.reset();
  Built free = build(alone);
  free.state.omega[ParticleId{1}] = {0, 0, 100};
  EXPECT_EQ(fastest_turn(free.model, free.state, {}).rate, 0.0);
  Support group;
  group.rigid = true, group.particles = free.model.groups[0].particles;
  Stage as_one;
  as_one.supports = {group};
  EXPECT_GT(fastest_turn(free.model, free.state, as_one).rate, 0.0);
  as_one.supports[0].held[3] = as_one.supports[0].held[4] = as_one.supports[0].held[5] = true;
  EXPECT_EQ(fastest_turn(free.model, free.state, as_one).rate, 0.0);
  alone.specimens[0].principal_inertia = std::array<double, 3>{0.05, 0.06, 0.07};
  free = build(alone);
  free.state.omega[ParticleId{1}] = {0, 0, 100};
  EXPECT_DOUBLE_EQ(step_bound(free.model, free.state, Stage{}).dt, longest_turn / 100.0);
}

// A floor that swings: the automatic step makes 20 steps a period, a given one at least 10 or is refused.
TEST(StepBound, IsBoundByWhatTheStageMovesToAndFro) {
  Case c = paper_rod();
  c.contact.law = ContactLaw::paper_hertz;
  c.contact.c_H = 1.0;
  WallSpec floor;
  floor.name = "floor";
  floor.shape = PlaneWallSpec{{0, 0, -1}, {0, 0, 1}};
  c.walls = {floor};
  WallDriveSpec drive;
  drive.wall.value = "floor";
  drive.oscillation = WallOscillationSpec{{0.1, 0, 0}, 8.0};
  c.stages[0].walls = {drive};
  c.stages[0].duration = {10.0, false};
  Built b = build(c);
  const double bound = step_bound(b.model, b.state).dt;
  ASSERT_GT(0.1 * bound, 1.0 / 160.0);
  EXPECT_DOUBLE_EQ(build_stage(c, b.model, 0, b.state).dt, 1.0 / 160.0);
  c.time.step = {CaseTime{1.0 / 80.0, false}, {"case.toml", 7, 8}};
  EXPECT_EQ(text_of_error(c), "");
  c.time.step->value = CaseTime{1.0 / 79.0, false};
  const std::string text = text_of_error(c);
  EXPECT_TRUE(contains(text, "9.88 steps in a period of 0.125 of the oscillation of wall \"floor\"; 10 are"))
      << text;
  EXPECT_TRUE(contains(text, "use 0.00625 (")) << text;
  c.time.insist = true;
  EXPECT_EQ(text_of_error(c), "");
}

/// Balls of radius 1 and 0.1 in a row: a large one with four small ones on it, which touch nothing else.
Case large_with_small(int small) {
  Case c = case_of(ListedSpecimen{{{0, 0, 0}}});
  c.specimens[0].radius = 1.0, c.specimens[0].mass = 1000.0;
  std::vector<Vec3d> r;
  for (int k = 0; k < small; ++k) r.push_back({1.09 * std::cos(k), 1.09 * std::sin(k), 0});
  c.specimens.push_back(specimen(ListedSpecimen{r}, "small"));
  c.specimens[1].radius = 0.1, c.specimens[1].mass = 1.0;
  c.contact.law = ContactLaw::paper_hertz;
  c.contact.c_H = 1.0;
  return c;
}

// Each particle counts its own contacts: how many others touch the heavy one does not make the light ones'
// step shorter.
TEST(StepBound, CountsTheContactsOfEachParticleByItself) {
  const auto dt = [](int small) {
    const Built b = build(large_with_small(small));
    return step_bound(b.model, b.state).dt;
  };
  EXPECT_EQ(dt(6), dt(1));
}

// And is a bound: the largest squared frequency of k (1/m_i + 1/m_j) sums over random heaps is never above
// it. Power iteration gives it from below.
TEST(StepBound, OfContactsHoldsForRandomHeaps) {
  std::mt19937_64 random(5);
  const auto next = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int heap = 0; heap < 40; ++heap) {
    Case c = case_of(ListedSpecimen{{{0, 0, 0}}});
    c.specimens.clear();
    for (int k = 0; k < 60; ++k) {
      c.specimens.push_back(specimen(ListedSpecimen{{{9.0 * k, 0, 0}}}, "p" + std::to_string(k)));
      c.specimens.back().radius = 0.2 + 0.6 * next();
      c.specimens.back().mass = std::pow(c.specimens.back().radius, 3) * (1.0 + 9.0 * next());
    }
    c.contact.law = ContactLaw::paper_hertz;
    c.contact.c_H = 1.0;
    Built b = build(c);
    for (Vec3d& r : b.state.r) r = {3 * next(), 3 * next(), 3 * next()};
    struct Spring {
      ParticleId i, j;
      Vec3d n;
      double k;
    };
    std::vector<Spring> springs;
    for_touching_pairs(b.model, b.state, [&](ParticleId i, ParticleId j, const Image&, double overlap) {
      springs.push_back({i, j, normalised(b.state.r[j] - b.state.r[i]), 1.5 * std::sqrt(overlap)});
    });
    PerParticle<Vec3d> x(b.model.particles(), Vec3d{});
    for (Vec3d& v : x) v = {next() - 0.5, next() - 0.5, next() - 0.5};
    double lambda = 0.0;
    for (int k = 0; k < 300; ++k) {  // x -> M^-1/2 K M^-1/2 x
      double size = 0.0;
      for (const Vec3d& v : x) size += norm2(v);
      PerParticle<Vec3d> y(b.model.particles(), Vec3d{});
      for (const Spring& s : springs) {
        const double m_i = std::sqrt(b.model.mass[s.i]), m_j = std::sqrt(b.model.mass[s.j]);
        const double F = s.k * dot(s.n, x[s.j] / m_j - x[s.i] / m_i) / std::sqrt(size);
        y[s.j] += (F / m_j) * s.n, y[s.i] -= (F / m_i) * s.n;
      }
      lambda = 0.0;
      for (const Vec3d& v : y) lambda += norm2(v);
      lambda = std::sqrt(lambda);
      x = y;
    }
    const double bound = contact_bound(b.model, b.state, {}).lambda;
    EXPECT_GE(bound, lambda) << "heap " << heap;
  }
}

// Where damping sets the step it is named, of bonds and of contacts.
TEST(StepBound, NamesDampingWhereItSetsTheStep) {
  Case c = pair_with({1.0, 0.01, 0.001, 0.001});
  c.bonds[0].recipe.damping = {DampingBy::coefficients, {0.0, 0.0, 0.0, 1.0}};
  Built b = build(c);
  EXPECT_EQ(step_bound(b.model, b.state).source, "the damping of torsion of bond 0 (particles 0, 1)");
  c.bonds[0].recipe.damping = {DampingBy::coefficients, {0.01, 0.0, 0.0, 0.0}};  // little
  b = build(c);
  EXPECT_EQ(step_bound(b.model, b.state).source, "stretching of bond 0 (particles 0, 1)");
  Case heap = case_of(RodSpecimen{3, 0.7, {}, {1, 0, 0}});
  heap.contact = {.law = ContactLaw::hertz, .E = 1e4, .nu = 0.2};
  heap.contact.surface.restitution = 1e-4;
  const Built touching = build(heap);
  EXPECT_TRUE(
      contains(step_bound(touching.model, touching.state).source, "the damping of contacts of particle"))
      << step_bound(touching.model, touching.state).source;
}

}  // namespace
}  // namespace vbond::test
