#include "cases.hpp"

namespace vbond::test {
namespace {

Stage first_stage(const Case& c) {
  Built b = build(c);
  return build_stage(c, b.model, 0, b.state);
}

SupportSpec support(const std::string& group, HeldDofs held) {
  SupportSpec s;
  s.place = {"case.toml", 30, 1};
  s.group = {group, {"case.toml", 31, 9}};
  s.held = held;
  return s;
}

TEST(Stage, TimesAreInTheModelsUnit) {
  Case c = paper_rod();
  c.specimens[0].mass = 4.0;  // T_0 = 2 pi sqrt(4 / 1)
  c.stages[0].strain = StrainSpec{{"case.toml", 40, 1}, {"all", {}}, {2, 0, 0}, -1e-7, {10.0, true}};
  SupportSpec ramp = support("ends", {true, false, false, false, false, false});
  ramp.factor.points = {{{0.0, false}, 0.0}, {{2.0, true}, 1.0}};
  c.stages[0].supports = {ramp};
  const Stage s = first_stage(c);
  const double T_0 = 4.0 * std::numbers::pi;
  EXPECT_DOUBLE_EQ(s.stops.duration, 100.0 * T_0);
  EXPECT_DOUBLE_EQ(s.strain->every, 10.0 * T_0);
  EXPECT_EQ(s.strain->direction, (Vec3d{1, 0, 0}));
  EXPECT_DOUBLE_EQ(s.strain->centre.x, 4.5);
  EXPECT_DOUBLE_EQ(s.supports[0].factor(T_0), 0.5);
  EXPECT_EQ(s.supports[0].particles.size(), 2u);
}

TEST(Stage, StepIsTheAskedFractionOfTheBound) {
  Case c = paper_rod();
  c.time.fraction = 0.25;
  c.stages[0].duration = {100.0, false};
  EXPECT_DOUBLE_EQ(first_stage(c).dt, 0.25);  // the rod's bound is 1: see StepBound
}

TEST(Stage, GivenStepAboveTheBoundIsRefusedUnlessInsisted) {
  Case c = paper_rod();
  c.time.step = Placed<std::variant<CaseTime, ExactStep>>{CaseTime{0.16, true},
                                                          {"case.toml", 50, 8}};  // the bound is 0.15915 T0
  const std::string error = text_of_stage_error(c);
  EXPECT_TRUE(contains(error, "case.toml:50:8: time.step = 1.00531 (0.16 T0) in stage \"run\"")) << error;
  EXPECT_TRUE(contains(error, "stretching of bond")) << error;
  c.time.insist = true;
  EXPECT_DOUBLE_EQ(first_stage(c).dt, 0.16 * 2.0 * std::numbers::pi);
  c.time.insist = false;
  c.time.step->value = CaseTime{0.159, true};
  c.stages[0].duration = {159.0, true};
  EXPECT_DOUBLE_EQ(first_stage(c).dt, 0.159 * 2.0 * std::numbers::pi);
}

TEST(Stage, UnderWayKeepsItsStepAndMakesNoBonds) {
  Case c = case_of(RodSpecimen{3, 1.0, {}, {1, 0, 0}});
  c.bonds = {bonds_within(1.1)};
  c.bonds[0].when = BondTime::stage;
  c.bonds[0].stages = {{"run", {"case.toml", 13, 1}}};
  Built b = build(c);
  b.state.clock.stage_step = 7;
  b.state.clock.dt = 0.0123;
  EXPECT_EQ(build_stage(c, b.model, 0, b.state).dt, 0.0123);
  EXPECT_TRUE(b.state.bonds.empty());
}

TEST(Stage, WithNothingElasticNeedsAGivenStep) {
  Case c = case_of(RodSpecimen{3, 1.0, {}, {1, 0, 0}});
  EXPECT_TRUE(contains(text_of_stage_error(c), "case.toml:20:1: stage \"run\" has no natural time step"));
  EXPECT_TRUE(contains(text_of_stage_error(c), "give time.step"));
  c.time.step = Placed<std::variant<CaseTime, ExactStep>>{CaseTime{0.5, false}, {}};
  c.stages[0].duration = {100.0, false};
  EXPECT_EQ(first_stage(c).dt, 0.5);
}

// What is left when all bonds have broken flies on with a step of the first bond's T0.
TEST(Stage, WithBrokenBondsAloneGoesOnByTheNaturalTime) {
  Case c = paper_rod();
  c.time.fraction = 0.25;
  c.stages.push_back(stage("later"));
  c.stages[1].duration = {100.0, false};
  Built b = build(c);
  for (Bond& bond : b.state.bonds) bond.broken = true;
  const Stage later = build_stage(c, b.model, 1, b.state);
  EXPECT_DOUBLE_EQ(later.dt, 0.5);  // T0/pi = 2
  EXPECT_DOUBLE_EQ(later.critical, 2.0);
  c.bonds[0].when = BondTime::stage;  // and before the first are made
  c.bonds[0].select.value = WithinDistance{1.0};
  c.bonds[0].stages = {{"later", {"case.toml", 13, 1}}};
  c.stages[0].duration = {100.0, false};
  EXPECT_DOUBLE_EQ(first_stage(c).dt, 0.5);
}

// A body that spins is stepped finely enough, and a given step that is not is refused.
TEST(Stage, ChoosesItsStepBySpinToo) {
  Case c = paper_rod();
  VelocitySpec spin;
  spin.kind = VelocityKind::rigid, spin.angular_velocity = {0, 0, 5};
  c.velocities = {spin};
  c.stages[0].duration = {100.0, false};
  EXPECT_NEAR(first_stage(c).dt, 0.1 * 0.5 / 5.0, 1e-15);
  c.time.step = Placed<std::variant<CaseTime, ExactStep>>{CaseTime{0.125, false}, {"case.toml", 50, 8}};
  const std::string error = text_of_stage_error(c);
  EXPECT_TRUE(contains(error, "case.toml:50:8: time.step = 0.125")) << error;
  EXPECT_TRUE(contains(error, "the turning of particle")) << error;
  Built later = build(c);
  later.state.clock.step = 100;  // it has come to spin so fast by itself: the watch tells
  EXPECT_EQ(build_stage(c, later.model, 0, later.state).dt, 0.125);
  c.time.insist = true;
  EXPECT_EQ(first_stage(c).dt, 0.125);
}

TEST(Stage, BondingRulesApplyToTheirStagesOnly) {
  Case c = paper_rod();
  c.stages.push_back(stage("second"));
  BondSpec rule = bonds_within(1.5);
  rule.when = BondTime::approach;
  c.bonds.push_back(rule);
  rule.stages = {{"second", {"case.toml", 13, 1}}};
  rule.between[0].value = "first";
  c.bonds.push_back(rule);
  Built b = build(c);
  const Stage one = build_stage(c, b.model, 0, b.state), two = build_stage(c, b.model, 1, b.state);
  ASSERT_EQ(one.bonding.size(), 1u);
  EXPECT_EQ(one.bonding[0].recipe.set, 1u);
  ASSERT_EQ(two.bonding.size(), 2u);
  EXPECT_EQ(std::count(two.bonding[1].in_a.begin(), two.bonding[1].in_a.end(), 1), 1);
  EXPECT_EQ(std::count(two.bonding[1].in_b.begin(), two.bonding[1].in_b.end(), 1), 10);
}

// Mistakes of all stages and of the output are found before the first one runs.
TEST(Stage, MistakesOfLaterStagesAreFoundWhenTheCaseIsBuilt) {
  Case c = paper_rod();
  c.stages.push_back(stage("later"));
  c.stages[1].supports = {support("edns", {true}), support("ends", {true, true}),
                          support("first", {false, true})};
  c.stages[1].supports[2].velocity = {0, 1, 0};
  c.stages[1].loads.push_back({{"case.toml", 60, 1}, {"tip", {"case.toml", 61, 9}}, {1, 0, 0}, {}, {}});
  c.stages[1].stop_distance = DistanceStopSpec{{"case.toml", 62, 1}, {0, 10}, 1.0, true};
  c.bonds[0].stages = {{"latter", {"case.toml", 13, 11}}};
  c.output.reactions = {{"bodi", {"case.toml", 70, 14}}};
  c.output.displacements = {{"1000", {"case.toml", 71, 3}}};
  const std::string error = text_of_error(c);
  for (const char* part :
       {"case.toml:31:9: there is no group \"edns\"\n  known groups: all, body, body.ends, body.first, "
        "body.last, "
        "ends, first, last\n  did you mean \"ends\"?",
        "y of particle 0 is held by two supports (groups \"ends\" and \"first\") that do not move it alike",
        "case.toml:61:9: there is no group \"tip\"", "case.toml:62:1: stop.distance: there is no particle 10",
        "case.toml:13:11: there is no stage \"latter\"\n  known stages: run, later\n  did you mean "
        "\"later\"?",
        "case.toml:70:14: there is no group \"bodi\"",
        "case.toml:71:3: displacements: there is no particle 1000"})
    EXPECT_TRUE(contains(error, part)) << part << "\nnot in\n" << error;
}

SupportSpec grip(const std::string& group) {
  SupportSpec s = support(group, all_held);
  s.rigid = true;
  s.angular_velocity = {0.1, 0, 0};
  return s;
}

TEST(Stage, GripsKeepTheirMotionAndPivot) {
  Case c = paper_rod();
  SupportSpec s = grip("ends");
  s.velocity = {1, 2, 3};
  s.pivot = Vec3d{4, 5, 6};
  c.stages[0].supports = {s};
  const Support resolved = first_stage(c).supports.at(0);
  EXPECT_TRUE(resolved.rigid);
  EXPECT_EQ(resolved.held, all_held);
  EXPECT_EQ(resolved.velocity, (Vec3d{1, 2, 3}));
  EXPECT_EQ(resolved.angular_velocity, (Vec3d{0.1, 0, 0}));
  EXPECT_EQ(resolved.pivot, (Vec3d{4, 5, 6}));
}

TEST(Stage, GripsThatCannotBeAreLocated) {
  Case c = paper_rod();
  c.stages[0].supports = {grip("ends"), grip("first")};  // about other pivots
  std::string error = text_of_error(c);
  EXPECT_TRUE(
      contains(error,
               "case.toml:30:1: x of particle 0 is held by two supports (groups \"ends\" and \"first\") "
               "that do not move it alike"))
      << error;
  EXPECT_TRUE(contains(error, "rigid ones the same pivot")) << error;
  c.stages[0].supports[0].pivot = Vec3d{3, 0, 0};
  c.stages[0].supports[1].pivot = Vec3d{-2, 0, 0};  // the same axis
  EXPECT_EQ(text_of_error(c), "");
  c.stages[0].supports[1].angular_velocity.x = 0.2;
  EXPECT_TRUE(contains(text_of_error(c), "do not move it alike"));
  c.stages[0].supports.pop_back();
  c.stages[0].strain = StrainSpec{{"case.toml", 40, 1}, {"all", {}}, {1, 0, 0}, -1e-7, {10.0, true}};
  error = text_of_error(c);
  EXPECT_TRUE(contains(error, "case.toml:40:1: strain moves particle 0, which is in a rigid support"))
      << error;
}

// Totals are shared by mass, whatever the group.
TEST(Stage, TotalLoadsAreSharedByMass) {
  Case c = paper_rod();
  c.specimens[0].mass = 4.0;
  LoadSpec load{{"case.toml", 60, 1}, {"all", {}}, {1, 0, 0}, {}, {}};
  load.total_force = {0, 20, 0};
  load.total_moment = {0, 0, 10};
  c.stages[0].loads = {load};
  const PointLoad resolved = first_stage(c).loads.at(0);
  EXPECT_LE(norm(resolved.force_on(4.0) - Vec3d{1, 2, 0}), 1e-15);  // on each of ten
  EXPECT_LE(norm(resolved.moment_on(4.0) - Vec3d{0, 0, 1}), 1e-15);
}

TEST(Stage, PeakNeedsBondsOrASupportToWatch) {
  Case c = paper_rod();
  PeakStopSpec peak;
  peak.place = {"case.toml", 45, 1};
  peak.group = {"ends", {}};  // the two ends are not bonded to each other
  peak.average_over = {10.0, true};
  c.stages[0].stop_peak = peak;
  EXPECT_TRUE(contains(text_of_stage_error(c), "group \"ends\" has no bonds"));
  c.stages[0].stop_peak->quantity = PeakQuantity::reaction;
  EXPECT_TRUE(contains(text_of_error(c), "the reaction of group \"ends\" is always zero"));
  c.stages[0].supports = {support("first", {true, true, true})};
  EXPECT_EQ(first_stage(c).stops.peak->particles.size(), 2u);
}

TEST(Stage, PeakOfAWallNamesTheWall) {
  Case c = paper_rod();
  c.contact.law = ContactLaw::paper_hertz;
  c.contact.c_H = 1.0;
  WallSpec lid;
  lid.name = "lid";
  lid.shape = PlaneWallSpec{{0, 0, 2}, {0, 0, -1}};
  c.walls = {lid};
  PeakStopSpec peak;
  peak.quantity = PeakQuantity::wall_force;
  peak.wall = {"lip", {"case.toml", 45, 9}};
  peak.direction = {0, 0, 2};
  peak.average_over = {1.0, false};
  c.stages[0].stop_peak = peak;
  EXPECT_TRUE(contains(text_of_error(c), "case.toml:45:9: there is no wall \"lip\"")) << text_of_error(c);
  c.stages[0].stop_peak->wall.value = "lid";
  const PeakStop stop = *first_stage(c).stops.peak;
  EXPECT_EQ(stop.wall, 0u);
  EXPECT_EQ(stop.direction, (Vec3d{0, 0, 1}));
}

TEST(Stage, StopAtBreaksNeedsBondsThatMayBreak) {
  Case c = paper_rod();
  c.stages[0].stop_breaks = BreakStopSpec{{"case.toml", 46, 1}, 9};
  EXPECT_TRUE(
      contains(text_of_error(c), "case.toml:46:1: stop.breaks.count = 9\n  no bonds of this case break"));
  c.bonds[0].recipe.rules.strength = elongation_strength(0.01);
  EXPECT_EQ(first_stage(c).stops.breaks->count, 9);
  c.stages[0].stop_breaks->count = 10;
  EXPECT_TRUE(contains(text_of_stage_error(c), "only 9 bonds may break in stage \"run\""));
}

TEST(Stage, PeakOfAReactionNeedsASupportThatHoldsATranslation) {
  Case c = paper_rod();
  PeakStopSpec peak;
  peak.quantity = PeakQuantity::reaction;
  peak.group = {"ends", {}};
  peak.direction = {1, 0, 0};
  peak.average_over = {10.0, true};
  c.stages[0].stop_peak = peak;
  for (std::size_t k = 0; k < 6; ++k) {
    HeldDofs only{};
    only[k] = true;
    c.stages[0].supports = {support("first", only)};
    EXPECT_EQ(contains(text_of_error(c), "the reaction of group \"ends\" is always zero"), k >= 3) << k;
  }
}

TEST(Stage, StrainMoreOftenThanStepsIsRefused) {
  Case c = paper_rod();
  c.stages[0].strain = StrainSpec{{"case.toml", 40, 1}, {"all", {}}, {1, 0, 0}, -1e-7, {0.01, false}};
  EXPECT_TRUE(
      contains(text_of_stage_error(c), "case.toml:40:1: strain.every = 0.01\n  the time step is 0.1"));
}

TEST(Stage, TimeTablesMustIncrease) {
  Case c = paper_rod();
  LoadSpec load{{"case.toml", 33, 1}, {"last", {}}, {1, 0, 0}, {}, {}};
  load.factor.points = {{{1.0, true}, 0.0}, {{6.0, false}, 1.0}};  // 1 T0 = 6.28 comes after 6
  c.stages[0].loads = {load};
  EXPECT_TRUE(contains(text_of_error(c), "case.toml:33:1: the factor's time 6 does not come after"));
}

TEST(NaturalTime, IsThatOfTheFirstBondSetIfNothingIsBondedYet) {
  Case c = paper_rod();
  c.bonds[0].when = BondTime::approach;
  c.bonds[0].select.value = WithinDistance{0.5};  // Bernoulli-Euler at half the length: c_A = 2
  EXPECT_DOUBLE_EQ(build(c).model.T_0, 2.0 * std::numbers::pi / std::sqrt(2.0));
}

TEST(NaturalTime, DoesNotExistInSiWithoutBonds) {
  Case c = case_of(RodSpecimen{3, 1.0, {}, {1, 0, 0}});
  EXPECT_DOUBLE_EQ(build(c).model.T_0, 2.0 * std::numbers::pi);
  c.units = UnitSystem::si;
  EXPECT_TRUE(contains(text_of_error(c), "duration = 100 T0"));
  c.stages[0].duration = {3.0, false};
  c.output.history_every = {1.0, false};
  const Built b = build(c);
  EXPECT_EQ(b.model.T_0, 0.0);
  EXPECT_EQ(resolve_time({2.5, false}, b.model, "any", {}), 2.5);
  EXPECT_THROW(resolve_time({2.5, true}, b.model, "any", {}), CaseError);
}

TEST(Resolution, OfGroupsAndParticlesReportsAllMistakes) {
  const Built b = build(paper_rod());
  EXPECT_EQ(resolve_groups({{"ends", {}}, {"all", {}}}, b.model)[1].particles.size(), 10u);
  const std::vector<Group> groups =
      resolve_groups_or_particles({{"ends", {}}, {"9", {}}}, "displacements", b.model);
  EXPECT_EQ(groups[0].particles.size(), 2u);
  EXPECT_EQ(groups[1].particles, std::vector<ParticleId>{ParticleId{9}});
  try {
    resolve_groups_or_particles({{"0", {}}, {"10", {}}, {"nobody", {}}}, "displacements", b.model);
    FAIL();
  } catch (const CaseError& e) {
    EXPECT_EQ(e.problems().size(), 2u);
  }
  try {
    resolve_groups_or_particles({{"99999999999999999999", {}}}, "displacements", b.model);  // beyond 64 bits
    FAIL();
  } catch (const CaseError& e) {
    EXPECT_TRUE(contains(e.what(), "displacements: there is no particle 99999999999999999999\n")) << e.what();
  }
  EXPECT_THROW(resolve_groups({{"nobody", {}}}, b.model), CaseError);
}

// Overlapping particles that a later stage bonds give up their contact energy: it must stand in the books.
TEST(StageBonds, BookTheContactEnergyTheyTakeAway) {
  Case c = paper_rod();
  c.bonds[0].when = BondTime::stage;
  c.bonds[0].stages = {{c.stages[0].name, {}}};
  c.specimens[0].radius = 0.52;
  c.contact = {ContactLaw::paper_hertz, ContactPairs::unbonded, 1.0, 1.0, 0.0, 0.0};
  Built b = build(c);
  ASSERT_TRUE(b.state.bonds.empty());
  b.state.clock.step = 7;  // not the start of the run, where the books are opened
  build_stage(c, b.model, 0, b.state);
  ASSERT_EQ(b.state.bonds.size(), 9u);
  EXPECT_NEAR(b.state.books.dissipated, 9 * 0.4 * std::pow(0.04, 2.5),
              1e-17);  // nine overlaps of 0.04, 2/5 k d^(5/2)
}

}  // namespace
}  // namespace vbond::test
