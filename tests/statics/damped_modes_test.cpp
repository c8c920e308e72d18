// DA3: a body with damped bonds, let go in a damped mode, decays and swings as the eigenvalue of
// (s^2 M + s C + K) x = 0 says. The matrices are put together here, bond by bond.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "decompositions.hpp"
#include "material_cases.hpp"
#include "statics/bodies.hpp"

namespace vbond {
namespace {

using testing::material_case;
using testing::Specimen;
using Complex = std::complex<double>;
using Eigen::MatrixXcd, Eigen::MatrixXd, Eigen::VectorXcd;

/// The chain of DA3 in its plane: heights of the inner particles, then turns of all.
struct PlaneChain {
  std::size_t N;
  double m, Theta, a;
  std::array<double, 4> c, g;

  Eigen::Index size() const { return static_cast<Eigen::Index>(2 * N - 2); }
  /// The place of a height or a turn; -1: held.
  Eigen::Index height(std::size_t p) const {
    return p == 0 || p + 1 == N ? -1 : static_cast<Eigen::Index>(p - 1);
  }
  Eigen::Index turn(std::size_t p) const { return static_cast<Eigen::Index>(N - 2 + p); }
  MatrixXd masses() const {
    MatrixXd M = MatrixXd::Zero(size(), size());
    for (std::size_t p = 0; p < N; ++p) {
      if (height(p) >= 0) M(height(p), height(p)) = m;
      M(turn(p), turn(p)) = Theta;
    }
    return M;
  }
  /// Shear (1) works on y_j - y_i - a (t_i + t_j)/2, bending (2) on t_j - t_i: the same for both matrices.
  MatrixXd matrix(const std::array<double, 4>& of) const {
    MatrixXd K = MatrixXd::Zero(size(), size());
    for (std::size_t p = 0; p + 1 < N; ++p) {
      const std::array<Eigen::Index, 4> at{height(p), turn(p), height(p + 1), turn(p + 1)};
      const std::array<double, 4> shear{-1, -a / 2, 1, -a / 2}, bend{0, -1, 0, 1};
      for (std::size_t x = 0; x < 4; ++x)
        for (std::size_t y = 0; y < 4; ++y)
          if (at[x] >= 0 && at[y] >= 0)
            K(at[x], at[y]) += of[1] * shear[x] * shear[y] + of[2] * bend[x] * bend[y];
    }
    return K;
  }
  /// (x, x')' = A (x, x').
  MatrixXd first_order() const {
    const MatrixXd m = masses();
    MatrixXd A = MatrixXd::Zero(2 * size(), 2 * size());
    A.topRightCorner(size(), size()).setIdentity();
    A.bottomLeftCorner(size(), size()) = -testing::solved(m, matrix(c));
    A.bottomRightCorner(size(), size()) = -testing::solved(m, matrix(g));
    return A;
  }
};

PlaneChain chain_of(const nlohmann::json& setup) {
  return {setup["N"],
          setup["m"],
          setup["Th"],
          setup["a"],
          setup["c"].get<std::array<double, 4>>(),
          setup["g"].get<std::array<double, 4>>()};
}

/// A mode: its eigenvalue, its vector of x and x', and the row that takes its part out of any motion.
struct DampedMode {
  Complex s;
  VectorXcd motion;
  Eigen::RowVectorXcd part;
};

/// Those that swing with Im s > 0, the slowest first.
std::vector<DampedMode> damped_modes(const PlaneChain& chain) {
  const auto [values, X, inverse] = testing::diagonalised(chain.first_order());
  std::vector<DampedMode> modes;
  for (Eigen::Index k = 0; k < X.cols(); ++k)
    if (values[k].imag() > 0.0) modes.push_back({values[k], X.col(k), inverse.row(k)});
  std::sort(modes.begin(), modes.end(),
            [](const DampedMode& a, const DampedMode& b) { return a.s.imag() < b.s.imag(); });
  return modes;
}

TEST(DampedModes, OfThePinnedChainAreThoseOfTheReference) {
  const nlohmann::json c = material_case("DA3");
  const std::vector<DampedMode> modes = damped_modes(chain_of(c["setup"]));
  const auto expected = c["expected"]["eigenvalues_re_im"];
  ASSERT_GE(modes.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(modes[k].s.real(), expected[k][0].get<double>(), 1e-9);
    EXPECT_NEAR(modes[k].s.imag(), expected[k][1].get<double>(), 1e-9);
  }
}

/// The chain in space, in this mode with a small amplitude.
Specimen swinging(const PlaneChain& chain, const DampedMode& mode) {
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{chain.c[0], chain.c[1], chain.c[2], chain.c[3]};
  recipe.damping = {DampingBy::coefficients, chain.g};
  Specimen s = testing::straight_rod(chain.N, recipe);
  s.model.inertia.assign(chain.N, chain.Theta);
  const Eigen::VectorXd motion = 1e-7 * mode.motion.real() / mode.motion.cwiseAbs().maxCoeff();
  for (const ParticleId p : s.state.r.ids()) {
    if (const Eigen::Index k = chain.height(p.value); k >= 0) {
      s.state.r[p].y = motion[k];
      s.state.v[p].y = motion[chain.size() + k];
    }
    const Eigen::Index k = chain.turn(p.value);
    s.state.q[p] = rotation_of({0, 0, motion[k]});
    s.state.omega[p].z = motion[chain.size() + k];
  }
  return s;
}

/// How much of the mode is in this state.
Complex part_of(const PlaneChain& chain, const DampedMode& mode, const State& s) {
  Eigen::VectorXd motion(2 * chain.size());
  for (const ParticleId p : s.r.ids()) {
    if (const Eigen::Index k = chain.height(p.value); k >= 0)
      motion[k] = s.r[p].y, motion[chain.size() + k] = s.v[p].y;
    const Eigen::Index k = chain.turn(p.value);
    motion[k] = rotation_vector(s.q[p]).z, motion[chain.size() + k] = s.omega[p].z;
  }
  return (mode.part * motion)(0);
}

/// The exponent with which the mode goes on, from a fifth of a swing.
Complex measured(const PlaneChain& chain, const DampedMode& mode, double dt) {
  const Specimen s = swinging(chain, mode);
  Stage stage = testing::plain_stage(dt, 1e9);
  stage.supports = {testing::held({ParticleId{0}, ParticleId{chain.N - 1}}, testing::translations)};
  Simulation run(s.model, stage, s.state);
  const Complex before = part_of(chain, mode, run.state());
  const auto steps = static_cast<int>(2 * M_PI / 5 / mode.s.imag() / dt);
  for (int k = 0; k < steps; ++k) run.step();
  return std::log(part_of(chain, mode, run.state()) / before) / (steps * dt);
}

// Loads of damping take the rates of half a step before: an error of the first order in the step, which
// halves with it.
TEST(DampedModes, DecayInMotionAsTheirEigenvaluesSay) {
  const PlaneChain chain = chain_of(material_case("DA3")["setup"]);
  const std::vector<DampedMode> modes = damped_modes(chain);
  for (std::size_t k = 0; k < 4; ++k) {
    const Complex s = modes[k].s, coarse = measured(chain, modes[k], 0.04),
                  fine = measured(chain, modes[k], 0.02);
    EXPECT_NEAR(fine.real() / s.real(), 1.0, 1e-3) << "mode " << k + 1;
    EXPECT_NEAR(fine.imag() / s.imag(), 1.0, 1e-3) << "mode " << k + 1;
    EXPECT_LT(std::abs(fine - s), 0.6 * std::abs(coarse - s) + 1e-7 * std::abs(s)) << "mode " << k + 1;
  }
}

}  // namespace
}  // namespace vbond
