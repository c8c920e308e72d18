#include "vbond/core/nearest.hpp"

#include <gtest/gtest.h>

namespace vbond::keys {
namespace {

const std::vector<std::string> names{"particles", "spacing", "kind", "direction", "inertia", "E", "nu"};

TEST(NearestName, IsFoundThroughSwapsSlipsAndLetterCase) {
  EXPECT_EQ(nearest_name("particels", names), "particles");
  EXPECT_EQ(nearest_name("spacng", names), "spacing");
  EXPECT_EQ(nearest_name("Kind", names), "kind");
  EXPECT_EQ(nearest_name("e", names), "E");
  EXPECT_EQ(nearest_name("dir", names), "direction");
}

TEST(NearestName, IsNothingForAnotherWord) {
  EXPECT_EQ(nearest_name("velocity", names), std::nullopt);
  EXPECT_EQ(nearest_name("mass", names), std::nullopt);
  EXPECT_EQ(nearest_name(std::string(100'000, 'x'), names), std::nullopt);
}

}  // namespace
}  // namespace vbond::keys
