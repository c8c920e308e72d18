#include "lammps_files.hpp"
#include "vbond/case/read.hpp"

namespace vbond::test {
namespace {

// Atom 20 comes before atom 3 in the file and lies one period of 10 farther along x; numbers have gaps.
const char* const chain = R"(a chain of three

3 atoms
2 bonds
1 atom types
1 bond types
0 angles
-1 9 xlo xhi
-1 1 ylo yhi
-1 1 zlo zhi
0 0 0 xy xz yz

Masses

1 2.5  # of type 1

Atoms  # bond

20 1 1 -8.0 0 0 1 0 0
3 1 1 0.0 0 0  # the first
7 1 1 1.0 0 0

Bonds

1 1 20 7
2 1 3 7
)";

TEST(LammpsSpecimen, IsOrderedByAtomNumberWithItsBondsAndMasses) {
  const TemporaryFile file("chain.data", chain);
  const Built b = build(lammps_case(file.path(), "bond"));
  ASSERT_EQ(b.model.particles(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(b.model.r_0[ParticleId{i}], (Vec3d{static_cast<double>(i), 0, 0}));
    EXPECT_EQ(b.model.mass[ParticleId{i}], 2.5);
  }
  ASSERT_EQ(b.state.bonds.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {  // ordered by (i, j)
    EXPECT_EQ(b.state.bonds[BondId{k}].i.value, k);
    EXPECT_EQ(b.state.bonds[BondId{k}].j.value, k + 1);
  }
}

TEST(LammpsSpecimen, BondsCountFromItsFirstParticle) {
  const TemporaryFile file("chain.data", chain);
  Case c = lammps_case(file.path(), "bond");
  SpecimenSpec probe = specimen(ListedSpecimen{{{0, 5, 0}, {0, 6, 0}}}, "probe");
  c.specimens.insert(c.specimens.begin(), probe);
  const Built b = build(c);
  ASSERT_EQ(b.state.bonds.size(), 2u);
  EXPECT_EQ(b.state.bonds[BondId{0}].i.value, 2u);
  EXPECT_EQ(b.state.bonds[BondId{0}].j.value, 3u);
}

TEST(LammpsSpecimen, BeginsWithTheVelocitiesOfItsFileUnlessTheCaseSaysNo) {
  const TemporaryFile file("moving.data",
                           std::string(chain) + "\nVelocities\n\n20 1 2 3\n3 4 5 6\n7 8 9 1\n");
  Case c = lammps_case(file.path(), "bond");
  VelocitySpec more;
  more.velocity = {0, 0, 10};
  c.velocities = {more};
  const Built b = build(c);
  ASSERT_EQ(b.model.particles(), 3u);
  EXPECT_EQ(b.state.v.values(), (std::vector<Vec3d>{{4, 5, 16}, {8, 9, 11}, {1, 2, 13}}));
  c.velocities.clear();
  std::get<LammpsSpecimen>(c.specimens[0].shape).velocities = false;
  const Built at_rest = build(c);
  for (const Vec3d& v : at_rest.state.v) EXPECT_EQ(v, (Vec3d{0, 0, 0}));
  ASSERT_FALSE(at_rest.notes.empty());
  EXPECT_TRUE(
      contains(at_rest.notes[0], "section Velocities is passed over: the case says velocities = false"));
}

TEST(LammpsSpecimen, RefusesVelocitiesThatFitNoAtom) {
  const auto error = [](const std::string& lines) {
    const TemporaryFile file("moving.data", std::string(chain) + "\nVelocities\n\n" + lines);
    return text_of_error(lammps_case(file.path(), "bond"));
  };
  EXPECT_TRUE(contains(error("20 1 2 3\n3 4 5 6\n"), "velocities of 2 of 3 atoms"));
  EXPECT_TRUE(
      contains(error("20 1 2 3\n3 4 5 6\n3 8 9 1\n"), "moving.data:32:1: a second velocity of atom 3"));
  EXPECT_TRUE(contains(error("20 1 2 3\n3 4 5 6\n8 8 9 1\n"), "moving.data:32:1: a velocity of atom 8"));
  EXPECT_TRUE(contains(error("20 1 2 3 4 5 6\n"), "expected: atom vx vy vz"));
}

TEST(LammpsSpecimen, RefusesNumbersThatCannotBeComputedWith) {
  const std::string masses = "title\n\n1 atoms\n\nMasses\n\n1 ", atoms = "\n\nAtoms\n\n1 1 1 ",
                    velocities = "\n\nVelocities\n\n1 0 ";
  const auto error = [&](const std::string& mass, const std::string& x, const std::string& v) {
    const TemporaryFile file("wide.data", masses + mass + atoms + x + " 0 0" + velocities + v + " 0\n");
    Case c = lammps_case(file.path(), "bond");
    c.bonds.clear();
    return text_of_error(c);
  };
  EXPECT_EQ(error("1", "1e60", "-1e60"), "");
  for (const char* wrong : {"nan", "inf", "1e61", "-1e151", "1e400"}) {
    EXPECT_TRUE(contains(error(wrong, "0", "0"), "wide.data:7:1: the line is not understood")) << wrong;
    EXPECT_TRUE(contains(error("1", wrong, "0"), "wide.data:11:1: the line is not understood")) << wrong;
    const std::string of_velocity = error("1", "0", wrong);
    EXPECT_TRUE(contains(of_velocity,
                         "wide.data:15:1: the line is not understood\n  expected: atom vx vy vz; numbers are "
                         "finite and at most 1e60 in size"))
        << of_velocity;
  }
}

// lammps_molecular.data and lammps_sphere.data were written by LAMMPS (29 Sep 2021, write_data, the first
// with `pair ij`). Of the molecule the atoms 2 to 4 are one period of 4 farther along x than they stand in
// the file.
TEST(LammpsSpecimen, ReadsAMoleculeThatLammpsWrote) {
  const Case c =
      parse_case("[[specimen]]\nkind = \"lammps\"\natom_style = \"molecular\"\nfile = \"" VBOND_TEST_DATA
                 "/lammps_molecular.data\"\nradius = 0.3\n[groups]\nheavy = { type = 2 }\n"
                 "light = { difference = { of = \"all\", without = [\"heavy\"] } }\n"
                 "[[bonds]]\nfrom_specimen = true\nbond_type = 1\n"
                 "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }\n"
                 "[[stage]]\nduration = 1\n",
                 "case.toml");
  const Built b = build(c);
  EXPECT_EQ(b.model.r_0.values(),
            (std::vector<Vec3d>{{3.5, 1, 0}, {4.5, 1, 0}, {5.5, 1, 0}, {6.5, 1.25, 0.5}}));
  EXPECT_EQ(b.model.mass.values(), (std::vector<double>{2.5, 5, 5, 2.5}));
  EXPECT_EQ(b.state.v.values(),
            (std::vector<Vec3d>{{1.125, -1, 0.5}, {0.375, -1, 0.5}, {0.625, -1, 0.5}, {0.875, -1, 0.5}}));
  EXPECT_EQ(numbers(b.model, "heavy"), (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(numbers(b.model, "light"), numbers(b.model, "type-1"));
  ASSERT_EQ(b.state.bonds.size(), 2u);
  EXPECT_EQ(b.state.bonds[BondId{1}].i.value, 2u);
  std::string notes;
  for (const std::string& note : b.notes) notes += note + "\n";
  for (const char* part :
       {"molecular.data:19: section PairIJ Coeffs is passed over", "Bond Coeffs is passed over",
        "Angle Coeffs is passed over", "Angles is passed over",
        "molecular.data:41: section Velocities is where the run begins"})
    EXPECT_TRUE(contains(notes, part)) << part << "\nnot in\n" << notes;
}

TEST(LammpsSpecimen, ReadsSpheresThatLammpsWrote) {
  Case c = lammps_case(VBOND_TEST_DATA "/lammps_sphere.data", "sphere");
  c.bonds.clear();
  c.specimens[0].radius = 0.0;
  const Built b = build(c);
  EXPECT_EQ(b.state.v.values(), (std::vector<Vec3d>{{1, 2, 3}, {1, 2, 3}}));
  EXPECT_EQ(b.state.omega.values(), (std::vector<Vec3d>{{0, 0, 0}, {0, 0, 6}}));
  EXPECT_EQ(b.model.radius.values(), (std::vector<double>{0.25, 0.25}));
}

// As the command write_data of LAMMPS leaves it: coefficients unless it is told not to, and angles for most
// molecules.
const char* const written = R"(LAMMPS data file via write_data, version 2 Aug 2023, timestep = 0

4 atoms
2 atom types
3 bonds
2 bond types
2 angles
1 angle types

-1 9 xlo xhi
-1 1 ylo yhi
-1 1 zlo zhi

Masses

1 2.5
2 5

Pair Coeffs # lj/cut

1 1 1
2 1 1

Bond Coeffs # harmonic

1 80 1.2
2 40 1.2

Angle Coeffs # harmonic

1 10 180

PairIJ Coeffs # lj/cut

1 2 1 1

Atoms # bond

1 1 1 0 0 0 0 0 0
2 1 2 1 0 0 0 0 0
3 1 2 2 0 0 0 0 0
4 1 1 3 0 0 0 0 0

Velocities

1 0 0 0
2 0 0 0
3 0 0 0
4 0 0 0

Bonds

1 1 1 2
2 2 2 3
3 1 3 4

Angles

1 1 1 2 3
2 1 2 3 4
)";

TEST(LammpsSpecimen, PassesOverWhatWriteDataWritesWithAWord) {
  const TemporaryFile file("written.data", written);
  const Built b = build(lammps_case(file.path(), "bond"));
  EXPECT_EQ(b.model.particles(), 4u);
  EXPECT_EQ(b.state.bonds.size(), 3u);
  std::string notes;
  for (const std::string& note : b.notes) notes += note + "\n";
  for (const char* part :
       {"written.data:19: section Pair Coeffs is passed over: the case gives",
        "section Bond Coeffs is passed over", "section Angle Coeffs is", "section PairIJ Coeffs is",
        "section Velocities is where the run begins",
        "section Angles is passed over: bonds join two particles",
        "bonds \"bonds\": the bond types 1, 2 of the file are made alike; bond_type takes one of them"})
    EXPECT_TRUE(contains(notes, part)) << part << "\nnot in\n" << notes;
}

TEST(LammpsSpecimen, PassesOverMassesOfSpheresWhichHaveDensities) {
  const TemporaryFile file("masses.data", "title\n\n1 atoms\n\nMasses\n\n1 7\n\nAtoms\n\n1 1 2 3 0 0 0\n");
  Case c = lammps_case(file.path(), "sphere");
  c.bonds.clear();
  c.specimens[0].radius = 0.0;
  const Built b = build(c);
  EXPECT_DOUBLE_EQ(b.model.mass[ParticleId{0}], 4.0 * std::numbers::pi);
  ASSERT_EQ(b.notes.size(), 1u);
  EXPECT_TRUE(contains(b.notes[0], "masses.data:5: section Masses is passed over: diameters and densities"))
      << b.notes[0];
}

TEST(LammpsSpecimen, PassesOverNoSectionOfAStrangeName) {
  const TemporaryFile file("strange.data", std::string(chain) + "\nB\x1b[2J Coeffs\n\n1 1\n");
  EXPECT_TRUE(contains(text_of_error(lammps_case(file.path(), "bond")), "is not supported"));
}

TEST(LammpsSpecimen, MakesGroupsOfAtomTypes) {
  const TemporaryFile file("written.data", written);
  const Built b = build(lammps_case(file.path(), "bond"));
  EXPECT_EQ(numbers(b.model, "type-1"), (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(numbers(b.model, "body.type-2"), (std::vector<std::size_t>{1, 2}));
}

TEST(LammpsSpecimen, BondsOfOneTypeMayBeChosen) {
  const TemporaryFile file("written.data", written);
  Case c = lammps_case(file.path(), "bond");
  c.bonds[0].select.value = SpecimenPairs{1};
  BondSpec others = c.bonds[0];
  others.name = "others";
  others.select.value = SpecimenPairs{2};
  c.bonds.push_back(others);
  const Built b = build(c);
  ASSERT_EQ(b.state.bonds.size(), 3u);
  EXPECT_EQ(b.state.bonds[BondId{0}].j.value, 1u);
  EXPECT_EQ(b.state.bonds[BondId{1}].i.value, 2u);
  EXPECT_EQ(b.state.bonds[BondId{2}].i.value, 1u);
  EXPECT_EQ(b.state.bonds[BondId{2}].set, 1u);
  for (const std::string& note : b.notes) EXPECT_FALSE(contains(note, "made alike"));

  c.bonds[1].select.value = SpecimenPairs{3};
  const std::string error = text_of_error(c);
  EXPECT_TRUE(contains(
      error, "no bond of type 3\n  between these groups the files have none; they have the bond types 1, 2"))
      << error;
}

TEST(LammpsSpecimen, RefusesWhatItDoesNotSupportWithLineNumbers) {
  const TemporaryFile file("bad.data",
                           "title\n\n2 atoms\n1 bonds\n3 ellipsoids\n1 elephants\n\nAtoms # bond\n\n"
                           "1 1 1 0 0 0\n2 1 1 1 0\n\nEllipsoids\n\n1 1 1 1\n\nBonds\n\n1 1 1\n");
  const std::string error = text_of_error(lammps_case(file.path(), "bond"));
  for (const char* part : {"bad.data:5:1: \"3 ellipsoids\" is not understood",
                           "bad.data:6:1: \"1 elephants\"", "bad.data:11:1: the line is not",
                           "bad.data:13:1: section \"Ellipsoids\"", "bad.data:19:1: the line is not"})
    EXPECT_TRUE(contains(error, part)) << part << "\nnot in\n" << error;
}

TEST(LammpsSpecimen, RefusesAnAtomWithAFieldThatIsNoNumber) {
  const std::string good[] = {"1", "7", "1", "0.8", "3.0", "0.5", "1.5", "2.5", "0", "0", "0"};
  for (std::size_t bad = 0; bad < std::size(good); ++bad) {
    if (bad == 1) continue;  // the molecule is passed over
    std::string text = "title\n\n1 atoms\n\nAtoms\n\n";
    for (std::size_t k = 0; k < std::size(good); ++k) text += (k == bad ? "1e" : good[k]) + " ";
    const TemporaryFile file("bad.data", text + "\n");
    Case c = lammps_case(file.path(), "bpm/sphere");
    c.bonds.clear();
    c.specimens[0].radius = 0.0;
    EXPECT_TRUE(contains(text_of_error(c), "bad.data:7:1: the line is not understood")) << text;
  }
}

TEST(LammpsSpecimen, RefusesBondsToMissingAtomsAndDoubleNumbers) {
  const TemporaryFile file("bad.data", "title\n\nAtoms\n\n1 1 1 0 0 0\n1 1 1 1 0 0\n\nBonds\n\n1 1 1 9\n");
  const std::string error = text_of_error(lammps_case(file.path(), "bond"));
  EXPECT_TRUE(contains(error, "bad.data:6:1: a second atom of number 1")) << error;
  EXPECT_TRUE(contains(error, "bad.data:10:1: a bond to atom 9")) << error;
}

TEST(LammpsSpecimen, RefusesAWrongCount) {
  const TemporaryFile file("bad.data", "title\n\n3 atoms\n\nAtoms\n\n1 1 1 0 0 0\n");
  EXPECT_TRUE(contains(text_of_error(lammps_case(file.path(), "bond")), "3 atoms are declared, 1 found"));
}

TEST(LammpsSpecimen, RefusesAMassGivenInCaseAndFile) {
  const TemporaryFile file("chain.data", chain);
  Case c = lammps_case(file.path(), "bond");
  c.specimens[0].mass = 1.0;
  EXPECT_TRUE(contains(text_of_error(c), "mass is given more than once"));
}

}  // namespace
}  // namespace vbond::test
