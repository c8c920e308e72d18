#include "vbond/statics/detail/eigen.hpp"
#include "decompositions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "statics/matrices.hpp"

namespace vbond {
namespace {

// Eigenvalues are backward stable: wrong by some eps times the largest (12 for a 3D lattice), more through
// the factors of an interior shift; 1e-11 leaves a hundred.
constexpr double eigenvalue_error = 1e-11;
// Vectors are iterated to 1e-11 of the inverse's eigenvalue, at gaps of 1e-2 and more. Next to a shift that
// is itself an eigenvalue the inverse reaches 1e8, and eps of that is all the others can be told to.
constexpr double vector_error = 1e-8;

struct Box {
  int nx, ny, nz;
};
// Dense and iterated; equal sides give double, triple and sixfold eigenvalues.
constexpr Box boxes[] = {{10, 10, 1}, {4, 4, 5}, {20, 20, 1}, {13, 13, 13}};

SparseMatrix held(const Box& b) {
  return lattice(b.nx, b.ny, b.nz, true);
}

SparseMatrix identity(Eigen::Index n) {
  SparseMatrix I(n, n);
  I.setIdentity();
  return I;
}

double orthogonality_error(const DenseMatrix& V) {
  return (V.transpose() * V - DenseMatrix::Identity(V.cols(), V.cols())).cwiseAbs().maxCoeff();
}

void expect_pairs(const SparseMatrix& A, const EigenPairs& found, const std::vector<double>& expected,
                  const std::string& what) {
  ASSERT_EQ(static_cast<std::size_t>(found.values.size()), expected.size()) << what;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(found.values[column], expected[k], eigenvalue_error) << what << ", number " << k;
    const Vector v = found.vectors.col(column);
    EXPECT_LT((A * v - expected[k] * v).norm(), vector_error) << what << ", number " << k;
  }
  EXPECT_LT(orthogonality_error(found.vectors), vector_error) << what;
}

TEST(SmallestEigenpairs, AreThoseOfALatticeWithAllCopies) {
  for (const Box& b : boxes) {
    const SparseMatrix A = held(b);
    std::vector<double> values = held_lattice_eigenvalues(b.nx, b.ny, b.nz);
    for (const std::size_t count : {1u, 2u, 3u, 4u, 7u, 12u, 30u})
      expect_pairs(A, smallest_eigenpairs(A, static_cast<int>(count), 0.0),
                   {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count)},
                   std::to_string(count) + " of " + std::to_string(A.rows()));
  }
}

// The lowest one next to zero makes the inverse large, beside which all others are small: they are not lost
// in its rounding, nor are their copies.
TEST(EigenpairsNearZero, AreExactBesideAMatrixThatIsNearlySingular) {
  for (const Box& b : {Box{20, 20, 1}, Box{13, 13, 13}}) {
    std::vector<double> values = held_lattice_eigenvalues(b.nx, b.ny, b.nz);
    const std::vector<double> all = values;
    for (const double lowest : {1e-8, 1e-12}) {
      const double shift = all[0] - lowest;
      const SparseMatrix A = held(b) - shift * identity(b.nx * b.ny * b.nz);
      for (std::size_t k = 0; k < all.size(); ++k) values[k] = all[k] - shift;
      for (const int count : {1, 3, 9})
        expect_pairs(A, eigenpairs_near_zero(A, count), {values.begin(), values.begin() + count},
                     std::to_string(count) + " of " + std::to_string(A.rows()));
    }
  }
}

// Large enough that copies are searched for instead of counted.
TEST(SmallestEigenpairs, OfALargeLatticeComeWithAllCopies) {
  const SparseMatrix A = lattice(30, 30, 30, true);
  Factor factor;
  factor.analyse(A);
  ASSERT_GT(factor.bytes(), 0x1p25);
  const std::vector<double> values = held_lattice_eigenvalues(30, 30, 30);  // 1, 3, 3, 1, 3, ... equal ones
  for (const int count : {3, 7})
    expect_pairs(A, smallest_eigenpairs(A, count, 0.0), {values.begin(), values.begin() + count},
                 std::to_string(count));
}

TEST(SmallestEigenpairs, AreThoseAboveTheBound) {
  for (const Box& b : boxes) {
    const SparseMatrix A = held(b);
    const std::vector<double> values = held_lattice_eigenvalues(b.nx, b.ny, b.nz);
    const auto first = std::lower_bound(values.begin(), values.end(), 5.3);
    const auto count = std::min<std::ptrdiff_t>(9, values.end() - first);
    expect_pairs(A, smallest_eigenpairs(A, 9, 5.3), {first, first + count}, std::to_string(A.rows()));
  }
}

TEST(SmallestEigenpairs, AreFewerIfThereAreFewer) {
  for (const Box& b : boxes) {
    const SparseMatrix A = held(b);
    const std::vector<double> values = held_lattice_eigenvalues(b.nx, b.ny, b.nz);
    const double bound = 0.5 * (values[values.size() - 5] + values[values.size() - 4]);  // not within a pair
    const auto first = std::lower_bound(values.begin(), values.end(), bound);
    expect_pairs(A, smallest_eigenpairs(A, 9, bound), {first, values.end()}, std::to_string(A.rows()));
  }
}

// A free lattice in two copies: its two uniform motions have eigenvalue 0, and all else comes twice.
TEST(SmallestEigenpairs, LeaveOutGivenVectors) {
  for (const int side : {7, 30}) {
    const SparseMatrix one = lattice(side, side, 1, false);
    const int m = side * side;
    std::vector<Eigen::Triplet<double>> entries, motions;
    for (int j = 0; j < m; ++j) {
      for (SparseMatrix::InnerIterator it(one, j); it; ++it) {
        entries.emplace_back(static_cast<int>(it.row()), j, it.value());
        entries.emplace_back(m + static_cast<int>(it.row()), m + j, it.value());
      }
      motions.emplace_back(j, 0, 1.0 / side);
      motions.emplace_back(m + j, 1, 1.0 / side);
    }
    const SparseMatrix A = from_triplets(2 * m, entries);
    SparseMatrix without(2 * m, 2);
    without.setFromTriplets(motions.begin(), motions.end());
    const double lowest = 2.0 - 2.0 * std::cos(std::numbers::pi / side);  // along x, along y, each twice
    const std::vector<double> expected = {lowest, lowest, lowest, lowest, 2.0 * lowest, 2.0 * lowest};
    for (const double bound : {-1e-3, 0.0})
      expect_pairs(A, smallest_eigenpairs(A, 6, bound, without), expected, "without");
    EXPECT_NEAR(smallest_eigenpairs(A, 3, -1e-3).values[1], 0.0, eigenvalue_error);
  }
}

// The second difference squared: a pinned beam. Its smallest eigenvalues, near 1e-12 times the largest, lie
// so close to each other that inverse iteration about -1e-4 sees them as one.
TEST(SmallestEigenpairs, OfASlenderBeamAreFoundFromFarBelow) {
  const int n = 3000;
  std::vector<Eigen::Triplet<double>> t;
  for (int i = 0; i < n; ++i) {
    t.emplace_back(i, i, 2.0);
    if (i > 0) t.emplace_back(i, i - 1, -1.0), t.emplace_back(i - 1, i, -1.0);
  }
  const SparseMatrix K = from_triplets(n, t), A = K * K;
  for (const double bound : {0.0, -1e-12, -1e-8, -1e-4, -10.0}) {
    const EigenPairs found = smallest_eigenpairs(A, 4, bound);
    ASSERT_EQ(found.values.size(), 4);
    for (int k = 0; k < 4; ++k) {
      const double expected = std::pow(2.0 * std::sin((k + 1) * std::numbers::pi / (2 * (n + 1))), 4.0);
      EXPECT_NEAR(found.values[k], expected, 16.0 * 2.2e-16) << bound;  // eps times the largest
    }
  }
}

TEST(EigenpairsNearZero, HaveEitherSignAndAllCopies) {
  for (const Box& b : boxes) {
    const double shift = 2.9;
    const SparseMatrix A = held(b) - shift * identity(b.nx * b.ny * b.nz);
    std::vector<double> values = held_lattice_eigenvalues(b.nx, b.ny, b.nz);
    for (double& v : values) v -= shift;
    std::sort(values.begin(), values.end(), [](double x, double y) { return std::abs(x) < std::abs(y); });
    values.resize(8);
    expect_pairs(A, eigenpairs_near_zero(A, 8), values, std::to_string(A.rows()));
  }
}

TEST(EigenpairsNearZero, FindZerosThemselves) {
  for (const int side : {10, 30}) {
    const SparseMatrix A = lattice(side, side, 1, false);
    const double lowest = 2.0 - 2.0 * std::cos(std::numbers::pi / side);
    expect_pairs(A, eigenpairs_near_zero(A, 3), {0.0, lowest, lowest}, std::to_string(A.rows()));
  }
}

// B = -1 on the first lattice and +20 on the second: only the first can buckle, at its eigenvalues.
TEST(CriticalFactors, ArePositiveOnesWithAllCopies) {
  for (const Box& b : boxes) {
    const SparseMatrix K = held(b);
    const int n = static_cast<int>(K.rows());
    std::vector<Eigen::Triplet<double>> a, g;
    for (int j = 0; j < n; ++j) {
      for (SparseMatrix::InnerIterator it(K, j); it; ++it)
        for (const int from : {0, n})
          a.emplace_back(from + static_cast<int>(it.row()), from + j, 1e9 * it.value());
      g.emplace_back(j, j, -1.0);
      g.emplace_back(n + j, n + j, 20.0);
    }
    const SparseMatrix A = from_triplets(2 * n, a), B = from_triplets(2 * n, g);
    std::vector<double> values = held_lattice_eigenvalues(b.nx, b.ny, b.nz);
    values.resize(8);
    const EigenPairs found = critical_factors(A, B, 8);
    ASSERT_EQ(found.values.size(), 8) << n;
    EXPECT_LT((found.vectors.transpose() * (A * found.vectors) - DenseMatrix::Identity(8, 8)).norm(),
              vector_error);
    for (Eigen::Index k = 0; k < 8; ++k) {
      const double mu = 1e9 * values[static_cast<std::size_t>(k)];
      EXPECT_NEAR(found.values[k] / mu, 1.0, eigenvalue_error) << n << ", number " << k;
      const Vector Ax = A * found.vectors.col(k), Bx = B * found.vectors.col(k);
      EXPECT_LT((Ax + mu * Bx).norm(), vector_error * Ax.norm());
    }
  }
}

// Three points pushed: three factors, and the rest of the body has none. With the inverse G of A at these
// points, -B = diag(1, 2, 3): 1/mu are the eigenvalues of B^1/2 G B^1/2.
TEST(CriticalFactors, AreFewerIfThereAreFewer) {
  for (const Box& b : boxes) {
    const SparseMatrix A = held(b);
    const int n = static_cast<int>(A.rows()), points[3] = {1, n / 2, n - 3};
    std::vector<Eigen::Triplet<double>> g;
    DenseMatrix theta(3, 3);
    const DenseMatrix G = testing::solved(A, DenseMatrix::Identity(n, n));
    for (int i = 0; i < 3; ++i) {
      g.emplace_back(points[i], points[i], -(i + 1.0));
      for (int j = 0; j < 3; ++j)
        theta(i, j) = std::sqrt(i + 1.0) * G(points[i], points[j]) * std::sqrt(j + 1.0);
    }
    const SparseMatrix B = from_triplets(n, g);
    const Vector expected = dense_eigenvalues(theta).values.cwiseInverse();
    const EigenPairs found = critical_factors(A, B, 6);
    ASSERT_EQ(found.values.size(), 3) << n;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found.values[k] / expected[2 - k], 1.0, 1e-11) << n;
    const SparseMatrix pulled = -B;
    EXPECT_EQ(critical_factors(A, pulled, 6).values.size(), 0) << n;
    EXPECT_EQ(critical_factors(A, SparseMatrix(n, n), 6).values.size(), 0);
  }
}

TEST(CriticalFactors, NeedADefiniteMatrix) {
  for (const int side : {5, 30}) {
    const SparseMatrix A = lattice(side, side, 1, false);
    const SparseMatrix B = -identity(A.rows());
    EXPECT_THROW(critical_factors(A, B, 1), NoConvergence);
  }
}

TEST(LargestEigenvalue, IsNotBelowTheTrueOne) {
  for (const Box& b : boxes) {
    const double exact = held_lattice_eigenvalues(b.nx, b.ny, b.nz).back();
    for (const double scale : {1e-9, 1.0, 1e11}) {
      const SparseMatrix A = scale * held(b);
      const double largest = largest_eigenvalue(A) / scale;
      EXPECT_GE(largest, exact * (1.0 - 1e-15)) << A.rows();  // rounding of the closed form
      EXPECT_LE(largest, exact * (1.0 + 1e-10)) << A.rows();
    }
  }
}

}  // namespace
}  // namespace vbond
