#include "vbond/statics/detail/kept_factor.hpp"

#include <gtest/gtest.h>

#include "statics/matrices.hpp"

namespace vbond::kept_factor_test {
namespace {

/// A lattice of n^3 points whose factor is kept.
struct Kept {
  SparseMatrix A;
  Factor factor;
  KeptFactor kept{factor};

  explicit Kept(int n) : A(lattice(n, n, n, true)) {
    factor.analyse(A);
    EXPECT_TRUE(factor.factor_definite(A));
    kept.begin(A);
  }
  /// (A^-1)_pp
  double softness(int p) const { return factor.solve(Vector::Unit(A.rows(), p))[p]; }
};

void add_spring(SparseMatrix& A, int p, int q, double stiffness) {
  A.coeffRef(p, p) += stiffness, A.coeffRef(q, q) += stiffness;
  A.coeffRef(p, q) -= stiffness, A.coeffRef(q, p) -= stiffness;
}
DenseMatrix spring_gone() {
  return (DenseMatrix(2, 2) << -1, 1, 1, -1).finished();
}

/// That this factor is as near to A as a new one.
void expect_near(KeptFactor& kept, const SparseMatrix& A, const Vector& b) {
  ASSERT_TRUE(kept.at_hand());
  const double before = kept.spent();
  const auto x = kept.solve(A, b, 1e-10);
  ASSERT_TRUE(x);
  EXPECT_LE((A * *x - b).norm(), 30e-10 * b.norm());
  EXPECT_LT(kept.spent() - before, 3.5);
  EXPECT_TRUE(kept.shows_definite(A));
}

// Without one spring after the other M stays the matrix itself, but for single precision, some 1e-6 of it:
// conjugate gradients then take two iterations, three solutions, each of hardly more than its price.
// Residuals in the norm of M^-1 are as small in size but for the root of its condition number, some 30.
TEST(KeptFactor, FollowsSpringsThatBreak) {
  Kept k(10);
  SparseMatrix A = k.A;
  const Vector b = random_vector(static_cast<int>(A.rows()), 3);
  for (const int p : {0, 1, 555, 556, 700}) {
    add_spring(A, p, p + 1, -1.0);
    k.kept.follow({p, p + 1}, spring_gone());
    expect_near(k.kept, A, b);
  }
}

// The same of springs between points far from each other, for which the factor has no room, as they come and
// go again, two with an end in common. Solutions by the factor alone, as it was made, are as good in the end.
TEST(KeptFactor, FollowsWhatComesAndGoes) {
  Kept k(10);
  SparseMatrix A = k.A;
  const Vector b = random_vector(static_cast<int>(A.rows()), 3);
  const Vector at_first = k.kept.solve_roughly(b);
  const auto follow = [&] {
    k.kept.follow(A);
    expect_near(k.kept, A, b);
  };
  const std::vector<std::pair<int, int>> springs = {{7, 411}, {411, 880}, {123, 765}};
  for (const auto& [p, q] : springs) add_spring(A, p, q, 1.0);
  follow();
  for (const auto& [p, q] : springs) add_spring(A, p, q, -1.0);
  follow();
  EXPECT_LE((k.kept.solve_roughly(b) - at_first).norm(), 1e-5 * at_first.norm());
}

// Columns together are what each is alone, a zero one and one that has ended early among them. Springs
// between half as stiff and twice as stiff: the eigenvalues of M^-1 A lie between 1/2 and 2, so that the
// residual falls by 3 in each iteration at least, and 1e-10 takes 22, each at the price of three columns.
TEST(KeptFactor, SolvesColumnsTogether) {
  Kept k(8);
  SparseMatrix A = k.A;
  const int size = static_cast<int>(A.rows());
  for (int p = 0; p < size; ++p)
    for (SparseMatrix::InnerIterator it(A, p); it; ++it)
      if (const int q = static_cast<int>(it.row()); q > p && it.value() != 0.0) {
        const double more = (p * 7 + q) % 2 == 0 ? 1.0 : -0.5;
        A.coeffRef(p, p) += more, A.coeffRef(q, q) += more;
        A.coeffRef(p, q) -= more, A.coeffRef(q, p) -= more;
      }
  DenseMatrix B = DenseMatrix::Zero(size, 3);
  B.col(0) = random_vector(size, 5);
  B.col(2) = A * Vector::Ones(size);
  constexpr double price = 1.4;
  const double before = k.kept.spent();
  const DenseMatrix none = DenseMatrix::Zero(size, 3);
  const auto X = k.kept.solve_columns(A, B, none, 1e-10);
  ASSERT_TRUE(X);
  EXPECT_LE((A * *X - B).norm(), 30e-10 * B.norm());
  EXPECT_EQ(X->col(1).norm(), 0.0);
  EXPECT_LE(k.kept.spent() - before, 24.0 * price);
  const double first = k.kept.spent();
  const auto again = k.kept.solve_columns(A, 1.001 * B, *X, 1e-10);  // 1e-3 is left of B: a third less to do
  ASSERT_TRUE(again);
  EXPECT_LE((A * *again - 1.001 * B).norm(), 30e-10 * B.norm());
  EXPECT_LE(k.kept.spent() - first, 18.0 * price);
  EXPECT_FALSE(k.kept.solve_columns(-A, B, none, 1e-10)) << "not definite";
}

// A free body of n unknowns, each on a soft spring s of its own. As a whole it moves against n s, so that L^T
// of that movement is of length sqrt(n s). Rounding of entries of L, some ten of size 1 in a column, by 2^-25
// in the mean adds about sqrt(10 n) 2^-25 to it. That is a part of 1e-4 for the first s, less than what is
// near enough, and of 0.3 for the other: there the factor itself is used.
TEST(KeptFactor, IsNotRoundedWhereThatMattersMuch) {
  for (const double soft : {1e-6, 0x1p-43}) {
    SparseMatrix A = lattice(10, 10, 10, false);
    A.diagonal().array() += soft;
    Factor factor;
    factor.analyse(A);
    ASSERT_TRUE(factor.factor_definite(A));
    SingleFactor rounded;
    ASSERT_TRUE(factor.copy_to(rounded));
    KeptFactor kept(factor);
    kept.begin(A);
    const Vector b = random_vector(static_cast<int>(A.rows()), 3);
    EXPECT_EQ(kept.solve_roughly(b), soft < 1e-6 ? factor.solve(b) : Vector(rounded.solve(b))) << soft;
  }
}

// The solution beside a proof is that of a factor. A matrix that is not definite has none.
TEST(KeptFactor, SolvesBesideAProof) {
  Kept k(8);
  SparseMatrix A = k.A;
  A.diagonal().array() += 0.1;
  const Vector b = random_vector(static_cast<int>(A.rows()), 7);
  const auto x = k.kept.solve_if_definite(A, b, 1e-10);
  ASSERT_TRUE(x);
  EXPECT_LE((A * *x - b).norm(), 30e-10 * b.norm());
  A.coeffRef(100, 100) = -1.0;
  EXPECT_FALSE(k.kept.solve_if_definite(A, b, 1e-10));
}

// A matrix that has moved away everywhere is solved with, and is shown to be definite as long as it is: the
// smallest eigenvalue of M^-1 (A - s I) is 1 - s / lambda_1.
TEST(KeptFactor, TellsByRandomSidesWhatIsDefinite) {
  Kept k(8);
  const double lowest = held_lattice_eigenvalues(8, 8, 8).front();
  const auto shifted = [&](double part) {
    SparseMatrix A = k.A;
    A.diagonal().array() -= part * lowest;
    return A;
  };
  for (const double part : {-1.0, 0.5, 0.9, 0.99}) EXPECT_TRUE(k.kept.shows_definite(shifted(part))) << part;
  for (const double part : {0.9999, 1.0, 1.0001, 1.01, 1.5})  // the first: too soft to be known
    EXPECT_FALSE(k.kept.shows_definite(shifted(part))) << part;
  const Vector b = random_vector(static_cast<int>(k.A.rows()), 5);
  const auto x = k.kept.solve(shifted(0.9), b, 1e-10);
  ASSERT_TRUE(x);
  EXPECT_LE((shifted(0.9) * *x - b).norm(), 30e-10 * b.norm());
  EXPECT_FALSE(k.kept.solve(shifted(1.5), b, 1e-10));
}

// A - c e e^T has one eigenvalue below zero if c (A^-1)_pp > 1, of a mode that no other point need take part
// in: random sides meet every one of them. A side that has no part in it meets none.
TEST(KeptFactor, MissesNoLocalMode) {
  Kept k(8);
  for (int p = 0; p < k.A.rows(); ++p) {
    const double critical = 1.0 / k.softness(p);
    SparseMatrix A = k.A;
    A.coeffRef(p, p) -= 0.99 * critical;
    EXPECT_TRUE(k.kept.shows_definite(A)) << p;
    A.coeffRef(p, p) -= 0.02 * critical;
    EXPECT_FALSE(k.kept.shows_definite(A)) << p;
  }
}

// When a spring goes that alone held a point, no factor follows it.
TEST(KeptFactor, IsDroppedWhenWhatIsLeftIsNotDefinite) {
  Kept k(1);  // held by six springs
  k.kept.follow({0}, DenseMatrix::Constant(1, 1, -1.0 - k.A.coeff(0, 0)));
  EXPECT_FALSE(k.kept.at_hand());
}

// Each proof takes more than the ones before, as the matrix goes away from its factor: in the end a new one
// pays.
TEST(KeptFactor, IsDueWhenSolutionsBecomeMany) {
  Kept k(12);
  const double lowest = held_lattice_eigenvalues(12, 12, 12).front();
  SparseMatrix A = k.A;
  int proofs = 0;
  for (; proofs < 200 && !k.kept.is_due(); ++proofs) {
    EXPECT_TRUE(k.kept.shows_definite(A));
    A.diagonal().array() -= 0.01 * std::max(0.0, 0.9 - 0.01 * proofs) * lowest;
    for (int repeat = 0; repeat < proofs; ++repeat) k.kept.solve(A, Vector::Ones(A.rows()), 1e-10);
  }
  EXPECT_GT(proofs, 1);
  EXPECT_LT(proofs, 200);
  k.kept.begin(A);
  EXPECT_FALSE(k.kept.is_due());
}

}  // namespace
}  // namespace vbond::kept_factor_test
