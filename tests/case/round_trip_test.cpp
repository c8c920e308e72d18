#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "vbond/case/read.hpp"

namespace vbond {
namespace {

// Every feature of the format stands in one of these files; the fuzzer starts from them too.
const std::filesystem::path corpus = VBOND_CASE_CORPUS;

TEST(ResolvedCase, MeansTheSameWhenReadAgain) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    const Case c = read_case(entry.path());
    const std::string resolved = to_toml(c);
    // from another folder: file names must be absolute by now
    EXPECT_EQ(to_toml(parse_case(resolved, "/elsewhere/resolved.toml")), resolved) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 10);
}

TEST(ResolvedCase, OfEveryExampleMeansTheSame) {
  for (const auto& entry : std::filesystem::directory_iterator(VBOND_EXAMPLES)) {
    if (entry.path().extension() != ".toml") continue;
    const std::string resolved = to_toml(read_case(entry.path()));
    EXPECT_EQ(to_toml(parse_case(resolved, "/elsewhere/resolved.toml")), resolved) << entry.path();
  }
}

// The output folder holds a copy of each.
TEST(FilesOfACase, AreAllValuesOfKeysThatNameAFile) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    Case c = read_case(entry.path());
    const std::string before = to_toml(c);
    std::size_t lines = 0;
    for (std::size_t at = 0; (at = before.find("file = \"", at)) != std::string::npos; ++at) ++lines;
    EXPECT_EQ(files_of(c).size(), lines) << entry.path();
    EXPECT_EQ(to_toml(c), before) << "looking changes nothing: " << entry.path();
    for (std::filesystem::path* file : files_of(c)) *file = "elsewhere/" + std::to_string(files++);
    EXPECT_EQ(to_toml(c) == before, lines == 0) << entry.path();
  }
  EXPECT_GE(files, 3U);  // a CSV file, a LAMMPS file, a file of pairs
}

TEST(ResolvedCase, KeepsEveryBitOfANumber) {
  Case c = read_case(corpus / "rod.toml");
  for (const double x : {1.0 / 3.0, 0.1, 1e-300, 4e59, 3.0, 2.2250738585072014e-308}) {
    std::get<RodSpecimen>(c.specimens.at(0).shape).spacing = x;
    std::get<RodSpecimen>(c.specimens.at(0).shape).origin = {-x, -0.0, x};
    const Case again = parse_case(to_toml(c), "resolved.toml");
    EXPECT_EQ(std::get<RodSpecimen>(again.specimens[0].shape).spacing, x);
    EXPECT_EQ(std::get<RodSpecimen>(again.specimens[0].shape).origin, (Vec3d{-x, -0.0, x}));
    EXPECT_TRUE(std::signbit(std::get<RodSpecimen>(again.specimens[0].shape).origin.y));
  }
}

TEST(ResolvedCase, KeepsTextWithQuotesAndControlCharacters) {
  Case c = read_case(corpus / "rod.toml");
  c.title = "a \"rod\" \\ of\nten\tparticles, \xC2\xB5m \x7f";
  EXPECT_EQ(parse_case(to_toml(c), "resolved.toml").title, c.title);
}

TEST(ResolvedCase, HasDefaultsOfTablesThatAreNotInTheFile) {
  const std::string resolved = to_toml(read_case(corpus / "rod.toml"));
  for (const char* line : {"system = \"reduced\"", "fraction = 0.1", "history = { every = \"10.0 T0\"",
                           "energy_error = 0.05", "spacing = 1.0"})
    EXPECT_NE(resolved.find(line), std::string::npos) << line << " is not in\n" << resolved;
}

TEST(ReadCase, RefusesAFileThatIsNotThere) {
  EXPECT_THROW(read_case(corpus / "no_such_file.toml"), IoError);
  EXPECT_THROW(read_case(corpus), IoError);
}

TEST(ReadCase, NamesTheFileThatHasNothingInIt) {
  const auto file = std::filesystem::path(testing::TempDir()) / "empty.toml";
  std::ofstream{file};
  EXPECT_THROW(read_case(file), CaseError);
}

TEST(ReadCase, ResolvesFileNamesBesideTheCase) {
  const Case c =
      parse_case("[[specimen]]\nkind = \"csv\"\nfile = \"points/../points.csv\"\n[[stage]]\nduration = 1\n",
                 "/data/case.toml");
  EXPECT_EQ(std::get<CsvSpecimen>(c.specimens[0].shape).file.value, "/data/points.csv");
}

TEST(ReadCase, KeepsWhereNamesStandForLaterErrors) {
  const Case c = parse_case(
      "[[specimen]]\nkind = \"rod\"\nparticles = 2\nmass = 1\ninertia = 1\n[[stage]]\nduration = 1\n"
      "supports = [{ fix = [\"x\"], group = \"wall\" }]\n[output]\nhistory = { reactions = [\"all\", "
      "\"wall\"] }\n",
      "case.toml");
  const SourcePlace& group = c.stages[0].supports[0].group.place;
  EXPECT_EQ(group.line, 8U);
  EXPECT_EQ(group.column, 28U);
  EXPECT_EQ(c.output.reactions[1].place.line, 10U);
  EXPECT_EQ(c.output.reactions[1].place.column, 33U);
  EXPECT_EQ(c.specimens[0].place.line, 1U);
}

}  // namespace
}  // namespace vbond
