#include "vbond/statics/detail/single_factor.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "statics/matrices.hpp"
#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/detail/single_kernel.hpp"

namespace vbond::single_factor_test {
namespace {

/// A lattice large enough that its factor has blocks.
struct Rounded {
  SparseMatrix A = lattice(12, 12, 12, true);
  Factor factor;
  SingleFactor single;
  Rounded() {
    factor.analyse(A);
    EXPECT_TRUE(factor.factor_definite(A));
    EXPECT_TRUE(factor.copy_to(single));
  }
};

// With the matrix M of the rounded factor M x = b, so that A x - b = (A - M) x, of which each entry is
// bounded. Sums in double precision leave far less. That it is rounded at all shows, too.
void expect_solved_within_the_bound(const SparseMatrix& A, const Vector& x, const Vector& b) {
  const Vector root = A.diagonal().cwiseSqrt(), left = A * x - b;
  const double sum = root.dot(x.cwiseAbs());
  for (Eigen::Index k = 0; k < left.size(); ++k)
    EXPECT_LE(std::abs(left[k]), SingleFactor::difference() * root[k] * sum) << k;
  EXPECT_GT(left.norm(), 1e-10 * b.norm());
}

TEST(SingleFactor, SolvesWithAMatrixThatIsOffByItsBound) {
  const Rounded r;
  EXPECT_EQ(r.single.branches(), 0u);
  const Vector b = random_vector(static_cast<int>(r.A.rows()), 3);
  expect_solved_within_the_bound(r.A, r.single.solve(b), b);
}

TEST(SingleFactor, SolvesItsBranchesToTheSameBitsWithAnyNumberOfThreads) {
  std::mt19937 random(1);
  const SparseMatrix A =
      lattice(80, 14, 14, true, [&random] { return 1.0 + static_cast<double>(random()) * 0x1p-32; });
  Factor factor;
  factor.analyse(A);
  ASSERT_TRUE(factor.factor_definite(A));
  DenseMatrix B(A.rows(), 6), first;
  for (int k = 0; k < 6; ++k) B.col(k) = random_vector(static_cast<int>(A.rows()), 20 + k);
  B.col(5).head(A.rows() / 2).setZero();  // whole branches may have nothing
  for (const std::size_t threads : {1u, 2u, 3u, 16u}) {
    SingleFactor single(std::make_shared<Crew>(threads));
    ASSERT_TRUE(factor.copy_to(single));
    EXPECT_GE(single.branches(), 4u);
    for (int again = 0; again < 3; ++again) {
      const DenseMatrix X = single.solve(B);
      if (first.size() == 0) first = X;
      EXPECT_EQ(X, first) << threads;
    }
  }
  for (const int k : {0, 5}) expect_solved_within_the_bound(A, first.col(k), B.col(k));
}

// M is symmetric to the rounding of double precision, not of single: u^T M^-1 v = v^T M^-1 u.
TEST(SingleFactor, IsSymmetric) {
  const Rounded r;
  const Vector u = random_vector(static_cast<int>(r.A.rows()), 4),
               v = random_vector(static_cast<int>(r.A.rows()), 5);
  const Vector x = r.single.solve(u), y = r.single.solve(v);
  EXPECT_NEAR(x.dot(v), y.dot(u), 1e-13 * x.norm() * v.norm());
}

TEST(SingleFactor, SolvesEachColumnAsThatAlone) {
  const Rounded r;
  DenseMatrix B(r.A.rows(), 7);
  for (int k = 0; k < 7; ++k) B.col(k) = random_vector(static_cast<int>(r.A.rows()), 10 + k);
  const DenseMatrix X = r.single.solve(B);
  for (int k = 0; k < 7; ++k) EXPECT_EQ(X.col(k), r.single.solve(B.col(k)).col(0)) << k;
}

TEST(SingleFactor, IsOfFactorsInBlocksOnly) {
  const SparseMatrix A = lattice(3, 1, 1, true);
  Factor factor;
  factor.analyse(A);
  SingleFactor single;
  EXPECT_FALSE(factor.copy_to(single)) << "not factored yet";
  ASSERT_TRUE(factor.factor_definite(A));
  EXPECT_FALSE(factor.copy_to(single)) << "a chain";
}

/// Both steps of a strip that begins with ones on its diagonal, by one kernel.
std::vector<double> stepped(const SingleKernel& kernel, int width, int sides, int height) {
  std::mt19937 random(1);
  const auto number = [&random] { return static_cast<float>(random()) * 0x1p-32F - 0.3F; };
  std::vector<float> corner(widest_strip * widest_strip, 0.0F),
      below(static_cast<std::size_t>(width * filled_up(height)), 0.0F);
  for (int j = 0; j < width; ++j) {
    for (int i = j; i < width; ++i) corner[static_cast<std::size_t>(widest_strip * j + i)] = number();
    corner[static_cast<std::size_t>(widest_strip * j + j)] += 1.0F;
    for (int i = 0; i < height; ++i) below[static_cast<std::size_t>(j * filled_up(height) + i)] = number();
  }
  const int stride = width + filled_up(height);
  std::vector<double> x(static_cast<std::size_t>(sides * stride), 0.0);
  for (int s = 0; s < sides; ++s)
    for (int i = 0; i < width + height; ++i)
      x[static_cast<std::size_t>(s * stride + i)] = static_cast<double>(number()) / 3.0;
  const StripOfFactor strip{corner.data(), below.data(), height, nullptr};
  std::vector<double> y = x;
  kernel.forward[width - 1][sides - 1](strip, x.data(), stride);
  kernel.backward[width - 1][sides - 1](strip, y.data(), stride);
  x.insert(x.end(), y.begin(), y.end());
  return x;
}

TEST(SingleKernel, HasTheSameBitsWithEachInstructionSet) {
  for (int number = 1; single_kernel(number) != nullptr; ++number)
    for (int width = 1; width <= widest_strip; ++width)
      for (int sides = 1; sides <= most_sides; ++sides)
        for (const int height : {0, 1, 7, 8, 29}) {
          const std::vector<double> x = stepped(*single_kernel(0), width, sides, height),
                                    y = stepped(*single_kernel(number), width, sides, height);
          EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(double)), 0)
              << number << ": " << width << ", " << sides << ", " << height;
        }
}

}  // namespace
}  // namespace vbond::single_factor_test
