// Periodic boxes of LAMMPS data files: image flags, and bonds through the boundary.
#include <fmt/format.h>

#include "lammps_files.hpp"

namespace vbond::test {
namespace {

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
  EXPECT_TRUE(contains(error("4 0 0 avec\n0 4 0 bvec\n0 0 0 abc origin\n", "0 0 1"), "the box has no cvec"));
  EXPECT_TRUE(contains(error("-1 7 xlo xhi\n", "0 1 0"), "an image flag along y, and no box"));
  EXPECT_TRUE(contains(error(box, "0 0.5 0"), "boxed.data:14:1: the line is not understood"));
  EXPECT_TRUE(contains(error("7 -1 xlo xhi\n", "0 0 0"), "boxed.data:4:1: the line is not understood"));
}

TEST(LammpsSpecimen, RefusesBoxesThatAreNone) {
  const auto error = [](const std::string& box) {
    const TemporaryFile file("boxed.data", boxed_atom(box, "0 0 0"));
    Case c = lammps_case(file.path(), "atomic");
    c.bonds.clear();
    return text_of_error(c);
  };
  const auto refuses = [&](const std::string& box, const char* what) {
    EXPECT_TRUE(contains(error(box), what)) << box << error(box);
  };
  const std::string general = "4 0 0 avec\n1 4 0 bvec\n0 1 4 cvec\n";
  EXPECT_EQ(error(general + "0 0 0 abc origin\n"), "");
  refuses(general, "boxed.data:6:1: the box has no abc origin");
  refuses("4 0 0 avec\n0 0 4 cvec\n0 0 0 abc origin\n", "boxed.data:6:1: the box has no bvec");
  refuses(general + "0 0 0 abc origin\n0 4 xlo xhi\n",
          "boxed.data:8:1: the box is given by its ends and by vectors");
  refuses("4 0 0 avec\n0 0 4 bvec\n0 4 0 cvec\n0 0 0 abc origin\n",
          "boxed.data:7:1: the vectors of the box span the volume -64");
  refuses("4 0 avec\n", "boxed.data:4:1: the line is not understood\n  expected: ax ay az avec");
  refuses("0 0 0 origin\n", "expected: x y z abc origin");
  refuses("0 4 xlo xlo\n", "boxed.data:4:1");
  refuses("0.5 0 nan xy xz yz\n", "expected: three numbers, then xy xz yz");
}

// Box, atoms 1, 9 and 11, and where LAMMPS (29 Sep 2021) says that they are (xu, yu, zu of a dump): of a
// lattice in a prism, after 300 steps at temperature 5.
TEST(LammpsSpecimen, IsUnwrappedInATiltedBoxAsByLammps) {
  const TemporaryFile file(
      "tilted.data",
      "title\n\n3 atoms\n0 4 xlo xhi\n0 3 ylo yhi\n0 5 zlo zhi\n1.2 -0.7 0.9 xy xz yz\n\n"
      "Masses\n\n1 1\n\nAtoms # bond\n\n"
      "1 0 1 1.2759648277546947 0.34448498481629464 1.212627240178214 -2 -3 2\n"
      "9 0 1 2.786554540533797 1.8226834034223203 1.5585811970250953 -4 3 -1\n"
      "11 0 1 1.5835552388646685 0.37820675995804665 0.8591497884095946 2 3 -1\n");
  Case c = lammps_case(file.path(), "");
  c.bonds.clear();
  const Built b = build(c);
  const Vec3d expected[] = {{-11.7240351722453, -6.85551501518371, 11.2126272401782},
                            {-8.9134454594662, 9.92268340342232, -3.4414188029749},
                            {13.8835552388647, 8.47820675995805, -4.14085021159041}};
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_LT(norm(b.model.r_0[ParticleId{k}] - expected[k]), 1e-13)
        << k;  // its 15 digits, of numbers above 10
}

TEST(LammpsSpecimen, IsUnwrappedAlongTheVectorsOfAGeneralBox) {
  const TemporaryFile file(
      "boxed.data", boxed_atom("4 1 0 avec\n-1 8 0.5 bvec\n0 2 16 cvec\n1 2 3 abc origin\n", "1 -2 3"));
  Case c = lammps_case(file.path(), "atomic");
  c.bonds.clear();
  // small whole and half numbers: exact
  EXPECT_EQ(build(c).model.r_0[ParticleId{0}], (Vec3d{0.5 + 4 + 2 + 0, 1.5 + 1 - 16 + 6, 2.5 + 0 - 1 + 48}));
}

TEST(LammpsSpecimen, TakesATiltedBoxWithoutImageFlags) {
  const TemporaryFile file("boxed.data", boxed_atom("0 4 xlo xhi\n0.5 0 0 xy xz yz\n", "0 0 0"));
  Case c = lammps_case(file.path(), "atomic");
  c.bonds.clear();
  EXPECT_EQ(build(c).model.r_0[ParticleId{0}], (Vec3d{0.5, 1.5, 2.5}));
}

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

}  // namespace
}  // namespace vbond::test
