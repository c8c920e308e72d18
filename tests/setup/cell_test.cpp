// Cells of cases: what they make of specimens and bonds, and what is refused.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "cases.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/periodic_cell.hpp"

namespace vbond::test {
namespace case_cell_tests {

Case in_cell(
    const std::string& more, const std::string& cell = "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\n",
    const std::string& specimen = "kind = \"block\"\nlattice = \"simple-cubic\"\ncells = [3, 3, 3]\n") {
  return parse_case("[cell]\n" + cell + "[[specimen]]\n" + specimen +
                        "radius = 0.4\nmass = 1.0\n"
                        "[[bonds]]\nname = \"b\"\ndistance = 1.1\n"
                        "stiffness = { c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1 }\n" +
                        more,
                    "case.toml");
}

const std::string still = "[[stage]]\nduration = 1.0\n";

std::string mistake(const std::string& more,
                    const std::string& cell = "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\n") {
  try {
    build(in_cell(more, cell));
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

TEST(CaseCell, ALatticeThatFitsHasBondsThroughAllFaces) {
  const Built b = build(in_cell(still));
  EXPECT_EQ(b.state.bonds.size(), 81u);  // 3 of each particle
  EXPECT_TRUE(b.notes.empty());
  EXPECT_DOUBLE_EQ(volume(b.state.cell), 27.0);
  for (const Bond& bond : b.state.bonds) EXPECT_NEAR(bond.a, 1.0, 1e-12);
}

TEST(CaseCell, BringsParticlesIntoTheCellFromItsCorner) {
  const Case c = in_cell(still, "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\ncorner = [-1.5, -0.5, 4]\n");
  const Built b = build(c);
  for (const Vec3d& r : b.model.r_0) {
    const Vec3d s = r - Vec3d{-1.5, -0.5, 4};
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(component(s, k) >= 0 && component(s, k) < 3) << k;
  }
  EXPECT_EQ(b.state.bonds.size(), 81u);
}

TEST(CaseCell, AnOpenEdgeHasNoBondsThroughIt) {
  const Built b = build(in_cell(still, "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 5]\nopen = [\"c\"]\n"));
  EXPECT_EQ(b.state.bonds.size(), 72u);  // 9 fewer
}

/// With strengths by chance. A bond that joins a particle with another of the cell itself has the same in an
/// open body.
TEST(CaseCell, BondsThroughFacesHaveStrengthsOfTheirOwn) {
  const auto built = [](std::size_t along, bool is_open) {
    Case c = in_cell(
        still, fmt::format("a = [{0}, 0, 0]\nb = [0, {0}, 0]\nc = [0, 0, {0}]\n", along),
        fmt::format("kind = \"block\"\nlattice = \"simple-cubic\"\ncells = [{0}, {0}, {0}]\n", along));
    if (is_open) c.cell.reset();
    c.bonds[0].recipe.rules.strength.axial = 1.0;
    c.bonds[0].recipe.weibull = {5.0, 0, 0, 1};
    return build(c);
  };
  std::map<std::pair<ParticleId, ParticleId>, double> of_open;
  for (const Bond& b : built(2, true).state.bonds) of_open[{b.i, b.j}] = strength_factor(b);
  EXPECT_EQ(of_open.size(), 12u);
  for (const std::size_t along : {std::size_t{1}, std::size_t{2}, std::size_t{3}}) {
    std::set<double> different;
    std::size_t inside = 0;
    const Built b = built(along, false);
    for (const Bond& bond : b.state.bonds) {
      different.insert(strength_factor(bond));
      if (along != 2 || !image_of_j(bond).is_itself()) continue;
      EXPECT_EQ(strength_factor(bond), (of_open.at({bond.i, bond.j})));
      ++inside;
    }
    EXPECT_EQ(different.size(), 3 * along * along * along);  // all of them
    EXPECT_EQ(inside, along == 2 ? 12u : 0u);
  }
}

TEST(CaseCell, ACellMayBeSmallerThanABond) {
  const Built b = build(in_cell(still, "a = [0.6, 0, 0]\nb = [0, 2, 0]\nc = [0, 0, 2]\n",
                                "kind = \"list\"\npositions = [[0, 0, 0]]\n"));
  ASSERT_EQ(b.state.bonds.size(), 1u);  // to the image at 0.6 on one side: that on the other is its mirror
  EXPECT_EQ(b.state.bonds[BondId{0}].i, b.state.bonds[BondId{0}].j);
  const Built wide = build(in_cell(still, "a = [0.5, 0, 0]\nb = [0, 0.75, 0]\nc = [0, 0, 2]\n",
                                   "kind = \"list\"\npositions = [[0, 0, 0]]\n"));
  EXPECT_EQ(wide.state.bonds.size(), 5u);  // 0.5, 1.0 along a, 0.75 along b, two across: 0.901
}

TEST(CaseCell, ASeamOfALatticeIsNoted) {
  const Built b = build(in_cell(still, "a = [3.05, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\n"));
  ASSERT_EQ(b.notes.size(), 1u);
  EXPECT_TRUE(contains(b.notes[0], "repeats after 3 along x, and edge a of the cell is 3.05"));
}

TEST(CaseCell, RefusesWhatIsNoCell) {
  const std::string flat = mistake(still, "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [3, 3, 0]\n");
  EXPECT_TRUE(contains(flat, "case.toml:1:1: the edges of the cell span the volume 0")) << flat;
  EXPECT_TRUE(contains(mistake(still, "a = [0, 3, 0]\nb = [3, 0, 0]\nc = [0, 0, 3]\n"), "right-handed"));
  EXPECT_TRUE(contains(mistake(still, "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 1, 3]\nopen = [\"c\"]\n"),
                       "an open edge of the cell must be along an axis"));
  EXPECT_TRUE(contains(mistake(still, "a = [3, 0, 0]\nb = [0, 3, 1]\nc = [0, 0, 3]\nopen = [\"c\"]\n"),
                       "edge b of the cell is not normal to an open direction"));
}

TEST(CaseCell, RefusesWhatDoesNotGoTogether) {
  const auto refuses = [](const std::string& more, const char* what) {
    const std::string text = mistake(more);
    EXPECT_TRUE(contains(text, what)) << what << " not in: " << text;
  };
  const std::string moving = "[[stage]]\nduration = 1.0\n[stage.cell]\n";
  try {
    in_cell(moving + "xx = { rate = 1.0, stress = 1.0 }\n");
    ADD_FAILURE() << "accepted";
  } catch (const CaseError& e) {
    EXPECT_TRUE(contains(e.what(), "a component is given by its strain or by its stress, not by both"));
    EXPECT_TRUE(contains(e.what(), "case.toml:18:20: stage[0].cell.xx.stress")) << e.what();
  }
  try {
    in_cell(moving + "xx = { stress = 1.0 }\n");
    ADD_FAILURE() << "accepted";
  } catch (const CaseError& e) {
    EXPECT_TRUE(contains(e.what(), "needs to know how fast")) << e.what();
  }
  const std::string floor =
      "[contact]\nlaw = \"hertz\"\nE = 1.0\nnu = 0.2\n"
      "[[wall]]\nname = \"w\"\nshape = \"plane\"\npoint = [0, 0, -1]\nnormal = [0, 0, 1]\n";
  const std::string open_upwards = "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 9]\nopen = [\"c\"]\n";
  refuses(floor + still, "wall \"w\" ends at a face of the cell");
  EXPECT_EQ(mistake(floor + still, open_upwards), "");
  EXPECT_TRUE(
      contains(mistake(floor + "[[stage]]\nduration = 1.0\ncell = { xx = { rate = 1.0 } }\n", open_upwards),
               "walls, which stand still while the cell moves"));
  EXPECT_TRUE(contains(
      mistake(floor + still + "walls = [{ wall = \"w\", angular_velocity = [0, 0, 1] }]\n", open_upwards),
      "wall \"w\" turns"));
  refuses("[[stage]]\nkind = \"buckling\"\ncell = { xx = { stress = -1.0 } }\n", "give way to a stress");
  refuses("[[stage]]\nduration = 1.0\ngravity = [0, 0, -1]\ncell = { xx = { rate = 1.0 } }\n",
          "loads or gravity on a body whose cell moves");
  const std::string open = mistake("[[stage]]\nduration = 1.0\ncell = { xz = { rate = 1.0 } }\n",
                                   "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\nopen = [\"c\"]\n");
  EXPECT_TRUE(contains(open, "the body is open along z")) << open;
  Case without = in_cell("[[stage]]\nduration = 1.0\ncell = { xx = { rate = 1.0 } }\n");
  without.cell.reset();
  EXPECT_TRUE(contains(text_of_error(without), "the case has no cell"));
}

// A named pair of which two images are equally near is no answer.
TEST(CaseCell, RefusesAPairWithTwoNearestImages) {
  const auto told = [](const char* a) {
    try {
      build(parse_case(std::string("[cell]\na = ") + a +
                           "\nb = [0, 3, 0]\nc = [0, 0, 4]\n"
                           "[[specimen]]\nkind = \"list\"\npositions = [[0, 0, 0], [1, 0, 0]]\nradius = 0.4\n"
                           "mass = 1.0\n[[bonds]]\nname = \"b\"\npairs = [[0, 1]]\n"
                           "stiffness = { c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1 }\n"
                           "[[stage]]\nduration = 1.0\n",
                       "case.toml"));
    } catch (const CaseError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_TRUE(contains(told("[2, 0, 0]"), "two images of the second particle are equally near"));
  EXPECT_EQ(told("[2.1, 0, 0]"), "");
}

TEST(CaseCell, TakesWavesAlongWhatRepeats) {
  const char* sheet = "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\nopen = [\"c\"]\n";
  const std::string modes = "[[stage]]\nkind = \"modes\"\n";
  EXPECT_EQ(mistake(modes + "wave_vectors = [[0.1, 2, 0]]\n", sheet), "");
  EXPECT_EQ(mistake(modes + "wave_phases = [[0.1, 0.5, 0], [0, 0, 0]]\n", sheet), "");
  EXPECT_EQ(mistake("[[stage]]\nkind = \"buckling\"\nwave_phases = [[0.1, 0, 0]]\ncell = { xx = { stress = "
                    "-1.0 } }\n",
                    sheet),
            "");
  EXPECT_TRUE(contains(mistake(modes + "wave_phases = [[0, 0, 0.1]]\n", sheet), "along the open edge c"));
  EXPECT_TRUE(contains(mistake(modes + "wave_vectors = [[0, 0.1, 0.1]]\n", sheet), "along the open edge c"));
  Case without = in_cell(modes + "wave_vectors = [[0.1, 2, 0]]\n");
  EXPECT_EQ(without.stages.back().frames_per_mode, 0);
  without.cell.reset();
  EXPECT_TRUE(contains(text_of_error(without), "has wave vectors"));
  try {
    in_cell(modes + "wave_vectors = [[0.1, 2, 0]]\nwave_phases = [[0.1, 0, 0]]\n");
    ADD_FAILURE() << "accepted";
  } catch (const CaseError& e) {
    EXPECT_TRUE(contains(e.what(), "waves are given in two ways")) << e.what();
  }
}

TEST(CaseCell, RefusesAServoThatSwingsFromStepToStep) {
  const auto told = [](const char* servo) {
    return text_of_stage_error(
        in_cell(std::string("[[stage]]\nduration = 10.0\ncell = { xx = { stress = 0.1 }, servo = { ") +
                servo + ", fastest = 0.1 } }\n"));
  };
  EXPECT_EQ(told("modulus = 1.0, time = 1.0"), "");
  const std::string text = told("modulus = 0.01, time = 1.0");  // C = 1, dt = 0.046
  EXPECT_TRUE(contains(text, "would change the stress by up to 4.6")) << text;
  EXPECT_TRUE(contains(text, "use modulus = 1,")) << text;
}

// eta = 0.2: the rate of a step goes to -2 of it in the next at a time of 0.1, and to -0.4 at 0.5.
TEST(CaseCell, RefusesAServoThatIsQuickerThanDampingAllows) {
  const auto told = [](const char* time) {
    return text_of_stage_error(in_cell(
        std::string("damping = { time = 0.2 }\n[[stage]]\nduration = 10.0\n"
                    "cell = { xx = { stress = 0.1 }, servo = { modulus = 1.0, fastest = 0.1, time = ") +
        time + " } }\n"));
  };
  EXPECT_EQ(told("0.5"), "");
  const std::string text = told("0.1");
  EXPECT_TRUE(contains(text, "adds up to 0.2 of the rate")) << text;
}

TEST(CaseCell, RefusesTwoParticlesAtOnePlaceThroughAFace) {
  const std::string text = [] {
    try {
      build(in_cell(still, "a = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\n",
                    "kind = \"list\"\npositions = [[0, 0, 0], [3, 0, 0]]\n"));
    } catch (const CaseError& e) {
      return std::string(e.what());
    }
    return std::string();
  }();
  EXPECT_TRUE(contains(text, "at the same place")) << text;
}

// ---- what turns as one body ---------------------------------------------------------------------------

/// A rod of three along x in a cell of 6, and what is refused of it as its first stage begins.
std::string refusal(const std::string& positions, const std::string& more, const std::string& bonds = "") {
  const std::string text =
      "[cell]\na = [6, 0, 0]\nb = [0, 6, 0]\nc = [0, 0, 6]\n[[specimen]]\nname = \"rod\"\nkind = \"list\"\n"
      "positions = " +
      positions +
      "\nmass = 1.0\nradius = 0.4\n[[bonds]]\nname = \"b\"\ndistance = 1.1\n"
      "stiffness = { c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1 }\n" +
      bonds + more;
  try {
    const Case c = parse_case(text, "case.toml");
    Built b = build(c);
    for (std::size_t k = 0; k < c.stages.size(); ++k)
      if (is_static(c.stages[k].kind))
        build_static_stage(c, b.model, static_cast<int>(k), b.state);
      else
        build_stage(c, b.model, static_cast<int>(k), b.state);
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}
const std::string whole = "[[2, 3, 3], [3, 3, 3], [4, 3, 3]]", cut = "[[5, 3, 3], [6, 3, 3], [7, 3, 3]]",
                  in_pieces = "[[5, 3, 3], [0, 3, 3], [1, 3, 3]]";  // as the case itself says

TEST(CaseCell, RefusesToTurnWhatAFaceCuts) {
  const std::string stage = "[[stage]]\nname = \"s\"\nduration = 1.0\n",
                    rest = "[[stage]]\nname = \"s\"\nkind = \"equilibrium\"\n";
  const auto support = [](const std::string& keys) {
    return "supports = [{group = \"rod\", rigid = true" + keys + "}]\n";
  };
  const std::string velocities = "[[velocities]]\nkind = \"rigid\"\n";
  const std::vector<std::string> turning = {velocities + "angular_velocity = [0, 0, 1]\n" + stage,
                                            stage + support(", angular_velocity = [0, 0, 1]"),
                                            stage + support(", fix = []"),
                                            stage + support(", fix = [\"x\", \"y\", \"z\", \"rx\", \"rz\"]"),
                                            rest + support(", rotation = [0, 0, 0.1]"),
                                            rest + support(", fix = [\"x\", \"y\", \"z\"]")};
  for (const std::string& t : turning) {
    EXPECT_EQ(refusal(whole, t), "");
    const std::string of_cut = refusal(cut, t), of_pieces = refusal(in_pieces, t);
    EXPECT_TRUE(contains(of_cut, "a face of the cell cuts specimen \"rod\"")) << t << of_cut;
    EXPECT_TRUE(contains(of_pieces, "a bond joins its particles 0 and 1 through a face of the cell"))
        << t << of_pieces;
    EXPECT_TRUE(contains(of_pieces, "case.toml:1")) << of_pieces;
    EXPECT_TRUE(contains(of_pieces, "move the body or cell.corner")) << of_pieces;
  }
  const std::vector<std::string> straight = {velocities + "velocity = [0, 0, 1]\n" + stage,
                                             stage + support(""), stage + support(", velocity = [0, 0, 1]"),
                                             stage + support(", fix = [\"x\", \"rx\", \"ry\", \"rz\"]"),
                                             rest + support(", displacement = [0, 0, 0.1]")};
  for (const std::string& t : straight)
    for (const std::string& positions : {cut, in_pieces}) EXPECT_EQ(refusal(positions, t), "") << t;
}

// Bonds that the stage makes count as well; without any, what stands in pieces as the case says is meant so.
TEST(CaseCell, RefusesToTurnWhatAStageBondsThroughAFace) {
  const std::string first = "[[stage]]\nname = \"first\"\nduration = 1.0\n",
                    turn =
                        "[[stage]]\nname = \"turn\"\nduration = 1.0\nsupports = [{group = \"rod\", rigid = "
                        "true, fix = []}]\n";
  const auto made_in = [](const std::string& name) {
    return "when = \"stage\"\nstages = [\"" + name + "\"]\n";
  };
  EXPECT_TRUE(
      contains(refusal(in_pieces, first + turn, made_in("turn")), "stage \"turn\": the rigid support"));
  EXPECT_EQ(refusal(in_pieces, turn + first, made_in("first")), "");
}

}  // namespace case_cell_tests
}  // namespace vbond::test
