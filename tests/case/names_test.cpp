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

TEST(NearestName, OfThreeLettersIsNoWordWithAnotherLetter) {
  const std::vector<std::string> lattices{"simple-cubic", "fcc", "hcp"};
  EXPECT_EQ(nearest_name("bcc", lattices), std::nullopt);
  EXPECT_EQ(nearest_name("hpc", lattices), "hcp");
  EXPECT_EQ(nearest_name("FCC", lattices), "fcc");
  EXPECT_EQ(nearest_name("fc", lattices), "fcc");
}

TEST(NearestName, IsNothingForAnotherWord) {
  EXPECT_EQ(nearest_name("velocity", names), std::nullopt);
  EXPECT_EQ(nearest_name("mass", names), std::nullopt);
  EXPECT_EQ(nearest_name(std::string(100'000, 'x'), names), std::nullopt);
}

}  // namespace
}  // namespace vbond::keys
