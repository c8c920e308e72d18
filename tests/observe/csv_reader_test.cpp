#include <gtest/gtest.h>

#include <filesystem>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/csv.hpp"

namespace vbond::csv_reader_test {
namespace {

using test::Folder;
using test::put_content;

template <class F>
std::string error_of(F&& f) {
  try {
    f();
  } catch (const IoError& e) {
    return e.what();
  }
  return "none";
}

TEST(CsvReader, GivesRowsAsTheyStandInTheFileAndLeavesOutOneThatIsUnderWay) {
  const Folder folder;
  put_content(folder / "t.csv", "step,\"a,\"\"b\",c\n1,\"x,y\",\n12345678901234567890,2,3\n7,8,9");
  CsvReader in(folder / "t.csv");
  EXPECT_EQ(in.header(), (std::vector<std::string>{"step", "\"a,\"\"b\"", "c"}));
  EXPECT_EQ(in.line(), "step,\"a,\"\"b\",c");
  EXPECT_EQ(in.place("c"), 2U);
  ASSERT_TRUE(in.next());
  EXPECT_EQ(in.cells(), (std::vector<std::string>{"1", "\"x,y\"", ""}));
  ASSERT_TRUE(in.next());
  EXPECT_EQ(in.cells(), (std::vector<std::string>{"12345678901234567890", "2", "3"}));
  EXPECT_EQ(in.line(), "12345678901234567890,2,3");
  EXPECT_FALSE(in.next());
  EXPECT_FALSE(in.next());
}

TEST(CsvReader, SaysWhichFileIsDamagedAndWhere) {
  const Folder folder;
  const std::filesystem::path file = folder / "t.csv";
  for (const std::string row : {"1,2", "1,2,3,4", "1,\"2,3,4", ""}) {
    put_content(file, "a,b,c\n1,2,3\n" + row + "\n");
    CsvReader in(file);
    EXPECT_TRUE(in.next());
    EXPECT_EQ(error_of([&] { in.next(); }), file.string() + ": is damaged at \"" + row + '"');
  }
  put_content(file, "a,b\n" + std::string(100, '1') + "\n");
  CsvReader in(file);
  EXPECT_EQ(error_of([&] { in.next(); }), file.string() + ": is damaged at \"" + std::string(60, '1') + '"');
  EXPECT_EQ(error_of([&] { in.place("z"); }), file.string() + ": has no column z");
  EXPECT_NE(error_of([&] { CsvReader(folder / "none.csv"); }).find("none.csv"), std::string::npos);
}

TEST(CsvReader, HasNoColumnsBeforeTheFirstLineIsWhole) {
  const Folder folder;
  for (const char* begun : {"", "step,ti"}) {
    put_content(folder / "t.csv", begun);
    CsvReader in(folder / "t.csv");
    EXPECT_TRUE(in.header().empty()) << begun;
    EXPECT_FALSE(in.next()) << begun;
  }
}

}  // namespace
}  // namespace vbond::csv_reader_test
