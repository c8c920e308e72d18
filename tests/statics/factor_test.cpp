#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/detail/dense.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "statics/matrices.hpp"

extern "C" void openblas_set_num_threads(int);
extern "C" int openblas_get_num_threads();

namespace vbond::factor_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Largest component of (A + shift I) x - b over what rounding leaves of a backward stable solution,
/// eps (|A| + |shift|) |x|, in the norm of largest row sums; 3D lattices have rows of at most 12.
double scaled_residual(const SparseMatrix& A, double shift, const Vector& x, const Vector& b) {
  const Vector left = A * x + shift * x - b;
  return left.cwiseAbs().maxCoeff() / (epsilon * (12.0 + std::abs(shift)) * x.cwiseAbs().maxCoeff());
}

Factor analysed(const SparseMatrix& A) {
  return vbond::analysed(A);
}

// Both kinds of size: simplicial (a chain) and supernodal (a cube).
TEST(Factor, SolvesWithTheShiftedMatrix) {
  for (const SparseMatrix& A : {lattice(400, 1, 1, true), lattice(14, 14, 14, true)}) {
    const Vector b = random_vector(static_cast<int>(A.rows()), 1);
    Factor f = analysed(A);
    for (const double shift : {0.0, 0.5}) {
      ASSERT_TRUE(f.factor_definite(A, shift));
      // sums of some hundred terms of random sign: tens of eps at most
      EXPECT_LT(scaled_residual(A, shift, f.solve(b), b), 30.0);
      ASSERT_EQ(f.factor_indefinite(A, shift), 0);
      EXPECT_LT(scaled_residual(A, shift, f.solve(b), b), 30.0);
    }
    ASSERT_TRUE(f.factor_indefinite(A, -3.3));
    EXPECT_LT(scaled_residual(A, -3.3, f.solve(b), b), 30.0);
  }
}

// The order of elimination is the same, and so is every bit.
TEST(Factor, TakesTheAnalysisOfAnotherOne) {
  for (const SparseMatrix& A : {lattice(400, 1, 1, true), lattice(14, 14, 14, true)}) {
    const Vector b = random_vector(static_cast<int>(A.rows()), 1);
    Factor f = analysed(A), same = vbond::analysed(A, &f);
    EXPECT_EQ(f.bytes(), same.bytes());
    EXPECT_EQ(f.operations(), same.operations());
    ASSERT_TRUE(f.factor_definite(A, 0.5));
    ASSERT_TRUE(same.factor_definite(A, 0.5));
    EXPECT_EQ(f.solve(b), same.solve(b));
    ASSERT_EQ(f.factor_indefinite(A, -3.3), same.factor_indefinite(A, -3.3));
    EXPECT_EQ(f.solve(b), same.solve(b));
  }
}

struct Box {
  int nx, ny, nz;
};
// simplicial, supernodal
constexpr Box boxes[] = {{400, 1, 1}, {14, 14, 14}};

// Pivots and eigenvalues are known to some n eps; 1e-9 is far above that and far below the next eigenvalue.
TEST(Factor, IsDefiniteExactlyWhenTheSmallestEigenvalueIsPositive) {
  for (const Box& b : boxes) {
    const SparseMatrix A = lattice(b.nx, b.ny, b.nz, true);
    const double smallest = held_lattice_eigenvalues(b.nx, b.ny, b.nz).front();
    Factor f = analysed(A);
    EXPECT_TRUE(f.factor_definite(A, -smallest + 1e-9));
    EXPECT_FALSE(f.factor_definite(A, -smallest - 1e-9));
    EXPECT_FALSE(f.factor_definite(A, -3.0 - smallest));
    EXPECT_TRUE(f.factor_definite(A));  // can be used again
  }
}

TEST(Factor, CountsTheEigenvaluesBelowAShift) {
  for (const Box& b : boxes) {
    const SparseMatrix A = lattice(b.nx, b.ny, b.nz, true);
    const std::vector<double> values = held_lattice_eigenvalues(b.nx, b.ny, b.nz);
    Factor f = analysed(A);
    for (const double s : {0.07, 0.31, 1.37, 4.001, 7.3, 20.0}) {
      const auto below = std::lower_bound(values.begin(), values.end(), s) - values.begin();
      EXPECT_EQ(f.factor_indefinite(A, -s), below) << "s = " << s << " of n = " << A.rows();
    }
  }
}

// Blocks of many sizes, wider than the strips in which they are eliminated: a random matrix whose factor
// fills up. Without pivoting rounding grows with the smallest entry of D; 1e-8 is far above that of these
// seeds.
TEST(Factor, CountsAndSolvesByWideBlocks) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    std::mt19937 random(seed);
    const int n = 700;
    std::uniform_int_distribution<int> row(0, n - 1);
    std::normal_distribution<double> value;
    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < n; ++k) entries.emplace_back(k, k, 3.0 * value(random));
    for (int k = 0; k < 6 * n; ++k) {
      const int i = row(random), j = row(random);
      const double v = value(random);
      entries.emplace_back(i, j, v), entries.emplace_back(j, i, v);
    }
    const SparseMatrix A = from_triplets(n, entries);
    const Vector values = dense_eigenvalues(A).values;
    Factor f = analysed(A);
    for (const double shift : {0.0, 2.0, -7.0}) {
      ASSERT_EQ(f.factor_indefinite(A, shift), (values.array() < -shift).count()) << seed;
      const Vector x = random_vector(n, seed);
      EXPECT_LT((f.solve(A * x + shift * x) - x).norm(), 1e-8 * x.norm()) << seed;
    }
  }
}

TEST(Factor, ReadsTheLowerTriangleOnly) {
  const SparseMatrix A = lattice(5, 4, 3, true), lower = A.triangularView<Eigen::Lower>();
  const Vector b = random_vector(60, 3);
  Factor f = analysed(lower);
  ASSERT_TRUE(f.factor_definite(lower));
  EXPECT_LT(scaled_residual(A, 0.0, f.solve(b), b), 30.0);
  ASSERT_TRUE(f.factor_indefinite(lower, -3.3));
  EXPECT_LT(scaled_residual(A, -3.3, f.solve(b), b), 30.0);
}

// A body that nothing holds: the last pivot is zero but for rounding. Held by one spring of 1e-8, it is not.
TEST(Factor, FindsASingularMatrixHoweverStiffnessesAndOrder) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-2.0, 2.0);
  for (const Box& b : {Box{2, 1, 1}, Box{30, 1, 1}, Box{3000, 1, 1}, Box{40, 40, 1}, Box{12, 12, 12}})
    for (int trial = 0; trial < 20; ++trial) {
      SparseMatrix A = lattice(b.nx, b.ny, b.nz, false, [&] { return std::pow(10.0, exponent(random)); });
      Factor f = analysed(A);
      EXPECT_EQ(f.factor_indefinite(A), std::nullopt) << "n = " << A.rows();
      EXPECT_GE(f.singular_unknown(), 0);
      A.coeffRef(0, 0) += 1e-8;
      EXPECT_EQ(f.factor_indefinite(A), 0) << "n = " << A.rows();
      EXPECT_EQ(f.singular_unknown(), -1);
    }
}

TEST(Factor, NamesTheUnknownThatNothingHolds) {
  SparseMatrix A = lattice(100, 1, 1, true);
  A.prune([](int row, int column, double) { return row != 37 && column != 37; });
  A.coeffRef(37, 37) = 0.0;
  A.makeCompressed();
  Factor f = analysed(A);
  EXPECT_EQ(f.factor_indefinite(A), std::nullopt);
  EXPECT_EQ(f.singular_unknown(), 37);
}

// A soft spring is no singularity: relative to it, or to its neighbours, nothing cancels.
TEST(Factor, ToleratesUnknownsOfVeryDifferentStiffness) {
  const SparseMatrix A = from_triplets(3, {{0, 0, 1e-18}, {1, 1, 1.0}, {2, 2, -1e12}});
  Factor f = analysed(A);
  EXPECT_EQ(f.factor_indefinite(A), 1);
}

TEST(Factor, GivesTheSameBitsTwice) {
  const SparseMatrix A = lattice(16, 16, 16, true);
  const Vector b = random_vector(static_cast<int>(A.rows()), 2);
  const auto solved = [&](bool definite) {
    Factor f = analysed(A);
    EXPECT_TRUE(definite ? f.factor_definite(A) : f.factor_indefinite(A, -1.0).has_value());
    return f.solve(b);
  };
  for (const bool definite : {true, false}) EXPECT_EQ(solved(definite), solved(definite));
}

TEST(Factor, KnowsItsSizeBeforehand) {
  const SparseMatrix A = lattice(50, 1, 1, true);  // a chain fills nothing: 50 + 49 entries
  EXPECT_EQ(analysed(A).bytes(), 99.0 * (sizeof(double) + sizeof(int)));
}

// The number of threads is the whole process's, which may have other work for OpenBLAS.
TEST(Factor, LeavesTheProcessItsBlasThreads) {
  const int before = openblas_get_num_threads();
  openblas_set_num_threads(2);
  if (openblas_get_num_threads() != 2) GTEST_SKIP() << "this OpenBLAS has one thread only";
  {
    const SparseMatrix A = lattice(14, 14, 14, true);
    Factor f = analysed(A);
    EXPECT_EQ(openblas_get_num_threads(), 2);
    ASSERT_TRUE(f.factor_definite(A, 0.0));
    EXPECT_EQ(openblas_get_num_threads(), 2);
    f.solve(random_vector(static_cast<int>(A.rows()), 1));
    EXPECT_EQ(openblas_get_num_threads(), 2);
  }
  EXPECT_EQ(openblas_get_num_threads(), 2);
  openblas_set_num_threads(before);
}

}  // namespace
}  // namespace vbond::factor_test
