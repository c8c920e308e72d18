#include "vbond/case/names.hpp"

#include <gtest/gtest.h>

namespace vbond::keys {
namespace {

const std::vector<std::string> names{"particles", "spacing", "kind", "direction", "inertia", "E", "nu"};

TEST(NearestName, IsFoundThroughSwapsSlipsAndLetterCase) {
  EXPECT_EQ(nearest("particels", names), "particles");
  EXPECT_EQ(nearest("spacng", names), "spacing");
  EXPECT_EQ(nearest("Kind", names), "kind");
  EXPECT_EQ(nearest("e", names), "E");
  EXPECT_EQ(nearest("dir", names), "direction");
}

TEST(NearestName, IsNothingForAnotherWord) {
  EXPECT_EQ(nearest("velocity", names), "");
  EXPECT_EQ(nearest("mass", names), "");
  EXPECT_EQ(nearest(std::string(100'000, 'x'), names), "");
}

}  // namespace
}  // namespace vbond::keys
