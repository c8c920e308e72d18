#include "vbond/core/printable.hpp"

#include <gtest/gtest.h>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

TEST(Printable, LettersStayAndControlsAreWrittenOut) {
  EXPECT_EQ(printable("Stab \xc3\xa4, 10 \xc2\xb0, \xe2\xa0\x80 \xf0\x9f\x98\x80\n\tend"),
            "Stab \xc3\xa4, 10 \xc2\xb0, \xe2\xa0\x80 \xf0\x9f\x98\x80\n\tend");
  EXPECT_EQ(printable("\x1b[2J\x1b]0;title\a\r\x7f"), "\\x1b[2J\\x1b]0;title\\x07\\x0d\\x7f");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\x9b2J");  // the control of one letter that begins as ESC [ does
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "abc"),
            "\\u202e"
            "abc");  // writes from right to left
}

TEST(Printable, WhatIsNotUtf8IsWrittenOut) {
  EXPECT_EQ(printable("\x9b"
                      "2J"),
            "\\x9b2J");
  EXPECT_EQ(printable("\xc0\x9b \xe0\x80\x9b \xff \xc3"), "\\xc0\\x9b \\xe0\\x80\\x9b \\xff \\xc3");
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond the last letter
}

TEST(Printable, ErrorsHoldNothingElse) {
  const std::string name("a\0\x1b[2J", 6);
  EXPECT_STREQ(IoError(name).what(), "a\\x00\\x1b[2J");
  EXPECT_STREQ(CaseError({{name, 1, 2}, name, name, name}).what(),
               "a\\x00\\x1b[2J:1:2: a\\x00\\x1b[2J\n  a\\x00\\x1b[2J\n  a\\x00\\x1b[2J");
  EXPECT_STREQ(NoEquilibrium(name, "f", "a").what(), "stage \"a\\x00\\x1b[2J\": f\n  a");
  EXPECT_STREQ(Diverged(1, 0.1, name, "f", "a").what(), "step 1: a\\x00\\x1b[2J: f\n  a");
}

}  // namespace
}  // namespace vbond
