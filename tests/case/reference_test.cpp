#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "vbond/case/read.hpp"

namespace vbond {
namespace {

// The page of all keys comes from the table that checks them; the message says how to write it anew.
TEST(KeyReference, PageIsTheGeneratedOne) {
  const std::string page = std::string(VBOND_DOCS) + "/case-reference.md";
  if (std::getenv("VBOND_UPDATE_REFERENCE") != nullptr)
    std::ofstream(page, std::ios::binary) << key_reference();
  std::ifstream stream(page, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  EXPECT_TRUE(text.str() == key_reference())
      << page << " is stale; to write it anew:\n"
      << "  VBOND_UPDATE_REFERENCE=1 build/dev/case_test --gtest_filter='KeyReference.*'";
}

TEST(KeyReference, NamesEveryTable) {
  const std::string text = key_reference();
  for (const char* table : {"[units]", "[[specimen]]", "[groups.NAME]", "[[bonds]]", "[contact]",
                            "[[velocities]]", "[time]", "[[stage]]", "[output]", "[watch]"})
    EXPECT_NE(text.find("## `" + std::string(table) + "`"), std::string::npos) << table;
}

}  // namespace
}  // namespace vbond
