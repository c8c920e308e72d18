#include "vbond/model/bond.hpp"

#include <gtest/gtest.h>

namespace vbond {
namespace {

Coefficients counted(std::size_t first, std::size_t last) {
  Coefficients c{};
  for (std::size_t k = first; k < last; ++k) c[k] = 1.0 + static_cast<double>(k);
  return c;
}

// Whether a bond has few of them, which stand at hand, or all.
TEST(KeptCoefficients, AreThoseGiven) {
  for (std::size_t first = 0; first < most_coefficients; ++first)
    for (std::size_t last = first; last <= most_coefficients; ++last) {
      const Coefficients given = counted(first, last);
      const KeptCoefficients kept = given;
      EXPECT_EQ(Coefficients(kept), given);
      for (std::size_t k = 0; k < most_coefficients; ++k) EXPECT_EQ(kept[k], given[k]) << k;
    }
}

TEST(KeptCoefficients, ChangeOneByOneAndNotWithACopy) {
  for (std::size_t k = 0; k < most_coefficients; ++k) {
    const KeptCoefficients before = counted(0, most_coefficients);
    KeptCoefficients after = before;
    EXPECT_TRUE(after == before);
    after.set(k, -1.0);
    EXPECT_FALSE(after == before);
    EXPECT_EQ(before[k], 1.0 + static_cast<double>(k));
    for (std::size_t n = 0; n < most_coefficients; ++n) EXPECT_EQ(after[n], n == k ? -1.0 : before[n]);
  }
}

TEST(Bond, HasTheFramesThatItIsGiven) {
  const Quatd one{1, 0, 0, 0}, other{0, 1, 0, 0};
  Bond bond;
  for (const Quatd& in_j : {one, other, one}) {
    set_frames(bond, one, in_j);
    EXPECT_EQ(bond.frame_i, one);
    EXPECT_EQ(frame_j(bond), in_j);
    EXPECT_EQ(has_other_frame(bond), in_j != one);
    const Bond copy = bond;
    EXPECT_TRUE(copy == bond);
    EXPECT_EQ(frame_j(copy), in_j);
  }
}

}  // namespace
}  // namespace vbond
