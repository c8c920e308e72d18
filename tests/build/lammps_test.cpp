#include <fmt/format.h>

#include "cases.hpp"
#include "vbond/case/read.hpp"

namespace vbond::test {
namespace {

Case lammps_case(const std::filesystem::path& file, const std::string& style) {
  Case c = case_of(LammpsSpecimen{{file, {"case.toml", 4, 1}}, style});
  c.specimens[0].mass.reset();
  BondSpec bonds = bonds_within(1.0);
  bonds.select.value = SpecimenPairs{};
  c.bonds.push_back(bonds);
  return c;
}

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

TEST(LammpsSpecimen, ReadsEveryAtomStyleItNames) {
  const std::pair<const char*, const char*> lines[] = {
      {"atomic", "1 1 0.5 1.5 2.5"},         {"charge", "1 1 9.9 0.5 1.5 2.5"},
      {"bond", "1 7 1 0.5 1.5 2.5"},         {"angle", "1 7 1 0.5 1.5 2.5"},
      {"molecular", "1 7 1 0.5 1.5 2.5"},    {"full", "1 7 1 9.9 0.5 1.5 2.5"},
      {"sphere", "1 1 0.8 3.0 0.5 1.5 2.5"}, {"bpm/sphere", "1 7 1 0.8 3.0 0.5 1.5 2.5 0 0 0"}};
  for (const auto& [style, line] : lines) {
    const bool sphere = contains(style, "sphere");
    std::string text = "title\n\n1 atoms\n\n";
    if (!sphere) text += "Masses\n\n1 3\n\n";
    text += std::string("Atoms\n\n") + line + "\n";
    const TemporaryFile file("one.data", text);
    Case c = lammps_case(file.path(), style);
    c.bonds.clear();
    if (sphere) c.specimens[0].radius = 0.0;
    const Built b = build(c);
    EXPECT_EQ(b.model.r_0[ParticleId{0}], (Vec3d{0.5, 1.5, 2.5})) << style;
    EXPECT_DOUBLE_EQ(b.model.radius[ParticleId{0}], 0.4) << style;
    // a sphere of diameter 0.8 and density 3 has the mass 4 pi 0.4^3
    EXPECT_DOUBLE_EQ(b.model.mass[ParticleId{0}], sphere ? 4.0 * std::numbers::pi * 0.064 : 3.0) << style;
  }
}

/// One atom of style atomic with these lines of the box and these image flags.
std::string boxed_atom(const std::string& box, const std::string& flags) {
  return "title\n\n1 atoms\n" + box + "\nMasses\n\n1 3\n\nAtoms\n\n1 1 0.5 1.5 2.5 " + flags + "\n";
}

TEST(LammpsSpecimen, IsUnwrappedAlongEveryAxisByTheEdgesOfTheBox) {
  const TemporaryFile file("boxed.data",
                           boxed_atom("-1 7 xlo xhi\n0 16 ylo yhi\n2 6 zlo zhi\n0 0 0 xy xz yz\n", "1 -2 3"));
  Case c = lammps_case(file.path(), "atomic");
  c.bonds.clear();
  // small whole and half numbers: exact
  EXPECT_EQ(build(c).model.r_0[ParticleId{0}], (Vec3d{0.5 + 8, 1.5 - 32, 2.5 + 12}));
}

TEST(LammpsSpecimen, RefusesImageFlagsItCannotUnwrap) {
  const auto error = [](const std::string& box, const std::string& flags) {
    const TemporaryFile file("boxed.data", boxed_atom(box, flags));
    Case c = lammps_case(file.path(), "atomic");
    c.bonds.clear();
    return text_of_error(c);
  };
  const std::string box = "-1 7 xlo xhi\n0 16 ylo yhi\n2 6 zlo zhi\n";
  EXPECT_TRUE(contains(error(box + "0 0.5 0 xy xz yz\n", "1 0 0"), "an image flag in a tilted box"));
  EXPECT_TRUE(contains(error("-1 7 xlo xhi\n", "0 1 0"), "an image flag along y, and no box"));
  EXPECT_TRUE(contains(error(box, "0 0.5 0"), "boxed.data:14:1: the line is not understood"));
  EXPECT_TRUE(contains(error("7 -1 xlo xhi\n", "0 0 0"), "boxed.data:4:1: the line is not understood"));
}

TEST(LammpsSpecimen, TakesATiltedBoxWithoutImageFlags) {
  const TemporaryFile file("boxed.data", boxed_atom("0 4 xlo xhi\n0.5 0 0 xy xz yz\n", "0 0 0"));
  Case c = lammps_case(file.path(), "atomic");
  c.bonds.clear();
  EXPECT_EQ(build(c).model.r_0[ParticleId{0}], (Vec3d{0.5, 1.5, 2.5}));
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

// ---- styles -----------------------------------------------------------------------------------------------

std::string styled(const std::string& heading, const std::string& atoms) {
  return "title\n\n2 atoms\n1 atom types\n\nMasses\n\n1 2.5\n\nAtoms " + heading + "\n\n" + atoms + "\n";
}

/// The places of its two atoms, or what is wrong; without a style in the case if it is empty.
std::string places_of(const std::string& text, const std::string& style) {
  const TemporaryFile file("styled.data", text);
  Case c = lammps_case(file.path(), style);
  if (style.empty()) std::get<LammpsSpecimen>(c.specimens[0].shape).atom_style.reset();
  c.bonds.clear();
  try {
    std::string places;
    for (const Vec3d& r : build(c).model.r_0) places += fmt::format("{} {} {};", r.x, r.y, r.z);
    return places;
  } catch (const CaseError& e) {
    return e.what();
  }
}

TEST(LammpsSpecimen, TakesTheStyleThatItsFileNamesIfTheCaseNamesNone) {
  const char* const two = "0 1 2;3 4 5;";
  EXPECT_EQ(places_of(styled(" #  full", "1 1 1 0.5 0 1 2\n2 1 1 0.5 3 4 5"), ""), two);
  EXPECT_EQ(places_of(styled("# charge", "1 1 1 0 1 2\n2 1 1 3 4 5"), ""), two);
  EXPECT_EQ(places_of(styled("# molecular", "1 1 1 0 1 2\n2 1 1 3 4 5"), "bond"), two)
      << "they have the same columns";
  EXPECT_EQ(places_of(styled("# I like comments", "1 1 1 0 1 2\n2 1 1 3 4 5"), "bond"), two);
  const std::string error = places_of(styled("# full", "1 1 1 0 1 2\n2 1 1 3 4 5"), "bond");
  EXPECT_EQ(error.find(
                "styled.data:10:1: the file says atom style \"full\"\n  the case says atom_style = \"bond\""),
            error.find("styled.data"))
      << error;
  EXPECT_FALSE(contains(error, "is not understood")) << error;
}

TEST(LammpsSpecimen, NamesTheStylesThatFitWhereNoneIsNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"1 1 1 0 1 2\n2 1 1 3 4 5", "atoms of 6 fields may have the style charge, bond, angle, molecular"},
      {"1 1 0 1 2\n2 1 3 4 5", "atoms of 5 fields may have the style atomic"},
      {"1 1 1 0.5 0 1 2\n2 1 1 0.5 3 4 5", "atoms of 7 fields may have the style full, sphere"},
      {"1 1 1\n2 1 1", "no style fits their 3 fields"}};
  for (const auto& [atoms, part] : cases)
    for (const char* heading : {"", "# I like comments"}) {
      const std::string error = places_of(styled(heading, atoms), "");
      EXPECT_TRUE(contains(error, part)) << part << "\nnot in\n" << error;
      EXPECT_FALSE(contains(error, "is not understood")) << error;
    }
}

TEST(LammpsSpecimen, RefusesStylesOfLammpsThatItDoesNotKnowOnce) {
  for (const char* style : {"", "bpm/sphere"}) {
    const std::string error =
        places_of(styled("# hybrid", "1 1 0 1 2 1 0.1 1.0\n2 1 3 4 5 1 0.1 1.0"), style);
    EXPECT_TRUE(contains(error, "the file says atom style \"hybrid\", which is not supported")) << error;
    EXPECT_FALSE(contains(error, "is not understood")) << error;
    EXPECT_FALSE(contains(error, "no Atoms section")) << error;
  }
}

TEST(LammpsSpecimen, TellsTheFirstOfManyWrongAtomsAndTheirNumber) {
  std::string atoms;
  for (int k = 1; k <= 1000; ++k) atoms += std::to_string(k) + " 1 1 0 0\n";
  const std::string error = places_of(styled("# bond", atoms), "");
  EXPECT_TRUE(contains(
      error, "styled.data:12:1: the line is not understood\n  expected: 6 fields of atom style bond"))
      << error;
  EXPECT_TRUE(contains(error, "and 999 more of this kind")) << error;
  EXPECT_LT(error.size(), 1000U);
}

TEST(LammpsSpecimen, KnowsTypesByTheirLabels) {
  const TemporaryFile file(
      "labels.data",
      "title\n\n3 atoms\n2 bonds\n2 atom types\n2 bond types\n\nAtom Type Labels\n\n1 sand\n2 "
      "Bonds\n\nBond Type Labels\n\n1 glue\n2 lime\n\nMasses\n\nsand 1.5\n2 3\n\nAtoms # "
      "bond\n\n1 1 sand 0 0 0\n2 1 Bonds 1 0 0\n3 1 1 2 0 0\n\nBonds\n\n1 lime 1 2\n2 1 2 3\n");
  Case c = lammps_case(file.path(), "bond");
  const Built b = build(c);
  EXPECT_EQ(b.model.mass.values(), (std::vector<double>{1.5, 3, 1.5}));
  EXPECT_EQ(numbers(b.model, "type-1"), (std::vector<std::size_t>{0, 2}));
  c.bonds[0].select.value = SpecimenPairs{2};
  EXPECT_EQ(build(c).state.bonds.size(), 1U);
  EXPECT_TRUE(contains(b.notes[0], "labels of atom types stand for their numbers: Bonds is 2, sand is 1"))
      << b.notes[0];
}

TEST(LammpsSpecimen, RefusesTypesThatItsHeaderDoesNotCount) {
  EXPECT_TRUE(contains(places_of(styled("# bond", "1 1 1 0 1 2\n2 1 9 3 4 5"), ""),
                       "styled.data:13:1: atom type 9\n  the header declares 1 atom types"));
}

// ---- periodic boxes ---------------------------------------------------------------------------------------

/// A chain of n atoms along x at distance 1 in a box of `box` with these bonds.
std::string chain_in_box(int n, double box, const std::string& bonds, const std::string& tilt = "") {
  std::string text = fmt::format(
      "title\n\n{} atoms\n\n0 {} xlo xhi\n-5 5 ylo yhi\n-5 5 zlo zhi\n{}\nMasses\n\n1 "
      "1\n\nAtoms # bond\n\n",
      n, box, tilt);
  for (int k = 1; k <= n; ++k) text += fmt::format("{} 1 1 {} 0 0\n", k, k - 0.5);
  text += "\nBonds\n\n";
  for (int k = 1; k < n; ++k) text += fmt::format("{} 1 {} {}\n", k, k, k + 1);
  return text + bonds;
}

TEST(LammpsSpecimen, RefusesBondsThroughAPeriodicBoundaryWhereTheyAreWanted) {
  const TemporaryFile file("ring.data", chain_in_box(10, 10, "10 2 10 1\n"));
  Case c = lammps_case(file.path(), "bond");
  const std::string error = text_of_error(c);
  EXPECT_TRUE(
      contains(error,
               "1 bonds of the file go through a boundary of its periodic box; the first, of particles 9 "
               "and 0, would be 9 long and is 1 through the boundary"))
      << error;
  EXPECT_TRUE(contains(error, "nothing is periodic here")) << error;
  c.bonds[0].select.value = SpecimenPairs{1};
  EXPECT_EQ(build(c).state.bonds.size(), 9U);
  c.bonds = {bonds_within(1.1)};
  EXPECT_EQ(build(c).state.bonds.size(), 9U);
}

// The boundary of a tilted box is passed along its edge (2, 6, 0): from (0.5, 0, 0) to (2.5, 5, 0) and on
// by 1.
TEST(LammpsSpecimen, KnowsBondsThroughTheBoundaryOfATiltedBox) {
  std::string text =
      "title\n\n6 atoms\n\n0 10 xlo xhi\n0 6 ylo yhi\n0 6 zlo zhi\n2 0 0 xy xz yz\n\nMasses\n\n1 "
      "1\n\nAtoms # bond\n\n";
  for (int k = 0; k < 6; ++k) text += fmt::format("{} 1 1 {} {} 0\n", k + 1, 0.5 + k / 3.0, k);
  const TemporaryFile file("tilted.data",
                           text + "\nBonds\n\n1 1 1 2\n2 1 2 3\n3 1 3 4\n4 1 4 5\n5 1 5 6\n6 1 6 1\n");
  EXPECT_TRUE(
      contains(text_of_error(lammps_case(file.path(), "bond")), "1 bonds of the file go through a boundary"));
}

TEST(LammpsSpecimen, NotesBondsThatMayBeMeantThroughTheBoundaryOfASmallBox) {
  const TemporaryFile file("small.data", chain_in_box(3, 2.6, "3 1 1 3\n"));
  const Built b = build(lammps_case(file.path(), "bond"));
  ASSERT_EQ(b.notes.size(), 1U);
  EXPECT_TRUE(contains(b.notes[0], "1 bonds are longer than half of the box")) << b.notes[0];
}

// None of these bonds means the boundary: a body as large as its box, second neighbours of a short chain, a
// string from end to end whose ends are one place by the box.
TEST(LammpsSpecimen, TakesLongBondsOfBodiesThatFillTheirBox) {
  const std::pair<std::pair<int, double>, const char*> cases[] = {{{2, 1.0}, ""},
                                                                  {{2, 1.5}, ""},
                                                                  {{3, 2.0}, "3 1 1 3\n"},
                                                                  {{3, 2.2}, "3 1 1 3\n"},
                                                                  {{3, 2.6}, "3 1 1 3\n"},
                                                                  {{10, 9.0}, "10 1 1 10\n"},
                                                                  {{10, 40.0}, "10 1 1 10\n"}};
  for (const auto& [chain, more] : cases) {
    const TemporaryFile file("small.data", chain_in_box(chain.first, chain.second, more));
    EXPECT_EQ(text_of_error(lammps_case(file.path(), "bond")), "") << chain.first << " in " << chain.second;
  }
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

TEST(LammpsSpecimen, SuggestsTheAtomStyleThatWasMeant) {
  const std::string error = text_of_error(lammps_case("any.data", "molecule"));
  EXPECT_TRUE(contains(error, "atom_style = \"molecule\" is not supported")) << error;
  EXPECT_TRUE(contains(error, "did you mean \"molecular\"?")) << error;
}

TEST(LammpsSpecimen, RefusesAMassGivenInCaseAndFile) {
  const TemporaryFile file("chain.data", chain);
  Case c = lammps_case(file.path(), "bond");
  c.specimens[0].mass = 1.0;
  EXPECT_TRUE(contains(text_of_error(c), "mass is given more than once"));
}

}  // namespace
}  // namespace vbond::test
