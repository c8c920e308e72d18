#include <gtest/gtest.h>

#include <string>

#include "vbond/case/read.hpp"

namespace vbond {
namespace {

const std::string rod = "[[specimen]]\nkind = \"rod\"\nparticles = 10\nmass = 1\ninertia = 0.064\n";
const std::string stage = "[[stage]]\nduration = \"10 T0\"\n";

std::string report(const std::string& text) {
  try {
    parse_case(text, "case.toml");
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

void expect_accepted(const std::string& text) {
  EXPECT_EQ(report(text), "") << text;
}
void expect_refused(const std::string& text, const std::string& because) {
  EXPECT_NE(report(text).find(because), std::string::npos) << text << "\nwas met with: " << report(text);
}

const BondRecipe recipe_of(const std::string& lines) {
  return parse_case(rod + "[[bonds]]\ndistance = 1.1\n" + lines + stage, "case.toml").bonds.at(0).recipe;
}

TEST(CaseRules, AllMistakesAreReportedAtOnceInTheOrderOfTheFile) {
  try {
    parse_case(
        "[[specimen]]\nkind = \"rod\"\nparticles = 1\nmass = -1\ninertia = 0.064\ncolour = \"red\"\n"
        "[contact]\nlaw = \"herz\"\n[[stage]]\nname = \"a b\"\n[watch]\nevery = 0\n",
        "case.toml");
    FAIL() << "was accepted";
  } catch (const CaseError& e) {
    std::vector<std::uint32_t> lines;
    for (const Problem& p : e.problems()) lines.push_back(p.place.line);
    EXPECT_EQ(lines, (std::vector<std::uint32_t>{3, 4, 6, 8, 9, 10, 12})) << e.what();
  }
}

TEST(CaseRules, ReportIsWrittenAsFileLineColumnRuleWayOut) {
  EXPECT_EQ(report(rod + "[watch]\nevery = 0\n" + stage),
            "case.toml:7:1: watch.every = 0\n"
            "  must satisfy 1 <= every <= 1000000000\n"
            "  write for example every = 1");
}

TEST(CaseRules, TheCellIsGivenInOneWay) {
  const std::string edges = "a = [1, 0, 0]\nb = [0, 1, 0]\nc = [0, 0, 1]\n",
                    file = "from_specimen = \"grains\"\n";
  expect_accepted("[cell]\n" + edges + rod + stage);
  expect_accepted("[cell]\n" + file + "open = [\"c\"]\n" + rod + stage);
  expect_refused("[cell]\n" + rod + stage, "case.toml:1:1: cell.a is missing");
  expect_refused("[cell]\n" + file + "b = [0, 1, 0]\n" + rod + stage,
                 "case.toml:3:1: cell.b = [0, 1, 0]\n  is used only with no from_specimen");
  expect_refused("[cell]\n" + file + "corner = [0, 0, 0]\n" + rod + stage, "case.toml:3:1: cell.corner");
  expect_refused("[cell]\nfrom_specimen = true\n" + rod + stage, "case.toml:2:1: cell.from_specimen = true");
  EXPECT_EQ(report("[cell]\nfrom_specimen = true\n" + rod + stage).find("missing"), std::string::npos);
}

TEST(CaseRules, ParticlesAreWrappedIntoACell) {
  const std::string wrap = "[output]\nframes = { every = 1.0, wrap = true }\n";
  expect_accepted("[cell]\nfrom_specimen = \"x\"\n" + rod + stage + wrap);
  expect_refused(rod + stage + wrap, "case.toml:9:25: output.frames.wrap = true\n  the case has no cell");
}

TEST(CaseRules, SectionsGiveAreaAndMoments) {
  const std::string theory = "theory = \"bernoulli-euler\"\nE = 2\nnu = 0.5\nsection = ";
  const auto section = [&](const std::string& form) {
    return std::get<TheoryParameters>(recipe_of(theory + form + "\n").parameters).section;
  };
  EXPECT_EQ(section("{ shape = \"circle\", diameter = 0.2 }").J, circle(0.2).J);
  EXPECT_EQ(section("{ shape = \"annulus\", diameter = 0.2, inner_diameter = 0.1 }").A, annulus(0.2, 0.1).A);
  EXPECT_EQ(section("{ shape = \"square\", side = 0.2 }").J_p, square(0.2).J_p);
  EXPECT_EQ(section("{ shape = \"given\", A = 1, J = 2, J_p = 3 }").J_p, 3.0);
  const std::string bonds = rod + stage + "[[bonds]]\ndistance = 1.1\n" + theory;
  expect_refused(bonds + "{ shape = \"annulus\", diameter = 0.1, inner_diameter = 0.2 }\n",
                 "smaller than diameter");
  expect_refused(bonds + "{ shape = \"circle\", diameter = 1e-90 }\n", "must not vanish");
  expect_refused(bonds + "{ shape = \"circle\", diameter = 1, side = 1 }\n",
                 "is used only with shape = \"square\"");
}

TEST(CaseRules, KappaIsHutchinsonsForTheCircleUnlessGiven) {
  const std::string theory = "theory = \"timoshenko\"\nE = 1\nnu = 0.2\n";
  const std::string of_circle = theory + "section = { shape = \"circle\", diameter = 0.2 }\n";
  const std::string of_square = theory + "section = { shape = \"square\", side = 0.2 }\n";
  const auto kappa = [](const std::string& lines) {
    return std::get<TheoryParameters>(recipe_of(lines).parameters).kappa;
  };
  EXPECT_EQ(kappa(of_circle), hutchinson_circle(0.2));
  EXPECT_EQ(kappa(of_circle + "kappa = \"hutchinson\"\n"), hutchinson_circle(0.2));
  EXPECT_EQ(kappa(of_circle + "kappa = 0.9\n"), 0.9);
  EXPECT_EQ(kappa(of_square + "kappa = 0.8333\n"), 0.8333);
  expect_refused(rod + stage + "[[bonds]]\ndistance = 1\n" + of_square + "kappa = \"hutchinson\"\n",
                 "full circle");
}

TEST(CaseRules, CoefficientsMustMakeRestTheLeastEnergy) {
  const std::string bonds = rod + stage + "[[bonds]]\ndistance = 1.1\n";
  // slender bonds have B2 < 0; the bound is -B3/2
  expect_accepted(bonds + "coefficients = { B1 = 1, B2 = -0.005, B3 = 0.015, B4 = 0.002 }\n");
  expect_refused(bonds + "coefficients = { B1 = 1, B2 = -0.0075, B3 = 0.015, B4 = 0.002 }\n", "B2 > -B3/2");
  expect_refused(bonds + "coefficients = { B1 = 1, B2 = 0.1, B3 = -0.015, B4 = 0.002 }\n", "B3 > 0");
  expect_refused(bonds + "coefficients = { B1 = 0, B2 = 0.1, B3 = 0.015, B4 = 0.002 }\n", "0 < B1");
  const std::string evm = bonds + "law = \"evm\"\n";
  expect_accepted(evm + "coefficients = { B1 = 1, B2 = 0.03, B3 = -0.005, B4 = 0.002 }\n");
  expect_refused(evm + "coefficients = { B1 = 1, B2 = 0.03, B3 = -0.0085, B4 = 0.002 }\n",
                 "B2/4 + B3 + B4/2 > 0");
  expect_refused(bonds + "stiffness = { c_A = 1, c_D = 0, c_B = 1, c_T = 1 }\n", "0 < c_D");
}

TEST(CaseRules, AttachmentIsAWordOneDistanceOrTwo) {
  const std::string stiffness = "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }\n";
  EXPECT_EQ(recipe_of(stiffness).attachment, Attachment::centres);
  EXPECT_EQ(recipe_of(stiffness + "attach = \"surfaces\"\n").attachment, Attachment::surfaces);
  EXPECT_EQ(recipe_of(stiffness + "attach = 0.3\n").R_j, 0.3);
  EXPECT_EQ(recipe_of(stiffness + "attach = [0.3, 0.4]\n").R_i, 0.3);
  EXPECT_EQ(recipe_of(stiffness + "attach = [0.3, 0.4]\n").R_j, 0.4);
  const std::string bonds = rod + stage + "[[bonds]]\ndistance = 1.1\n" + stiffness;
  expect_refused(bonds + "attach = \"surface\"\n", "did you mean \"surfaces\"?");
  expect_refused(bonds + "attach = -0.1\n", "0 <= attach");
  expect_refused(bonds + "attach = [1, 2, 3]\n", "must have 2 elements");
  expect_refused(bonds + "attach = true\n", "this is true or false");
}

TEST(CaseRules, BondsAreMadeWhenTheCaseSays) {
  const std::string stiffness = "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }\n";
  const std::string bonds = rod + stage + "[[bonds]]\n" + stiffness;
  expect_accepted(bonds + "distance = 1\nwhen = \"approach\"\n");
  expect_accepted(bonds + "pairs = [[0, 1]]\nwhen = \"stage\"\nstages = [\"stage-1\"]\n");
  expect_refused(bonds + "distance = 1\nwhen = \"stage\"\n", "needs the names of the stages");
  expect_refused(bonds + "distance = 1\nstages = [\"stage-1\"]\n", "is used only with when");
  expect_refused(bonds + "pairs = [[3, 3]]\n", "cannot be bonded to itself");
  expect_refused(bonds + "from_specimen = false\n", "can only be true");
  expect_refused(bonds + "distance = 1\nn_2 = [0, 0, 0]\n", "zero vector");
  expect_accepted(bonds + "distance = 1\nreference_length = 0.3\n");
  expect_refused(rod + stage +
                     "[[bonds]]\ndistance = 1\nreference_length = 0.3\n"
                     "coefficients = { B1 = 1, B2 = 0, B3 = 0.015, B4 = 0.002 }\n",
                 "is used only with stiffness or theory");
}

TEST(CaseRules, BondsYieldCreepAndSoftenAsTheTablesSay) {
  const std::string stiffness = "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }\n";
  const BondRules yields =
      recipe_of(
          stiffness +
          "yield = { axial_force = 2, shear_force = 3, torque = 4, isotropic = { axial = 0.1 }, kinematic = "
          "{ bending = 0.2 } }\n")
          .rules;
  EXPECT_EQ(yields.yield.limit, (FlowLimits{2, 3, 0, 4}));
  EXPECT_EQ(yields.yield.compression, 2.0);
  EXPECT_EQ(yields.yield.isotropic, (FlowLimits{0.1, 0, 0, 0}));
  EXPECT_EQ(yields.yield.kinematic, (FlowLimits{0, 0, 0.2, 0}));
  EXPECT_EQ(
      recipe_of(stiffness + "yield = { axial_force = 2, compression_force = 5 }\n").rules.yield.compression,
      5.0);
  EXPECT_EQ(recipe_of(stiffness + "creep = { viscosity = 8 }\n").rules.creep, (Creep{0.125, 1}));
  EXPECT_EQ(
      recipe_of(stiffness + "creep = { norton = { exponent = 3, speed = 16, force = 2 } }\n").rules.creep,
      (Creep{2.0, 3}));
  const std::string section = "section = { shape = \"given\", A = 0.5, J = 1, J_p = 1 }";
  EXPECT_EQ(recipe_of(stiffness + "softening = { tension = 4, fracture_energy = 3, " + section + " }\n")
                .rules.softening,
            (Softening{2.0, 1.5}));
  const std::string bonds = rod + stage + "[[bonds]]\ndistance = 1.1\n" + stiffness;
  expect_refused(bonds + "yield = {}\n", "at least one load must have a limit");
  expect_refused(bonds + "yield = { torque = 1, compression_force = 1 }\n", "yields in tension, too");
  expect_refused(bonds + "yield = { axial_force = -1 }\n", "0 < axial_force");
  expect_refused(bonds + "creep = { norton = { exponent = 2.5, speed = 1, force = 1 } }\n", "whole number");
  expect_refused(bonds + "creep = {}\n", "exactly one of");
  expect_refused(bonds + "creep = { viscosity = 1 }\nstretching = { form = \"morse\", alpha = 1 }\n",
                 "stretch harmonically");
  expect_refused(bonds + "softening = { tension = 1, fracture_energy = 1 }\n", "section is missing");
}

// What a run writes down of its case is read again when it is resumed.
TEST(CaseRules, BondsWithRulesAreWrittenAsTheyCanBeRead) {
  const std::string stiffness = "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }\n";
  const std::string section = "section = { shape = \"circle\", diameter = 0.2 }";
  for (const std::string& lines :
       {"strength = { criterion = \"stress\", tension = 2, shear = 3, weibull = { modulus = 4 }, " + section +
            " }\n",
        "strength = { criterion = \"stress\", tension = 2, shear = 3, compression = 5, " + section + " }\n",
        std::string(
            "damping = { time = 0.1 }\nyield = { bending_moment = 2, kinematic = { bending = 0.1 } }\n"),
        std::string(
            "creep = { norton = { exponent = 3, speed = 0.7, force = 0.3 } }\nyield = { torque = 1 }\n"),
        std::string("creep = { viscosity = 0.3 }\n"),
        "softening = { tension = 0.7, fracture_energy = 0.3, " + section + " }\n"}) {
    const Case c = parse_case(rod + "[[bonds]]\ndistance = 1.1\n" + stiffness + lines + stage, "case.toml");
    const Case again = parse_case(to_toml(c), "resolved.toml");
    EXPECT_EQ(again.bonds[0].recipe.rules, c.bonds[0].recipe.rules) << to_toml(c);
    EXPECT_EQ(to_toml(again), to_toml(c));
  }
}

TEST(CaseRules, RampIsATableOfTwoPoints) {
  const auto factor = [](const std::string& text) {
    return parse_case(rod + stage + "loads = [{ group = \"all\", " + text + " }]\n", "case.toml")
        .stages[0]
        .loads[0]
        .factor.points;
  };
  EXPECT_TRUE(factor("force = [0, 0, 1]").empty());
  const auto ramp = factor("ramp = \"20 T0\"");
  ASSERT_EQ(ramp.size(), 2U);
  EXPECT_EQ(ramp[0].second, 0.0);
  EXPECT_EQ(ramp[1].first.value, 20.0);
  EXPECT_TRUE(ramp[1].first.in_T_0);
  EXPECT_EQ(ramp[1].second, 1.0);
  EXPECT_TRUE(
      factor("table = [[0, 0], [\"5 T0\", 1], [\"6 T0\", 2]]")[0].first.in_T_0);  // 0 is 0 in any unit
  const std::string loads = rod + stage + "loads = [{ group = \"all\", ";
  expect_refused(loads + "ramp = 1, table = [[0, 0]] }]\n", "only one of ramp and table");
  expect_refused(loads + "table = [[1, 0], [\"5 T0\", 1]] }]\n", "all bare numbers or all multiples");
  expect_refused(loads + "table = [[1, 0, 3]] }]\n", "must have 2 elements");
  expect_refused(loads + "table = [] }]\n", "at least one point");
  expect_refused(loads + "table = 3 }]\n", "this is a whole number");
}

TEST(CaseRules, SupportsMoveOnlyWhatTheyHold) {
  const std::string supports = rod + stage + "supports = [{ group = \"all\", ";
  expect_accepted(supports +
                  "fix = [\"x\", \"rz\"], velocity = [1, 0, 0], angular_velocity = [0, 0, 1] }]\n");
  expect_refused(supports + "fix = [\"x\"], velocity = [1, 0, 1] }]\n", "that fix does not hold");
  expect_refused(supports + "fix = [\"x\", \"rz\"], angular_velocity = [1, 0, 0] }]\n",
                 "that fix does not hold");
  expect_refused(supports + "fix = [] }]\n", "must hold something");
  expect_refused(supports + "fix = [\"w\"] }]\n", "must be one of");
  expect_refused(supports + "fix = \"x\" }]\n", "this is a string");
}

TEST(CaseRules, StopsAreChecked) {
  const std::string stop = rod + stage + "stop = ";
  const Case c = parse_case(stop + "{ distance = { between = [0, 9], above = 3 } }\n", "case.toml");
  EXPECT_FALSE(c.stages[0].stop_distance->below);
  EXPECT_EQ(c.stages[0].stop_distance->value, 3.0);
  expect_refused(stop + "{ distance = { between = [0, 9], above = 3, below = 1 } }\n",
                 "exactly one of below, above");
  expect_refused(stop + "{ distance = { between = [4, 4], below = 1 } }\n", "two different particles");
  expect_refused(stop + "{ peak = { average_over = 1, drop = 1.0 } }\n", "0 < drop < 1");
  expect_refused(stop + "{ peak = { average_over = 1, direction = [1, 0, 0] } }\n",
                 "is used only with quantity");
  expect_refused(stop + "{ peak = {} }\n", "average_over is missing");
  expect_refused(rod + stage + "strain = { increment = 0, every = 1 }\n", "must not be 0");
}

TEST(CaseRules, OnlyOneOfStepAndFractionIsUsed) {
  expect_accepted(rod + stage + "[time]\nstep = \"0.01 T0\"\ninsist = true\n");
  expect_accepted(rod + stage + "[time]\nfraction = 1\n");
  expect_refused(rod + stage + "[time]\nstep = 0.1\nfraction = 0.2\n", "is used only with no step given");
  expect_refused(rod + stage + "[time]\ninsist = true\n", "is used only with step");
  expect_refused(rod + stage + "[time]\nstep = 0\n", "0 < step");
}

TEST(CaseRules, MassAndInertiaAreNeededUnlessAFileHasThem) {
  const std::string bare = stage + "[[specimen]]\nkind = \"rod\"\nparticles = 10\n";
  expect_refused(bare + "inertia = 1\n", "one of mass and density is required");
  expect_refused(bare + "mass = 1\n", "inertia or a radius > 0 is required");
  expect_refused(bare + "density = 1\ninertia = 1\n", "density needs a radius");
  expect_accepted(bare + "density = 1\nradius = 0.5\n");
  expect_accepted(stage + "[[specimen]]\nkind = \"csv\"\nfile = \"points.csv\"\n");
}

// What other programs write is refused with the key that says it here.
TEST(CaseRules, ADiameterOfTheParticlesIsRefusedWithTheFactor) {
  const std::string bonds =
      rod +
      "[[bonds]]\ndistance = 1.1\ntheory = \"timoshenko\"\nE = 1\nnu = 0.2\nsection = { shape = \"circle\", ";
  const std::string section = report(bonds + "diameter = \"particles\" }\n" + stage);
  EXPECT_EQ(section.find("case.toml:11:31: bonds[0].section.diameter = \"particles\"\n  must be a length"),
            0U)
      << section;
  EXPECT_NE(section.find("write factor = 1 in place of diameter"), std::string::npos) << section;
  expect_accepted(bonds + "factor = 1 }\n" + stage);
  expect_refused(bonds + "factor = 1, diameter = 1 }\n" + stage, "both of diameter, factor");
  expect_refused(bonds + "diameter = 1, of = \"mean\" }\n" + stage,
                 "is used only with shape = \"circle\" and factor");
  expect_refused(bonds + "of = \"mean\" }\n" + stage, "none of diameter, factor");
}

TEST(CaseRules, StiffnessesPerAreaAreGivenInOneWay) {
  const std::string bonds =
      rod +
      "[[bonds]]\ndistance = 1.1\ntheory = \"parallel\"\nsection = { shape = \"circle\", "
      "diameter = 1 }\n";
  expect_accepted(bonds + "k_n = 1\nk_s = 1\n" + stage);
  expect_accepted(bonds + "E = 1\nstiffness_ratio = 2\n" + stage);
  expect_accepted(bonds + "k_n = 1\nk_s = 1\ngrain_k_n = 3\n" + stage);
  expect_refused(bonds + "k_n = 1\n" + stage, "bonds[0].k_s is missing");
  expect_refused(bonds + "k_s = 1\n" + stage, "none of k_n, E");
  expect_refused(bonds + "k_n = 1\nk_s = 1\nE = 1\n" + stage, "both of k_n, E");
  expect_refused(bonds + "k_n = 1\nk_s = 1\nnu = 0.2\n" + stage,
                 "is used only with theory = \"bernoulli-euler\"");
  expect_refused(bonds + "k_n = 0\nk_s = 1\n" + stage, "k_n");
}

TEST(CaseRules, MomentsCountForMohrCoulombAsTheyAreShared) {
  const std::string bonds =
      "theory = \"parallel\"\nsection = { shape = \"circle\", diameter = 2 }\nk_n = 1\nk_s = 1\n"
      "strength = { criterion = \"mohr-coulomb\", cohesion = 1, friction_angle = 0, "
      "tension_limit = 1";
  const Section s = circle(2.0);
  EXPECT_EQ(recipe_of(bonds + " }\n").rules.strength, mohr_coulomb_strength(s, 1, 0, 1));
  EXPECT_EQ(recipe_of(bonds + " }\n").rules.strength.bending, 0.0);
  EXPECT_EQ(recipe_of(bonds + ", moment_share = 0.5 }\n").rules.strength,
            mohr_coulomb_strength(s, 1, 0, 1, 0.5));
  EXPECT_DOUBLE_EQ(recipe_of(bonds + ", moment_share = 0.5 }\n").rules.strength.bending, 0.5 * s.r / s.J);
  EXPECT_DOUBLE_EQ(recipe_of(bonds + ", moment_share = 0.5 }\n").rules.strength.torsion, 0.5 * s.r / s.J_p);
}

// A report of 1e5 unknown keys, all of them told, would have 33 MB.
TEST(CaseRules, ManyMistakesOfAKindAreCounted) {
  std::string keys;
  for (int k = 0; k < 100000; ++k) keys += "colour" + std::to_string(k) + " = 1\n";
  const std::string text = report(rod + keys + stage);
  EXPECT_NE(text.find("case.toml:6:1: specimen[0].colour0 = 1"), std::string::npos) << text.substr(0, 500);
  EXPECT_NE(text.find("and 99980 more of this kind"), std::string::npos);
  EXPECT_LT(text.size(), 20000U);
}

TEST(CaseRules, SpecimensStayBelowAHundredMillionParticles) {
  const std::string tail = "\nmass = 1\ninertia = 1\n" + stage;
  expect_refused("[[specimen]]\nkind = \"block\"\ncells = [100000, 100000, 100000]" + tail, "more than 1e8");
  expect_refused("[[specimen]]\nkind = \"block\"\nlattice = \"fcc\"\ncells = [1000, 1000, 26]" + tail,
                 "more than 1e8");
  expect_accepted("[[specimen]]\nkind = \"block\"\nlattice = \"fcc\"\ncells = [1000, 1000, 25]" + tail);
  expect_refused("[[specimen]]\nkind = \"hemisphere\"\nparticles = 49\nsphere_radius = 7.73" + tail,
                 "the rim alone");
}

TEST(CaseRules, DeepNestingIsRefusedBeforeItIsParsed) {
  const std::string deep(100'000, '[');
  expect_refused("a = " + deep, "nested 32 deep");
  std::string dotted = "a";
  for (int k = 0; k < 100'000; ++k) dotted += ".a";
  expect_refused(dotted + " = 1\n", "nested 32 deep");
  expect_refused("[" + dotted + "]\n", "nested 32 deep");
  // but not for dots and brackets in comments and strings
  expect_accepted("# " + std::string(100, '.') + deep + "\ntitle = \"\"\"\n" + deep + "\"\"\"\n" + rod +
                  stage);
  expect_accepted("title = 'c:\\" + std::string(100, '.') + "'\n" + rod + stage);
  // a string may end with two quotes of its own; what follows must not be taken for a string
  expect_refused("a = [\"\"\"x\"\"\"\"\", { " + dotted + " = 1 }]\n", "nested 32 deep");
  expect_refused("a = ['''x''''', { " + dotted + " = 1 }]\n", "nested 32 deep");
  // nor after an empty one
  expect_refused("a = [\"\"\"\"\"\", { " + dotted + " = 1 }]\n", "nested 32 deep");
  expect_refused("a = ['''''', { " + dotted + " = 1 }]\n", "nested 32 deep");
  expect_refused(std::string((std::size_t{16} << 20) + 1, '\n'), "must not be over 16 MiB");
}

TEST(CaseRules, SpecimensAreArrangedBySensibleNumbers) {
  expect_refused(rod + "array = [{ count = 2, step = [0, 0, 0] }]\n" + stage,
                 "case.toml:6:23: specimen[0].array[0].step");
  expect_accepted(rod + "array = [{ count = 1, step = [0, 0, 0] }]\n" + stage);
  expect_refused(rod + "array = [{ count = 0, step = [1, 0, 0] }]\n" + stage, "1 <= count");
  const std::string one = "{ count = 1000, step = [1, 0, 0] }";
  expect_accepted(rod + "array = [" + one + ", " + one + "]\n" + stage);
  expect_refused(rod + "array = [" + one + ", " + one + ", " + one + "]\n" + stage,
                 "more than 1e8 particles");
  const std::string few = "{ count = 1, step = [1, 0, 0] }";
  expect_refused(rod + "array = [" + few + ", " + few + ", " + few + ", " + few + "]\n" + stage,
                 "must have at most 3 tables");
  expect_refused(rod + "turn = { axis = [0, 0, 0], angle = 1 }\n" + stage, "must not be the zero vector");
  expect_refused(rod + "turn = { axis = [0, 0, 1] }\n" + stage, "angle is missing");
  expect_refused(rod + "cut = [{ box = { min = [0, 0, 0], max = [1, 1, 1] }, keep = \"insid\" }]\n" + stage,
                 "did you mean \"inside\"?");
}

TEST(CaseRules, GroupsAreOfOneForm) {
  const std::string groups = rod + stage + "[groups]\n";
  expect_refused(groups + "g = { union = [\"a\"], type = 1 }\n", "exactly one of");
  expect_refused(groups + "g = { union = [] }\n", "must have at least 1 element");
  expect_refused(groups + "g = { difference = { of = \"a\" } }\n", "groups.g.difference.without is missing");
  expect_refused(groups + "g = { type = 0 }\n", "1 <= type");
  expect_refused(groups + "g = { cylinder = { from = [1, 0, 0], to = [1, 0, 0], radius = 1 } }\n",
                 "the ends of the axis must differ");
  expect_refused(rod + stage + "[[velocities]]\nkind = \"rigid\"\nmagnitude = 1\n", "is used only with");
}

}  // namespace
}  // namespace vbond
