#include "vbond/statics/detail/unsymmetric_factor.hpp"
#include "decompositions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
#include <limits>

#include "statics/matrices.hpp"

namespace vbond {
namespace {

/// A matrix of this size with a full diagonal and some other entries, zero where |i - j| is not 0, 1 or 5.
SparseMatrix banded(int n, unsigned seed) {
  const Vector x = random_vector(n * n, seed);
  SparseMatrix A(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (const int k = std::abs(i - j); k == 0 || k == 1 || k == 5) A.insert(i, j) = x[i * n + j];
  A.makeCompressed();
  return A;
}

// Entries of 1, and condition numbers of some 1e3.
TEST(UnsymmetricFactor, SolvesAndTellsTheSignOfTheDeterminant) {
  UnsymmetricFactor factor;
  int signs[2] = {};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int n = seed % 2 == 0 ? 30 : 17;
    const SparseMatrix A = banded(n, seed);
    const Vector b = random_vector(n, 100 + seed);
    ASSERT_TRUE(factor.factor(A)) << seed;
    EXPECT_LE((A * factor.solve(b) - b).norm(), 1e-12 * b.norm()) << seed;
    const double determinant = testing::determinant(A);
    EXPECT_EQ(factor.sign(), determinant < 0.0 ? -1 : 1) << seed;
    ++signs[determinant < 0.0 ? 0 : 1];
  }
  EXPECT_GT(signs[0], 3);
  EXPECT_GT(signs[1], 3);
  EXPECT_EQ(factor.made(), 20);
}

// Two rows that are equal, and an entry that is not finite.
TEST(UnsymmetricFactor, RefusesWhatIsSingularOrNotFinite) {
  SparseMatrix A(3, 3);
  const double entries[3][3] = {{1, 2, 3}, {0.1, 0.2, 0.3}, {4, 5, 7}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) A.insert(i, j) = entries[i][j];
  A.makeCompressed();
  UnsymmetricFactor factor;
  EXPECT_FALSE(factor.factor(A));
  EXPECT_EQ(factor.sign(), 0);
  A.coeffRef(0, 0) = 2;
  EXPECT_TRUE(factor.factor(A));
  A.coeffRef(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(factor.factor(A));
}

}  // namespace
}  // namespace vbond
