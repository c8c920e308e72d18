#include <stdexcept>

#include "cases.hpp"

namespace vbond::test {
namespace {

StageSpec static_stage(StageKind kind, const std::string& name = "run") {
  StageSpec s;
  s.place = {"case.toml", 20, 1};
  s.name = name;
  s.kind = kind;
  return s;
}

SupportSpec clamp(const std::string& group) {
  SupportSpec s;
  s.place = {"case.toml", 30, 1};
  s.group = {group, {"case.toml", 31, 9}};
  s.held = {true, true, true, true, true, true};
  return s;
}

Case static_rod(StageKind kind) {
  Case c = paper_rod();
  c.stages = {static_stage(kind)};
  return c;
}

StaticStage first_static_stage(const Case& c) {
  Built b = build(c);
  return build_static_stage(c, b.model, 0, b.state);
}

std::string text_of_static_error(const Case& c) {
  Built b = build(c);
  try {
    build_static_stage(c, b.model, 0, b.state);
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

TEST(StaticStageOfACase, HasEverythingTheCaseSays) {
  Case c = static_rod(StageKind::path);
  StageSpec& s = c.stages[0];
  s.gravity = {0, 0, -2};
  s.constant_gravity = true;
  s.supports = {clamp("first")};
  s.supports[0].displacement = {1, 2, 3};
  s.supports[0].rotation = {4, 5, 6};
  s.loads.push_back({{}, {"ends", {}}, {7, 0, 0}, {0, 8, 0}, {}, true});
  s.newton = {1e-7, 9, LinearSolver::direct};
  s.steps = 3;
  s.at_saddle = AtSaddle::keep;
  s.path.first_step = -0.5;
  s.path.branch = BranchSwitch{2, 3, -1.0};
  s.stop_distance = DistanceStopSpec{{}, {2, 7}, 4.5, false};
  s.count = 11;
  s.frames_per_mode = 12;
  s.amplitude = 0.13;
  const StaticStage stage = first_static_stage(c);
  EXPECT_EQ(stage.name, "run");
  EXPECT_EQ(stage.kind, StageKind::path);
  EXPECT_EQ(stage.gravity, (Vec3d{0, 0, -2}));
  EXPECT_TRUE(stage.constant_gravity);
  ASSERT_EQ(stage.supports.size(), 1u);
  EXPECT_EQ(stage.supports[0].group, "first");
  EXPECT_EQ(stage.supports[0].particles, std::vector<ParticleId>{ParticleId{0}});
  EXPECT_EQ(stage.supports[0].held, (HeldDofs{true, true, true, true, true, true}));
  EXPECT_EQ(stage.supports[0].velocity, (Vec3d{1, 2, 3}));
  EXPECT_EQ(stage.supports[0].angular_velocity, (Vec3d{4, 5, 6}));
  ASSERT_EQ(stage.loads.size(), 1u);
  EXPECT_EQ(stage.loads[0].group, "ends");
  EXPECT_EQ(stage.loads[0].particles, (std::vector<ParticleId>{ParticleId{0}, ParticleId{9}}));
  EXPECT_EQ(stage.loads[0].force, (Vec3d{7, 0, 0}));
  EXPECT_EQ(stage.loads[0].moment, (Vec3d{0, 8, 0}));
  EXPECT_TRUE(stage.loads[0].constant);
  EXPECT_EQ(stage.newton.tolerance, 1e-7);
  EXPECT_EQ(stage.newton.iterations, 9);
  EXPECT_EQ(stage.newton.solver, LinearSolver::direct);
  EXPECT_EQ(stage.steps, 3);
  EXPECT_EQ(stage.at_saddle, AtSaddle::keep);
  EXPECT_EQ(stage.path.first_step, -0.5);
  EXPECT_EQ(stage.path.branch->mode, 3);
  ASSERT_TRUE(stage.path.distance);
  EXPECT_EQ(stage.path.distance->i, ParticleId{2});
  EXPECT_EQ(stage.path.distance->j, ParticleId{7});
  EXPECT_EQ(stage.path.distance->value, 4.5);
  EXPECT_FALSE(stage.path.distance->below);
  EXPECT_EQ(stage.count, 11);
  EXPECT_EQ(stage.frames_per_mode, 12);
  EXPECT_EQ(stage.amplitude, 0.13);
}

TEST(StaticStageOfACase, MakesItsBondsOnce) {
  Case c = static_rod(StageKind::equilibrium);
  c.bonds[0].when = BondTime::stage;
  c.bonds[0].stages = {{"run", {"case.toml", 13, 1}}};
  Built b = build(c);
  ASSERT_TRUE(b.state.bonds.empty());
  build_static_stage(c, b.model, 0, b.state);
  EXPECT_EQ(b.state.bonds.size(), 9u);
  Built under_way = build(c);
  under_way.state.clock.stage_step = 3;
  build_static_stage(c, under_way.model, 0, under_way.state);
  EXPECT_TRUE(under_way.state.bonds.empty());
}

// Mistakes in names are found before the first stage runs, as for dynamics.
TEST(StaticStageOfACase, IsLookedAtWhenTheCaseIsBuilt) {
  Case c = paper_rod();
  c.stages.push_back(static_stage(StageKind::path, "later"));
  c.stages[1].supports = {clamp("edns"), clamp("ends"), clamp("first")};
  c.stages[1].supports[2].displacement = {0.1, 0, 0};
  c.stages[1].loads.push_back({{"case.toml", 60, 1}, {"tip", {"case.toml", 61, 9}}, {1, 0, 0}, {}, {}});
  c.stages[1].stop_distance = DistanceStopSpec{{"case.toml", 62, 1}, {0, 10}, 1.0, true};
  const std::string error = text_of_error(c);
  for (const char* part :
       {"case.toml:31:9: there is no group \"edns\"",
        "case.toml:30:1: x of particle 0 is held by two supports (groups \"ends\" and \"first\")",
        "case.toml:61:9: there is no group \"tip\"",
        "case.toml:62:1: stop.distance: there is no particle 10"})
    EXPECT_TRUE(contains(error, part)) << part << "\nnot in\n" << error;
  EXPECT_FALSE(contains(error, "duration")) << error;
}

TEST(StaticStageOfACase, NeedsSomethingFreeUnlessItIsAnEquilibrium) {
  for (const StageKind kind : {StageKind::path, StageKind::buckling, StageKind::modes}) {
    Case c = static_rod(kind);
    c.stages[0].supports = {clamp("all")};
    EXPECT_TRUE(contains(text_of_error(c), "case.toml:20:1: stage \"run\": supports hold everything"));
    c.stages[0].supports[0].held[5] = false;
    EXPECT_EQ(text_of_error(c), "");
  }
  Case c = static_rod(StageKind::equilibrium);
  c.stages[0].supports = {clamp("all")};
  EXPECT_EQ(text_of_static_error(c), "");
}

TEST(StaticStageOfACase, NeedsSomethingElastic) {
  Case c = static_rod(StageKind::equilibrium);
  c.bonds.clear();
  EXPECT_TRUE(contains(text_of_static_error(c), "case.toml:20:1: stage \"run\": nothing is elastic"));
  c.contact = {ContactLaw::paper_hertz, ContactPairs::unbonded, 1.0, 1.0, 0.0, 0.0};
  EXPECT_EQ(text_of_static_error(c), "");
}

TEST(StaticStageOfACase, IsNotBuiltAsDynamicsNorTheOtherWay) {
  const Case statics = static_rod(StageKind::modes), dynamics = paper_rod();
  Built s = build(statics), d = build(dynamics);
  EXPECT_THROW(build_stage(statics, s.model, 0, s.state), std::logic_error);
  EXPECT_THROW(build_static_stage(dynamics, d.model, 0, d.state), std::logic_error);
}

TEST(StaticStageOfACase, HasNoBondingRules) {
  Case c = paper_rod();
  BondSpec rule = bonds_within(1.5);
  rule.when = BondTime::approach;
  c.bonds.push_back(rule);
  c.stages.push_back(static_stage(StageKind::equilibrium, "later"));
  Built b = build(c);
  EXPECT_EQ(build_stage(c, b.model, 0, b.state).bonding.size(), 1u);
  build_static_stage(c, b.model, 1, b.state);
  EXPECT_EQ(b.state.bonds.size(), 9u);
}

Case exact_rod() {
  Case c = paper_rod();
  c.time.step = Placed<std::variant<CaseTime, ExactStep>>{ExactStep{}, {"case.toml", 50, 8}};
  c.stages[0].duration = {100.0, false};
  return c;
}

// The rod's bound is dt = 1 (see StepBound): an exact step above it is no mistake.
TEST(ExactStepOfACase, IsAFractionOfWhatIsAskedForAboveTheBoundToo) {
  Case c = exact_rod();
  c.stages[0].supports = {clamp("first")};
  Built b = build(c);
  const auto exact = [&](const Model& model, const State& state, const Stage& stage) {
    EXPECT_EQ(&model, &b.model);
    EXPECT_EQ(state.bonds.size(), 9u);
    EXPECT_EQ(stage.supports.size(), 1u);
    return 1.25;
  };
  EXPECT_DOUBLE_EQ(build_stage(c, b.model, 0, b.state, exact).dt, 0.125);
  c.time.fraction = 1.0;
  EXPECT_DOUBLE_EQ(build_stage(c, b.model, 0, b.state, exact).dt, 1.25);
}

TEST(ExactStepOfACase, IsNotAskedForByOthers) {
  Case c = paper_rod();
  c.stages[0].duration = {100.0, false};
  Built b = build(c);
  const auto never = [](const Model&, const State&, const Stage&) -> double {
    throw std::logic_error("asked");
  };
  EXPECT_DOUBLE_EQ(build_stage(c, b.model, 0, b.state, never).dt, 0.1);
}

TEST(ExactStepOfACase, NeedsStaticsAndSomethingElastic) {
  const Case c = exact_rod();
  EXPECT_TRUE(contains(text_of_stage_error(c),
                       "case.toml:50:8: time.step = \"exact\"\n  this vbond was built "
                       "without statics"));
  Built b = build(c);
  const auto infinite = [](const Model&, const State&, const Stage&) { return INFINITY; };
  const auto zero = [](const Model&, const State&, const Stage&) { return 0.0; };
  EXPECT_THROW(build_stage(c, b.model, 0, b.state, infinite), CaseError);
  EXPECT_THROW(build_stage(c, b.model, 0, b.state, zero), CaseError);
}

TEST(ExactStepOfACase, ThatIsNotFoundIsAMistakeOfTheCase) {
  const ExactCriticalStep lost = [](const Model&, const State&, const Stage&) -> double {
    throw NoConvergence("largest eigenvalue: no convergence");
  };
  const Case c = exact_rod();
  Built b = build(c);
  try {
    build_stage(c, b.model, 0, b.state, lost);
    FAIL();
  } catch (const CaseError& e) {
    EXPECT_TRUE(contains(e.what(),
                         "case.toml:50:8: time.step = \"exact\"\n  largest eigenvalue: no convergence\n  "
                         "leave step out"));
  }
}

TEST(ExactStepOfACase, DoesNotKnowBondsToCome) {
  Case c = exact_rod();
  c.bonds.push_back(bonds_within(1.5));
  c.bonds[1].name = "later";
  c.bonds[1].when = BondTime::approach;
  EXPECT_TRUE(contains(text_of_stage_error(c), "bonds \"later\" may still be made"));
}

}  // namespace
}  // namespace vbond::test
