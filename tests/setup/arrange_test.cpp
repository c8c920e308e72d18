#include "cases.hpp"
#include "vbond/case/read.hpp"

namespace vbond::test {
namespace {

Case with_specimen(const std::string& keys, const std::string& more = "") {
  return parse_case("[[specimen]]\nmass = 1\nradius = 0.4\n" + keys + more + "[[stage]]\nduration = 1\n",
                    "case.toml");
}

const std::string stiffness = "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }\n";
const std::string rod = "kind = \"rod\"\nparticles = 5\n";
using Numbers = std::vector<std::size_t>;

std::string all_notes(const Built& b) {
  std::string notes;
  for (const std::string& note : b.notes) notes += note + "\n";
  return notes;
}

void expect_near(const PerParticle<Vec3d>& r, const std::vector<Vec3d>& expected) {
  ASSERT_EQ(r.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LT(norm(r[ParticleId{i}] - expected[i]), 1e-14) << "particle " << i;
}

// A sheet of 9 x 9 with a hole of radius 2.1 about its middle loses the 13 sites i^2 + j^2 <= 4.
TEST(Cut, MakesAPlateWithAHoleInTwoLines) {
  const Case c = with_specimen(
      "kind = \"sheet\"\nlattice = \"square\"\nparticles = [9, 9]\n"
      "cut = [{ cylinder = { from = [4, 4, -1], to = [4, 4, 1], radius = 2.1 } }]\n",
      "[[bonds]]\ndistance = 1.1\n" + stiffness);
  const Built b = build(c);
  EXPECT_EQ(b.model.particles(), 81u - 13u);
  for (const Vec3d& r : b.model.r_0) EXPECT_GT(norm(r - Vec3d{4, 4, 0}), 2.1);
  // of 2 * 9 * 8 bonds those with an end in the hole go: 13 sites of 4 bonds, 16 of which join two of them
  EXPECT_EQ(b.state.bonds.size(), 144u - (4 * 13 - 16));
  EXPECT_EQ(all_notes(b), "a cut of specimen \"body\" leaves 68 of 81 particles\n");
  EXPECT_EQ(count_particles(c), 0.0) << "only making them tells";
}

TEST(Cut, KeepsTheInsideIfItIsToldAndGoesOnWithWhatIsLeft) {
  const Built b = build(
      with_specimen(rod + "cut = [{ box = { min = [1, -1, -1], max = [9, 1, 1] }, keep = \"inside\" },\n"
                          "       { half_space = { point = [3, 0, 0], normal = [-1, 0, 0] } },\n"
                          "       { sphere = { centre = [9, 0, 0], radius = 1 } }]\n"));
  expect_near(b.model.r_0, {{1, 0, 0}, {2, 0, 0}});
  const std::string notes = all_notes(b);
  EXPECT_TRUE(contains(notes, "leaves 4 of 5 particles; it leaves nothing of its first\n")) << notes;
  EXPECT_TRUE(contains(notes, "leaves 2 of 4 particles; it leaves nothing of its ends, last\n")) << notes;
  EXPECT_TRUE(contains(notes, "leaves 2 of 2 particles\n")) << notes;
  EXPECT_EQ(b.model.find_group("ends"), nullptr);
}

TEST(Cut, ThatLeavesNothingIsRefusedWhereItStands) {
  const std::string error = text_of_error(
      with_specimen(rod + "cut = [{ plane = { point = [0, 0, 0], normal = [1, 0, 0], within = 1 } },\n"
                          "       { plane = { point = [0, 0, 0], normal = [0, 0, 1], within = 1 } }]\n"));
  EXPECT_TRUE(contains(error, "case.toml:7:8: a cut of specimen \"body\" leaves none of 3 particles"))
      << error;
}

TEST(Cut, NeedsOneRegion) {
  try {
    with_specimen(rod + "cut = [{ keep = \"inside\" }]\n");
    FAIL() << "was accepted";
  } catch (const CaseError& e) {
    EXPECT_TRUE(contains(e.what(), "case.toml:6:8: specimen[0].cut[0]: none of")) << e.what();
  }
}

// 30 degrees about z through (1, 0, 0), then up: (cos, sin) of 30 degrees are (sqrt(3)/2, 1/2).
TEST(Turn, CarriesPositionsAndOrientationsAndComesBeforeMove) {
  const double h = std::sqrt(0.75);
  const Built b =
      build(with_specimen("kind = \"rod\"\nparticles = 3\nturn = { axis = [0, 0, 2], angle = "
                          "0.52359877559829887, about = [1, 0, 0] }\n"
                          "move = [0, 0, 5]\n"));
  expect_near(b.model.r_0, {{1 - h, -0.5, 5}, {1, 0, 5}, {1 + h, 0.5, 5}});
  for (const Quatd& q : b.state.q) EXPECT_LT(norm(rotate(q, Vec3d{1, 0, 0}) - Vec3d{h, 0.5, 0}), 1e-15);
  EXPECT_EQ(b.state.r, b.model.r_0);
}

TEST(Turn, TurnsVelocitiesOfAFileToo) {
  const Built b =
      build(parse_case("[[specimen]]\nkind = \"lammps\"\natom_style = \"sphere\"\nfile = \"" VBOND_TEST_DATA
                       "/lammps_sphere.data\"\nturn = { axis = [1, 0, 0], angle = 1.5707963267948966 }\n"
                       "[[stage]]\nduration = 1\n[time]\nstep = 1\n",
                       "case.toml"));
  EXPECT_LT(norm(b.state.v[ParticleId{0}] - Vec3d{1, -3, 2}), 1e-14);
  EXPECT_LT(norm(b.state.omega[ParticleId{1}] - Vec3d{0, -6, 0}), 1e-14);
}

TEST(Array, HalfEndsOfRodsGoWithCutsAndCopies) {
  const Built b =
      build(with_specimen("kind = \"rod\"\nparticles = 4\nhalf_ends = true\ncut = [{ sphere = { centre = [1, "
                          "0, 0], radius = 0.5 } "
                          "}]\narray = [{ count = 2, step = [10, 0, 0] }]\n"));
  std::vector<double> masses;
  for (const double m : b.model.mass) masses.push_back(m);
  EXPECT_EQ(masses, (std::vector<double>{0.5, 1, 0.5, 0.5, 1, 0.5}));
  EXPECT_EQ(b.model.inertia[ParticleId{0}], 0.5 * b.model.inertia[ParticleId{1}]);
}

TEST(Array, CopiesAlongItsStepsTheFirstRunningFastest) {
  const Case c = with_specimen(
      "kind = \"rod\"\nparticles = 2\narray = [{ count = 3, step = [10, 0, 0] }, "
      "{ count = 2, step = [0, 4, 0] }]\n");
  const Built b = build(c);
  expect_near(b.model.r_0, {{0, 0, 0},
                            {1, 0, 0},
                            {10, 0, 0},
                            {11, 0, 0},
                            {20, 0, 0},
                            {21, 0, 0},
                            {0, 4, 0},
                            {1, 4, 0},
                            {10, 4, 0},
                            {11, 4, 0},
                            {20, 4, 0},
                            {21, 4, 0}});
  EXPECT_EQ(numbers(b.model, "last"), (Numbers{1, 3, 5, 7, 9, 11}));
  EXPECT_EQ(count_particles(c), 12.0);
}

TEST(Array, OfTooManyParticlesIsRefusedBeforeTheyAreMade) {
  const std::string error =
      text_of_error(with_specimen(rod + "array = [{ count = 50_000_000, step = [10, 0, 0] }]\n"));
  EXPECT_TRUE(contains(error, "the array of specimen \"body\" makes 250000000 particles")) << error;
}

// A chain of four from a file, of which the second atom is cut away: the bond 2 - 3 stays, as 1 - 2, in
// each copy, and masses stay with their atoms.
TEST(Arranged, BondsMassesAndPartsOfAFileFollowTheirParticles) {
  const TemporaryFile file("chain.data",
                           "chain\n\n4 atoms\n3 bonds\n\nMasses\n\n1 2\n2 3\n\nAtoms # bond\n\n1 1 1 0 0 0\n"
                           "2 1 1 1 0 0\n3 1 2 2 0 0\n4 1 1 3 0 0\n\nBonds\n\n1 1 1 2\n2 1 2 3\n3 2 3 4\n");
  const Built b =
      build(parse_case("[[specimen]]\nkind = \"list\"\npositions = [[0, 9, 0]]\nmass = 1\nradius = 0.4\n"
                       "[[specimen]]\nname = \"chain\"\nkind = \"lammps\"\nfile = \"" +
                           file.path().string() +
                           "\"\nradius = 0.4\ncut = [{ sphere = { centre = [1, 0, 0], radius = 0.5 } }]\n"
                           "array = [{ count = 2, step = [0, 0, 3] }]\n[[bonds]]\nfrom_specimen = true\n" +
                           stiffness + "[groups]\nodd = { type = 2 }\n[[stage]]\nduration = 1\n",
                       "case.toml"));
  expect_near(b.model.r_0, {{0, 9, 0}, {0, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 0, 3}, {2, 0, 3}, {3, 0, 3}});
  EXPECT_EQ(b.model.mass.values(), (std::vector<double>{1, 2, 3, 2, 2, 3, 2}));
  EXPECT_EQ(numbers(b.model, "odd"), (Numbers{2, 5}));
  ASSERT_EQ(b.state.bonds.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(b.state.bonds[BondId{k}].i.value, 2 + 3 * k);
    EXPECT_EQ(b.state.bonds[BondId{k}].j.value, 3 + 3 * k);
  }
  EXPECT_TRUE(contains(all_notes(b), "leaves 3 of 4 particles and 1 of the 3 bonds that it brings"))
      << all_notes(b);
}

// In the frames of its particles the axis of a bond does not know that the body was turned.
TEST(Arranged, BondsOfATurnedBodyLieInItAsBefore) {
  const std::string bonds = "[[bonds]]\ndistance = 1.1\n" + stiffness;
  const Built b =
      build(with_specimen(rod + "turn = { axis = [1, 2, 3], angle = 1.25, about = [1, 1, 0] }\n", bonds));
  ASSERT_EQ(b.state.bonds.size(), 4u);
  const Vec3d along{1, 0, 0};  // the rod, in its own frame
  for (const Bond& bond : b.state.bonds) {
    EXPECT_NEAR(bond.a, 1.0, 1e-14);
    EXPECT_LT(norm(rotate(bond.frame_i, along) - along), 1e-14);
    EXPECT_LT(norm(rotate(frame_j(bond), along) - along), 1e-14);
  }
}

}  // namespace
}  // namespace vbond::test
