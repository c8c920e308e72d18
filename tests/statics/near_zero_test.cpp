#include "vbond/statics/detail/near_zero.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "statics/matrices.hpp"
#include "vbond/statics/detail/factor.hpp"

namespace vbond::near_zero_test {
namespace {

/// A square lattice, most of whose eigenvalues are double, less `shift`.
struct Square {
  static constexpr int n = 16;
  SparseMatrix A;
  std::vector<double> nearest;  // all eigenvalues, nearest to zero first
  Factor factor;
  int negative = 0;

  explicit Square(double shift) : A(lattice(n, n, 1, true)), nearest(held_lattice_eigenvalues(n, n, 1)) {
    SparseMatrix unit(A.rows(), A.cols());
    unit.setIdentity();
    A -= shift * unit;
    for (double& value : nearest) value -= shift;
    std::sort(nearest.begin(), nearest.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    factor.analyse(A);
    negative = factor.factor_indefinite(A).value();
  }
  std::vector<double> first(int count) const {
    std::vector<double> values(nearest.begin(), nearest.begin() + count);
    std::sort(values.begin(), values.end());
    return values;
  }
};

/// Looks and counts solutions with a block.
struct Look {
  NearZeroSearch search;
  int blocks = 0;
  std::optional<EigenPairs> at(const Square& s, int count, double scale) {
    blocks = 0;
    return search.find(
        s.A,
        [&](const DenseMatrix& B) {
          ++blocks;
          return s.factor.solve_columns(B);
        },
        count, scale, 1e-14);
  }
};

// Eigenvalues number 2 and 3 are one, and so are 5 and 6: next to either pair both copies are there. A value
// v is known to 1e-3 |v| (v / scale), as the search promises.
TEST(NearZeroSearch, FindsBothCopiesOfADoubleEigenvalue) {
  const std::vector<double> all = held_lattice_eigenvalues(Square::n, Square::n, 1);
  for (const std::size_t pair : {1u, 4u}) {
    ASSERT_NEAR(all[pair], all[pair + 1], 1e-14);
    for (const double beside : {1e-2, -1e-2, 1e-6, 1e-10}) {
      const Square s(all[pair] - beside);
      Look look;
      const auto found = look.at(s, 4, 0.1);
      ASSERT_TRUE(found) << beside;
      const std::vector<double> expected = s.first(4);
      for (int k = 0; k < 4; ++k) {
        const double v = expected[static_cast<std::size_t>(k)];
        EXPECT_NEAR(found->values[k], v, 1e-3 * std::abs(v) * std::min(1.0, std::abs(v) / 0.1) + 1e-14);
      }
      const DenseMatrix overlap = found->vectors.transpose() * found->vectors;
      EXPECT_LT((overlap - DenseMatrix::Identity(4, 4)).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

// What was found serves the next matrix: three rounds are the fewest there are.
TEST(NearZeroSearch, BeginsWithWhatItHasFound) {
  const double pair = held_lattice_eigenvalues(Square::n, Square::n, 1)[4];
  Look look;
  ASSERT_TRUE(look.at(Square(pair - 1e-2), 2, 0.0));
  const int first = look.blocks;
  ASSERT_TRUE(look.at(Square(pair - 1e-4), 2, 0.0));
  EXPECT_LE(look.blocks, 4);
  EXPECT_GE(first, look.blocks);
}

TEST(NearZero, KnowsItsNumbers) {
  const NearZero zero{3, Vector::LinSpaced(4, -1.5, 1.5), DenseMatrix::Identity(4, 4)};
  EXPECT_FALSE(zero.has(2));
  EXPECT_TRUE(zero.has(3) && zero.has(6));
  EXPECT_FALSE(zero.has(7));
  EXPECT_EQ(zero.value(4), -0.5);
  EXPECT_EQ(zero.vectors_within(1.0).cols(), 2);
}

}  // namespace
}  // namespace vbond::near_zero_test
