#include "vbond/statics/detail/lobpcg.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "statics/matrices.hpp"
#include "vbond/statics/detail/deflated.hpp"
#include "vbond/statics/detail/gmres.hpp"

namespace vbond {
namespace {

/// The lowest eigenvalues of A, with a preconditioner that is far from its inverse: that of A + shift.
struct Problem {
  Problem(SparseMatrix matrix, double shift) : A(std::move(matrix)) {
    factor.analyse(A);
    EXPECT_TRUE(factor.factor_definite(A, shift));
    given.size = A.rows();
    given.times = [this](const DenseMatrix& X) -> DenseMatrix { return A * X; };
    given.inverse = [this](const DenseMatrix& R) { return factor.solve_columns(R); };
  }
  SparseMatrix A;
  Factor factor;
  LowestProblem given;
};

SparseMatrix shifted(const SparseMatrix& A, double shift) {
  SparseMatrix B = A;
  B.diagonal().array() += shift;
  return B;
}

// Of a cube they come in threes: the fifth is the first of three that are the same.
TEST(Lobpcg, FindsEqualEigenvaluesTogether) {
  Problem p(lattice(8, 8, 8, true), 0.3);
  const std::vector<double> expected = held_lattice_eigenvalues(8, 8, 8);
  for (const int count : {1, 4, 5, 11}) {
    const Lowest found = lowest_eigenpairs(p.given, {count, 1e-6});
    ASSERT_EQ(found.why_not, "");
    ASSERT_EQ(found.size(), count);
    for (int k = 0; k < count; ++k) {
      const double error = std::abs(found.values[k] - expected[std::size_t(k)]);
      EXPECT_LE(error, 1e-11 * expected[std::size_t(k)]) << k << " of " << count;  // the residual's square
      EXPECT_LE(error, found.errors[k] + 1e-14);
    }
    EXPECT_LE((found.vectors.transpose() * found.vectors - DenseMatrix::Identity(count, count)).norm(),
              1e-12);
  }
}

// Moved down so that four are negative and the next three zero.
TEST(Lobpcg, FindsNegativeAndZeroEigenvalues) {
  const std::vector<double> all = held_lattice_eigenvalues(7, 7, 7);
  Problem p(shifted(lattice(7, 7, 7, true), -all[4]), all[4] + 0.1);
  LowestWanted wanted{8, 1e-6, 0.1};
  const Lowest found = lowest_eigenpairs(p.given, wanted);
  ASSERT_EQ(found.why_not, "");
  for (int k = 0; k < 8; ++k) EXPECT_NEAR(found.values[k], all[std::size_t(k)] - all[4], 1e-12) << k;
  EXPECT_EQ((found.values.array() < -found.errors.array() - 1e-14).count(), 4);
  const Lowest again = lowest_eigenpairs(p.given, wanted, found.vectors);
  EXPECT_LT(again.iterations, found.iterations);
}

// Constants cost a free lattice nothing: without them the lowest is the first cosine.
TEST(Lobpcg, LeavesOutWhatIsKnown) {
  Problem p(lattice(9, 6, 5, false), 0.1);
  SparseMatrix constant(p.A.rows(), 1);
  for (int k = 0; k < p.A.rows(); ++k)
    constant.insert(k, 0) = 1.0 / std::sqrt(static_cast<double>(p.A.rows()));
  p.given.without = &constant;
  const Lowest found = lowest_eigenpairs(p.given, {2, 1e-6});
  EXPECT_NEAR(found.values[0], 2.0 - 2.0 * std::cos(M_PI / 9), 1e-12);
  EXPECT_NEAR(found.values[1], 2.0 - 2.0 * std::cos(M_PI / 6), 1e-12);
}

// A x = lambda B x with B = 2 + A has lambda = a / (2 + a) for each eigenvalue a of A.
TEST(Lobpcg, TakesAMetric) {
  Problem p(lattice(6, 7, 8, true), 0.2);
  const SparseMatrix B = shifted(p.A, 2.0);
  p.given.metric = [&B](const DenseMatrix& X) -> DenseMatrix { return B * X; };
  const std::vector<double> expected = held_lattice_eigenvalues(6, 7, 8);
  const Lowest found = lowest_eigenpairs(p.given, {3, 1e-6});
  ASSERT_EQ(found.why_not, "");
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(found.values[k], expected[std::size_t(k)] / (2.0 + expected[std::size_t(k)]), 1e-11);
}

TEST(Lobpcg, SaysWhereItDoesNotReachTheResidual) {
  Problem p(lattice(10, 10, 10, true), 5.0);
  const Lowest found = lowest_eigenpairs(p.given, {3, 1e-12, 0.0, 4});
  EXPECT_NE(found.why_not.find("after 4 iterations"), std::string::npos) << found.why_not;
  p.given.inverse = [](const DenseMatrix& R) -> DenseMatrix { return -R; };
  EXPECT_THROW(lowest_eigenpairs(p.given, {3, 1e-6}), InverseNotDefinite);
}

// The antisymmetric part is as large as the symmetric one, which preconditions.
TEST(Gmres, SolvesWithoutSymmetry) {
  const SparseMatrix S = lattice(10, 9, 8, true);
  SparseMatrix A = S;
  for (int k = 0; k + 1 < A.rows(); ++k) A.coeffRef(k, k + 1) += 1.0, A.coeffRef(k + 1, k) -= 1.0;
  Factor factor;
  factor.analyse(S);
  ASSERT_TRUE(factor.factor_definite(S));
  const Vector b = random_vector(static_cast<int>(S.rows()), 3);
  const auto times = [&A](const Vector& x) -> Vector { return A * x; };
  const auto inverse = [&factor](const Vector& r) { return factor.solve(r); };
  for (const int basis : {10, 60}) {
    const Gmres g = gmres(times, inverse, b, 1e-11 * b.norm(), basis, 2000);
    EXPECT_LE((b - A * g.x).norm(), 1e-11 * b.norm()) << basis;
  }
  const Gmres few = gmres(times, inverse, b, 1e-11 * b.norm(), 5, 5);
  EXPECT_GT(few.left, 1e-11 * b.norm());
  EXPECT_NEAR(few.left, (b - A * few.x).norm(), 1e-12 * b.norm());
}

}  // namespace
}  // namespace vbond
