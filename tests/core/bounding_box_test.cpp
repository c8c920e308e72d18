#include "vbond/core/bounding_box.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace vbond {
namespace {

// Of all boxes with sides of 0, 1 and 2, and of the empty box.
TEST(BoundingBox, HasItsLongestAxesFirst) {
  using Axes = std::array<int, 3>;
  for (int n = 0; n < 27; ++n) {
    const Axes size{n % 3, n / 3 % 3, n / 9};
    BoundingBox box;
    box.add({-1, 5, 0.5});
    box.add({-1.0 + size[0], 5.0 + size[1], 0.5 + size[2]});
    Axes expected{0, 1, 2};
    do {  // the first of all orders, as they follow each other, that does not grow
      if (size[expected[0]] >= size[expected[1]] && size[expected[1]] >= size[expected[2]]) break;
    } while (std::next_permutation(expected.begin(), expected.end()));
    EXPECT_EQ(box.axes_by_length(), expected) << n;
  }
  EXPECT_EQ(BoundingBox{}.axes_by_length(), (Axes{0, 1, 2}));
}

}  // namespace
}  // namespace vbond
