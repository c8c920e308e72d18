#include "vbond/core/problems.hpp"

#include <gtest/gtest.h>

#include <string>

namespace vbond {
namespace {

std::string text_of(const Problems& problems) {
  try {
    problems.throw_if_any();
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

TEST(Problems, OfAKindAreShownTwentyTimesAndTheRestCounted) {
  Problems problems;
  for (std::uint32_t line = 1; line <= 1000; ++line)
    problems.add({"a.csv", line, 1}, "field " + std::to_string(line),
                 "row " + std::to_string(line) + " is short", "complete it");
  problems.add({"b.csv", 7, 1}, "field", "row 7 is short", "complete it");
  problems.add({"a.csv", 8, 1}, "header", "there is none", "add it");
  EXPECT_EQ(problems.count(), 1002U);
  ASSERT_EQ(problems.shown().size(), 22U);
  EXPECT_EQ(problems.shown()[19].more, 980U);
  const std::string text = text_of(problems);
  for (const char* part :
       {"a.csv:20:1: field 20\n  row 20 is short\n  complete it\n  and 980 more of this kind\n",
        "b.csv:7:1: field", "a.csv:8:1: header"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nnot in\n" << text;
  EXPECT_EQ(text.find("a.csv:21:1"), std::string::npos);
}

TEST(Problems, OfSeveralReadersAreCountedTogether) {
  Problems all(2), one(1);
  for (int k = 0; k < 5; ++k) one.add({"a", 1, 1}, "what", "rule", "way out");
  for (int k = 0; k < 3; ++k) all.add(CaseError(one.shown()));
  EXPECT_EQ(all.count(), 15U);
  ASSERT_EQ(all.shown().size(), 2U);
  EXPECT_EQ(all.shown()[0].more, 4U);
  EXPECT_EQ(all.shown()[1].more, 9U);  // 15, less the two that are shown and four with the first
  EXPECT_TRUE(Problems().none());
}

}  // namespace
}  // namespace vbond
