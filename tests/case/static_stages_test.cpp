#include <gtest/gtest.h>

#include <string>

#include "vbond/case/read.hpp"

namespace vbond::static_stages_test {
namespace {

const std::string rod = "[[specimen]]\nkind = \"rod\"\nparticles = 10\nmass = 1\ninertia = 0.064\n";
const std::string load = "loads = [{ group = \"last\", force = [1, 0, 0] }]\n";

Case read(const std::string& text) {
  return parse_case(rod + text, "case.toml");
}

/// The first stage as resolved.toml brings it back, which must keep every value.
StageSpec stage(const std::string& kind, const std::string& lines) {
  const Case c = read("[[stage]]\nkind = \"" + kind + "\"\n" + lines);
  return parse_case(to_toml(c), "resolved.toml").stages.at(0);
}

std::string report(const std::string& text) {
  try {
    read(text);
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

void expect_accepted(const std::string& kind, const std::string& lines) {
  EXPECT_EQ(report("[[stage]]\nkind = \"" + kind + "\"\n" + lines), "") << lines;
}
void expect_refused(const std::string& kind, const std::string& lines, const std::string& because) {
  const std::string text = report("[[stage]]\nkind = \"" + kind + "\"\n" + lines);
  EXPECT_NE(text.find(because), std::string::npos) << lines << "\nwas met with: " << text;
}

TEST(StaticStages, AreDynamicsUnlessTheCaseSaysOtherwise) {
  EXPECT_EQ(read("[[stage]]\nduration = 1\n").stages[0].kind, StageKind::dynamics);
  EXPECT_EQ(stage("dynamics", "duration = 1\n").kind, StageKind::dynamics);
  EXPECT_EQ(stage("equilibrium", "").kind, StageKind::equilibrium);
  EXPECT_EQ(stage("path", load).kind, StageKind::path);
  EXPECT_EQ(stage("buckling", load).kind, StageKind::buckling);
  EXPECT_EQ(stage("modes", "").kind, StageKind::modes);
}

TEST(Stages, RigidSupportsAndTotalLoadsKeepTheirKeys) {
  const StageSpec s =
      stage("dynamics",
            "duration = 1\nsupports = [{ group = \"last\", rigid = true, pivot = [1, 2, 3], "
            "velocity = [0, 0, 1], angular_velocity = [4, 5, 6], ramp = 0.5 }]\n"
            "loads = [{ group = \"first\", total_force = [1, 2, 3], total_moment = [4, 5, 6] }]\n");
  EXPECT_TRUE(s.supports[0].rigid);
  EXPECT_EQ(s.supports[0].held, all_held);
  EXPECT_EQ(s.supports[0].pivot, (Vec3d{1, 2, 3}));
  EXPECT_EQ(s.supports[0].angular_velocity, (Vec3d{4, 5, 6}));
  EXPECT_EQ(s.loads[0].total_force, (Vec3d{1, 2, 3}));
  EXPECT_EQ(s.loads[0].total_moment, (Vec3d{4, 5, 6}));
  const StageSpec e = stage("equilibrium",
                            "supports = [{ group = \"last\", rigid = true, displacement = [0, 0, 1], "
                            "rotation = [4, 5, 6] }]\n");
  EXPECT_TRUE(e.supports[0].rigid);
  EXPECT_FALSE(e.supports[0].pivot);
  EXPECT_EQ(e.supports[0].rotation, (Vec3d{4, 5, 6}));
}

TEST(Stages, SlantedSupportsKeepTheirDirections) {
  const StageSpec s =
      stage("dynamics",
            "duration = 1\nsupports = [{ group = \"last\", fix = [\"y\", [0.5, 0, 0.866], \"rz\"], "
            "fix_rotation = [[1, 1, 0]], velocity = [0.05, 3, 0.0866] }]\n");
  EXPECT_EQ(s.supports[0].held, (HeldDofs{false, true, false, false, false, true}));
  EXPECT_EQ(s.supports[0].along, std::vector<Vec3d>{(Vec3d{0.5, 0, 0.866})});
  EXPECT_EQ(s.supports[0].about, std::vector<Vec3d>{(Vec3d{1, 1, 0})});
  const std::string moving = "duration = 1\nsupports = [{ group = \"last\", ";
  expect_accepted("dynamics", moving + "fix = [], fix_rotation = [[1, 2, 3]] }]\n");
  expect_accepted("dynamics", moving + "fix = [[1, 1, 0]], velocity = [0.1, 0.1, 0] }]\n");
  expect_refused("dynamics", moving + "fix = [[1, 1, 0]], velocity = [0.1, 0, 0] }]\n",
                 "a component along a direction that fix does not hold");
  expect_refused("dynamics", moving + "fix = [[0, 0, 0]] }]\n", "must not be the zero vector");
  expect_refused("dynamics", moving + "fix = [[0, 1]] }]\n", "must have 3 elements; this has 2");
  expect_refused("dynamics", moving + "fix = [\"x\", 1] }]\n", "case.toml");
  expect_refused("dynamics", moving + "fix = [] }]\n", "must hold something");
  expect_accepted("equilibrium", "supports = [{ group = \"last\", rigid = true, fix = [\"x\"] }]\n");
  expect_refused("modes", "supports = [{ group = \"last\", rigid = true, fix = [\"x\"] }]\n",
                 "modes take rigid groups that are held altogether");
}

TEST(Stages, GripsThatAreFreeInPartKeepWhatTheyHold) {
  const std::string last = "duration = 1\nsupports = [{ group = \"last\", rigid = true, ";
  const StageSpec s = stage("dynamics", last + "fix = [\"x\", \"y\", \"rx\", \"ry\", \"rz\"] }]\n");
  EXPECT_EQ(s.supports[0].held, (HeldDofs{true, true, false, true, true, true}));
  EXPECT_EQ(stage("dynamics", last + "fix = [] }]\n").supports[0].held, HeldDofs{});
  EXPECT_EQ(
      to_toml(read("[[stage]]\nduration = 1\nsupports = [{ group = \"last\", rigid = true }]\n")).find("fix"),
      std::string::npos);
  expect_refused("dynamics", last + "fix = [[1, 1, 0]] }]\n", "along and about the world's axes");
  expect_refused("dynamics", last + "fix = [\"rx\"] }]\n", "no rotation, two or all three");
  expect_refused("dynamics", last + "fix = [\"rx\", \"ry\"], angular_velocity = [1, 0, 0] }]\n",
                 "holds all three rotations");
  expect_refused("dynamics", last + "fix = [\"x\"], pivot = [0, 0, 0] }]\n", "stands still");
  expect_refused("dynamics", last + "fix = [\"x\"], velocity = [0, 1, 0] }]\n",
                 "a component along a direction that fix does not hold");
  expect_refused("dynamics", last + "fix = [\"x\"] }]\ndamping = { local = 0.5 }\n",
                 "local damping does not know rigid groups");
}

TEST(Stages, LoadsThatFollowSaySo) {
  EXPECT_TRUE(
      stage("dynamics", "duration = 1\nloads = [{ group = \"last\", moment = [0, 0, 1], follower = true }]\n")
          .loads[0]
          .follower);
  const std::string load = "loads = [{ group = \"last\", moment = [0, 0, 1], follower = true }]\n";
  expect_accepted("path", load);
  expect_refused("buckling", load, "kind = \"dynamics\", \"equilibrium\" or \"path\"");
}

TEST(Stages, RefuseWhatGripsHaveNot) {
  expect_refused("dynamics",
                 "duration = 1\nsupports = [{ group = \"last\", fix = [\"x\"], pivot = [0, 0, 0] }]\n",
                 "pivot");
  expect_refused("dynamics", "duration = 1\nsupports = [{ group = \"last\" }]\n", "fix");
  expect_accepted("path", "supports = [{ group = \"last\", rigid = true, rotation = [0, 0, 1] }]\n");
  expect_accepted("path", "loads = [{ group = \"last\", total_moment = [0, 0, 1] }]\n");
}

TEST(StaticStages, KeepEveryValueOfTheirKeys) {
  const StageSpec s =
      stage("path",
            "gravity = [0, 0, -2]\nconstant_gravity = true\n"
            "supports = [{ group = \"first\", fix = [\"x\", \"rz\"], displacement = [3, 0, 0], "
            "rotation = [0, 0, 0.5] }]\n"
            "loads = [{ group = \"last\", moment = [1, 2, 3], constant = true }]\n"
            "newton = { tolerance = 1e-7, iterations = 9, solver = \"direct\" }\n"
            "first_step = -0.2\nlargest_step = 0.3\nmost_points = 7\n"
            "stop = { load_factor = { above = 2, below = -1 } }\n"
            "branch = { bifurcation = 2, mode = 3, sense = \"-\" }\n");
  EXPECT_EQ(s.gravity, (Vec3d{0, 0, -2}));
  EXPECT_TRUE(s.constant_gravity);
  EXPECT_EQ(s.supports[0].displacement, (Vec3d{3, 0, 0}));
  EXPECT_EQ(s.supports[0].rotation, (Vec3d{0, 0, 0.5}));
  EXPECT_EQ(s.loads[0].moment, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(s.loads[0].constant);
  EXPECT_EQ(s.newton.tolerance, 1e-7);
  EXPECT_EQ(s.newton.iterations, 9);
  EXPECT_EQ(s.newton.solver, LinearSolver::direct);
  EXPECT_EQ(s.path.first_step, -0.2);
  EXPECT_EQ(s.path.largest_step, 0.3);
  EXPECT_EQ(s.path.most_points, 7);
  EXPECT_EQ(s.path.above, 2.0);
  EXPECT_EQ(s.path.below, -1.0);
  ASSERT_TRUE(s.path.branch);
  EXPECT_EQ(s.path.branch->bifurcation, 2);
  EXPECT_EQ(s.path.branch->mode, 3);
  EXPECT_EQ(s.path.branch->sense, -1.0);
  const StageSpec e = stage("equilibrium", "steps = 4\nat_saddle = \"keep\"\n");
  EXPECT_EQ(e.steps, 4);
  EXPECT_EQ(e.at_saddle, AtSaddle::keep);
  const StageSpec m = stage("modes", "count = 3\nframes_per_mode = 0\namplitude = 0.25\n");
  EXPECT_EQ(m.count, 3);
  EXPECT_EQ(m.frames_per_mode, 0);
  EXPECT_EQ(m.amplitude, 0.25);
  const StageSpec b =
      stage("buckling", load + "search_to = 4.5\nlargest_step = 0.3\nmost_points = 7\ncount = 2\n");
  EXPECT_EQ(b.search_to, 4.5);
  EXPECT_EQ(b.path.largest_step, 0.3);
  EXPECT_EQ(b.path.most_points, 7);
  EXPECT_EQ(b.count, 2);
}

TEST(StaticStages, RefuseKeysOfOtherKinds) {
  expect_refused("path", load + "search_to = 1\n", "only with kind = \"buckling\"");
  expect_refused("equilibrium", "largest_step = 1\n", "only with kind = \"path\" or \"buckling\"");
  expect_refused("dynamics", "duration = 1\ncount = 3\n", "only with kind = \"buckling\" or \"modes\"");
  expect_refused("dynamics", "duration = 1\nconstant_gravity = true\n", "is used only with");
  expect_refused("dynamics", "duration = 1\nstop = { load_factor = { above = 1 } }\n",
                 "only with kind = \"fracture\", or kind = \"path\"");
  expect_refused("dynamics", "duration = 1\nloads = [{ group = \"all\", constant = true }]\n",
                 "is used only with");
  expect_refused("dynamics",
                 "duration = 1\nsupports = [{ group = \"all\", fix = [\"x\"], displacement = [1, 0, 0] }]\n",
                 "only with kind = \"equilibrium\", \"path\", \"buckling\" or \"fracture\"");
  for (const char* lines :
       {"duration = 1\n", "damping = { translation = 1 }\n", "strain = { increment = 1, every = 1 }\n",
        "loads = [{ group = \"all\", force = [1, 0, 0], ramp = 1 }]\n",
        "loads = [{ group = \"all\", force = [1, 0, 0], table = [[0, 1]] }]\n",
        "supports = [{ group = \"all\", fix = [\"rx\"], angular_velocity = [1, 0, 0] }]\n"})
    expect_refused("equilibrium", lines, "is used only with kind = \"dynamics\"");
  expect_refused("equilibrium", "stop = {}\n", "only with kind = \"dynamics\", \"path\" or \"fracture\"");
  expect_refused("equilibrium", "first_step = 0.1\n", "only with kind = \"path\"");
  expect_refused("modes", "steps = 2\n", "only with kind = \"equilibrium\"");
  expect_refused("path", load + "stop = { rest = { kinetic_energy_below = 1, during = 1 } }\n",
                 "only with kind = \"dynamics\"");
  // modes are about the supports as they stand: nothing would be moved
  expect_refused("modes", "supports = [{ group = \"all\", fix = [\"x\"], displacement = [1, 0, 0] }]\n",
                 "only with kind = \"equilibrium\", \"path\", \"buckling\" or \"fracture\"");
}

TEST(StaticStages, SupportsMoveOnlyWhatTheyHold) {
  const std::string support = "supports = [{ group = \"all\", fix = [\"x\", \"rz\"], ";
  expect_accepted("equilibrium", support + "displacement = [1, 0, 0], rotation = [0, 0, 1] }]\n");
  expect_refused("equilibrium", support + "displacement = [1, 0, 1] }]\n", "that fix does not hold");
  expect_refused("equilibrium", support + "rotation = [1, 0, 0] }]\n", "that fix does not hold");
}

TEST(StaticStages, NeedSomethingThatGrowsWithTheLoadFactor) {
  const std::string constant = "loads = [{ group = \"last\", force = [1, 0, 0], constant = true }]\n";
  const std::string zero = "loads = [{ group = \"last\" }]\n";
  const std::string because = "nothing grows with the load factor";
  for (const char* kind : {"path", "buckling", "fracture"}) {
    for (const std::string& lines :
         {std::string{}, constant, zero, std::string("gravity = [0, 0, 1]\nconstant_gravity = true\n"),
          std::string("supports = [{ group = \"first\", fix = [\"x\"] }]\n")})
      expect_refused(kind, lines, because);
    expect_accepted(kind, load);
    expect_accepted(kind, "loads = [{ group = \"last\", moment = [0, 0, 1] }]\n");
    expect_accepted(kind, constant + "gravity = [0, 0, 1]\n");
    for (const char* way :
         {"fix = [\"x\"], displacement = [1, 0, 0]", "fix = [\"rx\"], rotation = [1, 0, 0]"})
      expect_accepted(kind, constant + "supports = [{ group = \"first\", " + way + " }]\n");
  }
  for (const char* kind : {"equilibrium", "modes"}) expect_accepted(kind, constant);
}

TEST(StaticStages, PathEndsAtLoadFactorOneUnlessToldOtherwise) {
  const PathSettings up = stage("path", load).path;
  EXPECT_EQ(up.above, 1.0);
  EXPECT_FALSE(up.below);
  const PathSettings down = stage("path", load + "first_step = -0.1\n").path;
  EXPECT_EQ(down.below, -1.0);
  EXPECT_FALSE(down.above);
  const StageSpec far = stage("path", load + "stop = { distance = { between = [0, 9], below = 5 } }\n");
  EXPECT_FALSE(far.path.above || far.path.below);
  EXPECT_EQ(far.stop_distance->value, 5.0);
  const PathSettings back = stage("path", load + "stop = { load_factor = { below = 0.2 } }\n").path;
  EXPECT_EQ(back.below, 0.2);
  EXPECT_FALSE(back.above);
}

TEST(StaticStages, NumbersAreChecked) {
  expect_refused("path", load + "first_step = 0\n", "must not be 0");
  expect_refused("path", load + "largest_step = -1\n", "0 <= largest_step");
  expect_refused("path", load + "most_points = 0\n", "1 <= most_points");
  expect_refused("path", load + "branch = { mode = 0 }\n", "1 <= mode");
  expect_refused("path", load + "branch = { sense = 1 }\n", "one of \"+\", \"-\"");
  expect_refused("path", load + "stop = { load_factor = {} }\n", "must have above, below or both");
  expect_refused("equilibrium", "steps = 0\n", "1 <= steps");
  expect_refused("equilibrium", "newton = { tolerance = 1 }\n", "0 < tolerance < 1");
  expect_refused("equilibrium", "newton = { iterations = 3000000000 }\n", "iterations <= 1000000");
  expect_refused("equilibrium", "newton = { solver = \"dircet\" }\n", "did you mean \"direct\"?");
  expect_refused("modes", "count = 0\n", "1 <= count");
  expect_refused("modes", "frames_per_mode = -1\n", "0 <= frames_per_mode");
  expect_refused("modes", "amplitude = -1\n", "0 <= amplitude");
}

TEST(StaticStages, TheIterativeSolverOfFormerVersionsIsNamed) {
  expect_refused("equilibrium", "newton = { solver = \"iterative\" }\n",
                 "\"multigrid\" of the program vbond-petsc");
}

TEST(StaticStages, MultigridIsForProgramsThatHaveIt) {
#ifdef VBOND_PETSC
  for (const char* kind : {"equilibrium", "path", "buckling"})
    expect_accepted(kind, load + "newton = { solver = \"multigrid\" }\n");
  expect_accepted("modes", "newton = { solver = \"multigrid\" }\n");
  expect_refused("fracture", load + "newton = { solver = \"multigrid\" }\n",
                 "needs the factors of the tangent");
#else
  expect_refused("equilibrium", "newton = { solver = \"multigrid\" }\n", "this program has no multigrid");
#endif
}

TEST(StaticStages, FractureHasItsEnds) {
  const FractureSettings plain = stage("fracture", load).fracture;
  EXPECT_EQ(plain.end, 1.0);
  EXPECT_EQ(plain.control, FractureControl::load);
  EXPECT_FALSE(plain.load_drop);
  const StageSpec given = stage(
      "fracture", load +
                      "steps = 4\ncontrol = \"crack\"\n"
                      "stop = { load_factor = { above = 2 }, breaks = { count = 7 }, load_drop = 0.3 }\n");
  EXPECT_EQ(given.steps, 4);
  EXPECT_EQ(given.fracture.control, FractureControl::crack);
  EXPECT_EQ(given.fracture.end, 2.0);
  EXPECT_EQ(given.stop_breaks->count, 7);
  EXPECT_EQ(given.fracture.load_drop, 0.3);
  const auto stop = [](const std::string& inside) { return load + "stop = { " + inside + " }\n"; };
  expect_refused("fracture", stop("load_factor = { above = 0 }"), "0 < above");
  expect_refused("fracture", stop("load_factor = { below = 0.5 }"), "below");
  expect_refused("fracture", stop("breaks = { count = 0 }"), "1 <= count");
  expect_refused("fracture", stop("load_drop = 1.5"), "load_drop <= 1");
  expect_refused("fracture", load + "control = \"crck\"\n", "did you mean \"crack\"?");
  expect_refused("path", load + "control = \"crack\"\n", "only with kind = \"fracture\"");
  expect_refused("path", stop("breaks = { count = 3 }"), "only with kind = \"dynamics\" or \"fracture\"");
}

// A kind that makes no sense says nothing of the keys beside it.
TEST(StaticStages, MisspeltKindIsTheOnlyReport) {
  try {
    read(
        "[[stage]]\nkind = \"pth\"\nfirst_step = 0.1\ndamping = { translation = 1 }\n"
        "supports = [{ group = \"all\", fix = [\"x\"], displacement = [1, 0, 0], velocity = [1, 0, 0] }]\n"
        "loads = [{ group = \"all\", constant = true, ramp = 1 }]\nstop = { peak = 3 }\n");
    FAIL() << "was accepted";
  } catch (const CaseError& e) {
    EXPECT_EQ(e.problems().size(), 1U) << e.what();
  }
}

TEST(StaticStages, BondsAreMadeAsTheyBeginButNotOnTheWay) {
  const auto bonds = [](const std::string& when) {
    return report(
        "[[bonds]]\ndistance = 1.1\nstiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }\nwhen = "
        "\"" +
        when + "[[stage]]\nname = \"bend\"\nkind = \"equilibrium\"\n");
  };
  EXPECT_EQ(bonds("stage\"\nstages = [\"bend\"]\n"), "");
  EXPECT_EQ(bonds("approach\"\n"), "");
  EXPECT_NE(bonds("approach\"\nstages = [\"bend\"]\n").find("that stage is static"), std::string::npos);
}

TEST(StaticStages, FramesNeedAnIntervalInDynamicsOnly) {
  const std::string statics = "[[stage]]\nkind = \"modes\"\n", dynamics = "[[stage]]\nduration = 1\n";
  const Case c = read(statics + "[output]\nframes = {}\nlammps_dump = true\n");
  ASSERT_TRUE(c.output.frames);
  EXPECT_FALSE(c.output.frames->every);
  EXPECT_TRUE(read(statics + "[output]\nframes = { every = 2 }\n").output.frames->every);
  EXPECT_FALSE(read(statics).output.frames);
  EXPECT_NE(report(statics + dynamics + "[output]\nframes = {}\n").find("output.frames.every is missing"),
            std::string::npos);
}

TEST(TimeStep, MayBeAPartOfTheExactCriticalStep) {
  const std::string dynamics = "[[stage]]\nduration = 1\n[time]\n";
  const Case c = read(dynamics + "step = \"exact\"\nfraction = 0.5\n");
  const TimeSpec exact = c.time;
  ASSERT_TRUE(exact.step);
  EXPECT_TRUE(std::holds_alternative<ExactStep>(exact.step->value));
  EXPECT_EQ(exact.step->place.line, 9U);
  EXPECT_EQ(exact.given(), nullptr);
  EXPECT_EQ(exact.fraction, 0.5);
  const TimeSpec again = parse_case(to_toml(c), "resolved.toml").time;
  EXPECT_TRUE(again.step && !again.given());
  EXPECT_EQ(again.fraction, 0.5);
  EXPECT_EQ(read(dynamics + "step = 0.2\n").time.given()->value, 0.2);
  EXPECT_NE(report(dynamics + "step = \"exact\"\ninsist = true\n").find("only with step given as a time"),
            std::string::npos);
  EXPECT_NE(report(dynamics + "step = \"exact \"\n").find("did you mean \"exact\"?"), std::string::npos);
}

}  // namespace
}  // namespace vbond::static_stages_test
