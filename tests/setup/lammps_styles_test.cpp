// Atom styles and types of LAMMPS data files.
#include <fmt/format.h>

#include "lammps_files.hpp"

namespace vbond::test {
namespace {

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
  const TemporaryFile masses("masses.data",
                             "title\n\n1 atoms\n1 atom types\n\nMasses\n\n1 1\n2 1\n\n"
                             "Atoms # atomic\n\n1 1 0 0 0\n");
  EXPECT_TRUE(contains(text_of_error(lammps_case(masses.path(), "atomic")),
                       "masses.data:9:1: atom type 2\n  the header declares 1 atom types"));
  const TemporaryFile bonds("bonds.data",
                            "title\n\nMasses\n\n1 1\n\nAtoms # atomic\n\n1 1 0 0 0\n2 1 1 0 0\n\n"
                            "Bonds\n\n1 0 1 2\n");
  EXPECT_TRUE(contains(text_of_error(lammps_case(bonds.path(), "atomic")),
                       "bonds.data:14:1: bond type 0\n  bond types are counted from 1"));
}

TEST(LammpsSpecimen, SuggestsTheAtomStyleThatWasMeant) {
  const std::string error = text_of_error(lammps_case("any.data", "molecule"));
  EXPECT_TRUE(contains(error, "atom_style = \"molecule\" is not supported")) << error;
  EXPECT_TRUE(contains(error, "did you mean \"molecular\"?")) << error;
}

}  // namespace
}  // namespace vbond::test
