// Particles whose moments of inertia differ, one at a time: validation cases RB1, RB2 and D8, a campaign.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "dynamics/tops.hpp"
#include "material_cases.hpp"
#include "vbond/model/energies.hpp"

namespace vbond::free_top_test {
namespace {

using testing::after;
using testing::apart;
using testing::body_rates;
using testing::Dice;
using testing::free_top;
using testing::plain_stage;
using testing::spin;

const ParticleId one{0};

Vec3d vector(const nlohmann::json& j) {
  return {j[0], j[1], j[2]};
}
Quatd quat(const nlohmann::json& j) {
  return {j[0], j[1], j[2], j[3]};
}

testing::Specimen asymmetric_top() {
  const auto setup = testing::material_case("RB1").at("setup");
  return free_top({vector(setup.at("I_body")), {}}, {}, vector(setup.at("w_body")));
}

// RB1: errors of second order. L stays what it is, to the last bit.
TEST(FreeTop, HasTheStatesOfJacobisFunctionsToSecondOrder) {
  const auto expected = testing::material_case("RB1").at("expected");
  const testing::Specimen s = asymmetric_top();
  for (const auto& state : expected.at("states")) {
    const double t = state.at("t");
    std::array<double, 2> of_q{}, of_rates{};
    for (const std::size_t k : {0u, 1u}) {
      const State end = after(s, k == 0 ? 2e-3 : 1e-3, t);
      of_q[k] = apart(end.q[one], quat(state.at("q_wxyz")));
      of_rates[k] = norm(body_rates(s.model, end) - vector(state.at("body_rates")));
      EXPECT_LT(norm(spin(s.model, end) - vector(expected.at("L_space"))), 1e-14) << t;
      EXPECT_EQ(end.spin[one], spin(s.model, s.state)) << t;
      EXPECT_NEAR(kinetic_energy(s.model, end), expected.at("energy").get<double>(), 1e-5);
    }
    EXPECT_LT(of_q[1], 2e-5) << t;
    EXPECT_NEAR(of_q[0] / of_q[1], 4.0, 0.02) << t;
    EXPECT_NEAR(of_rates[0] / of_rates[1], 4.0, 0.02) << t;
  }
}

/// Time between the first and the last of four changes of sign of the body's omega_y, over three.
double time_between_flips(const testing::Specimen& s, double dt) {
  Simulation run(s.model, plain_stage(dt, 1e9), s.state);
  double first = 0.0, last = 0.0;
  for (int flips = 0; flips < 4;) {
    const double before = body_rates(s.model, run.state()).y;
    run.step();
    const double now = body_rates(s.model, run.state()).y;
    if ((before > 0.0) == (now > 0.0)) continue;
    last = run.clock().time() - dt * now / (now - before);
    if (++flips == 1) first = last;
  }
  return (last - first) / 3.0;
}

TEST(FreeTop, FlipsInTheTimeOfDzhanibekovsTop) {
  const double T = testing::material_case("RB1").at("expected").at("time_between_flips");
  EXPECT_NEAR(time_between_flips(asymmetric_top(), 2e-3) / T, 1.0, 1e-6);
}

// D8 as one particle: the period of the seven bonded ones, 41.881206192397.
TEST(FreeTop, OfTheBondedTopsInertiaHasItsPeriod) {
  const testing::Specimen s = free_top({{0.97, 2.25, 2.79}, {}}, {}, {0.02, 1, 0.01});
  EXPECT_NEAR(2 * time_between_flips(s, 2e-3) / 41.881206192397, 1.0, 1e-6);
}

TEST(FreeTop, SymmetricPrecessesAboutItsAngularMomentum) {
  const auto expected = testing::material_case("RB2").at("expected");
  const testing::Specimen s = free_top({{1, 1, 2}, {}}, {}, {0.3, 0, 1});
  std::array<double, 2> error{};
  for (const std::size_t k : {0u, 1u}) {
    const State end = after(s, k == 0 ? 2e-3 : 1e-3, 7.0);
    error[k] = norm(rotate(end.q[one], Vec3d{0, 0, 1}) - vector(expected.at("axis_at_t7")));
    EXPECT_LT(norm(spin(s.model, end) - vector(expected.at("L"))), 1e-14);
  }
  EXPECT_LT(error[1], 1e-6);
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.05);
}

// The sequence of turns is the same backwards; 2000 steps of rounding.
TEST(FreeTop, ComesBackWhenItsSpinIsReversed) {
  const testing::Specimen s = asymmetric_top();
  testing::Specimen back = s;
  back.state = after(s, 0.05, 50.0);
  back.state.clock = {};
  back.state.omega[one] = -back.state.omega[one];
  const State end = after(back, 0.05, 50.0);
  EXPECT_LT(apart(end.q[one], s.state.q[one]), 1e-10);
  EXPECT_LT(norm(end.omega[one] + s.state.omega[one]), 1e-10);
}

/// The rotation of a body by Euler's equations under a moment that is constant in space: L = L_0 + M t, and
/// q' = omega q / 2, by Runge and Kutta's fourth order with steps that make its error rounding.
struct Euler {
  Vec3d moments, L_0, M;
  Quatd q;

  Quatd rate(const Quatd& at, double t) const {
    const Vec3d L_body = rotate(conjugate(at), L_0 + t * M);
    const Vec3d w{L_body.x / moments.x, L_body.y / moments.y, L_body.z / moments.z};
    return at * Quatd{0.0, 0.5 * w.x, 0.5 * w.y, 0.5 * w.z};
  }
  static Quatd plus(const Quatd& a, double h, const Quatd& b) {
    return {a.w + h * b.w, a.x + h * b.x, a.y + h * b.y, a.z + h * b.z};
  }
  Quatd at(double end) const {
    const int steps = 20000;
    const double h = end / steps;
    Quatd p = q;
    for (int k = 0; k < steps; ++k) {
      const double t = k * h;
      const Quatd k1 = rate(p, t), k2 = rate(plus(p, h / 2, k1), t + h / 2),
                  k3 = rate(plus(p, h / 2, k2), t + h / 2), k4 = rate(plus(p, h, k3), t + h);
      p = normalised(plus(plus(plus(plus(p, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4));
    }
    return p;
  }
};

// 200 tops with random moments, axes, orientation, spin and constant moment against Euler's equations, over 2
// to 20 radians. The error falls by 4 with the step, and is below (omega dt)^2 per radian.
TEST(RandomTops, MoveAsEulersEquationsSay) {
  Dice dice(16);
  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    const PrincipalInertia inertia{testing::drawn_moments(dice), rotation_of(dice.vector(2.0))};
    testing::Specimen s =
        free_top(inertia, rotation_of(dice.vector(2.0)), dice.vector(k % 2 == 0 ? 1.0 : 3.0));
    const Vec3d M = k % 4 < 2 ? Vec3d{} : dice.vector(0.5);
    const double end = 4.0;
    const Euler euler{inertia.moments, spin(s.model, s.state), M,
                      testing::principal_axes(s.model, s.state, one)};
    const Quatd expected = euler.at(end);
    std::array<double, 2> error{};
    double fastest = 0.0;
    for (const std::size_t n : {0u, 1u}) {
      Stage stage = plain_stage(n == 0 ? 0.004 : 0.002, end);
      PointLoad load;
      load.particles = {one};
      load.moment = M;
      stage.loads = {load};
      Simulation run(s.model, stage, s.state);
      run.run();
      error[n] = apart(testing::principal_axes(s.model, run.state(), one), expected);
      fastest = std::max({fastest, norm(s.state.omega[one]), norm(run.state().omega[one])});
      EXPECT_LT(norm(spin(s.model, run.state()) - euler.L_0 - end * M), 1e-11) << k;  // 4000 roundings of 10
      if (M == Vec3d{}) {
        EXPECT_EQ(run.state().spin[one], euler.L_0) << k;
      }
    }
    worst = std::max(worst, error[1] / (sq(fastest * 0.002) * fastest * end));
    EXPECT_LT(error[1], 2.0 * sq(fastest * 0.002) * fastest * end) << k;
    EXPECT_NEAR(error[0] / error[1], 4.0, 0.2) << k;
  }
  RecordProperty("worst_error_over_bound", std::to_string(worst));
}

}  // namespace
}  // namespace vbond::free_top_test
