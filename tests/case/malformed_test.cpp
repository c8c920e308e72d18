#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "vbond/case/read.hpp"

// Each file in tests/data/malformed has one mistake; its first line says where the first report must point
// and what the way out must contain:  # expect: LINE:COLUMN substring
namespace vbond {
namespace {

const std::filesystem::path folder = std::filesystem::path(VBOND_TEST_DATA) / "malformed";

std::vector<std::string> malformed_files() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class Malformed : public ::testing::TestWithParam<std::string> {};

TEST_P(Malformed, FileIsRefusedAtTheRightPlaceWithAWayOut) {
  const std::filesystem::path file = folder / (GetParam() + ".toml");
  std::ifstream stream(file);
  std::string first_line;
  std::getline(stream, first_line);
  std::istringstream expectation(first_line);
  std::string hash, expect, place, way_out;
  expectation >> hash >> expect >> place;
  std::getline(expectation >> std::ws, way_out);
  ASSERT_EQ(expect, "expect:") << "the first line must be `# expect: LINE:COLUMN substring`";
  ASSERT_FALSE(way_out.empty());

  try {
    read_case(file);
    FAIL() << "was accepted";
  } catch (const CaseError& e) {
    ASSERT_EQ(e.problems().size(), 1U) << e.what();  // one mistake makes one report, not a cascade
    const Problem& p = e.problems().front();
    EXPECT_EQ(p.place.file, file.string());
    EXPECT_EQ(std::to_string(p.place.line) + ":" + std::to_string(p.place.column), place) << e.what();
    EXPECT_NE(p.way_out.find(way_out), std::string::npos) << e.what();
    EXPECT_FALSE(p.what.empty());
    EXPECT_FALSE(p.rule.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Case, Malformed, ::testing::ValuesIn(malformed_files()),
                         [](const auto& parameter) { return parameter.param; });

TEST(MalformedFiles, AreAtLeastTwenty) {
  EXPECT_GE(malformed_files().size(), 20U);
}

}  // namespace
}  // namespace vbond
