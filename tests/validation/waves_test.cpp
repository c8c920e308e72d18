// Validation cases D1, D3, D4: waves in a chain of the paper's bonds and what leap-frog does to them.
#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "dynamics/rods.hpp"
#include "swings.hpp"

namespace vbond {
namespace {

using testing::leap_frog_frequency;
using testing::number;
using testing::validation_case;

constexpr std::size_t bonds = 32;  // mode q of a chain of 32 bonds is wave q of the table's ring of 64

/// The paper's rod, 33 particles, with these supports at both ends.
struct Chain {
  testing::Specimen specimen = testing::straight_rod(bonds + 1);
  Stage stage;
  explicit Chain(double dt, HeldDofs ends) : stage(testing::plain_stage(dt, 1e99)) {
    stage.supports = {testing::held({ParticleId{0}, ParticleId{bonds}}, ends)};
  }
};

double phase(int q, ParticleId p) {
  return M_PI * q * p.value / bonds;
}

/// The share of mode sin(phase) in `value` of all particles, relative to `amplitude`.
template <class Value>
double share(int q, double amplitude, const State& s, Value value) {
  double sum = 0.0;
  for (const ParticleId p : s.r.ids()) sum += std::sin(phase(q, p)) * value(p);
  return sum / (0.5 * bonds * amplitude);
}

/// q in 1 .. 16 of the table's rows 2 pi q / 64. The shortest wave, q = 32, has its nodes at the particles of
/// a supported chain and needs a closed one.
template <class Check>
void for_each_wave(Check check) {
  for (const auto& row :
       validation_case("D1")
           .at("expected")
           .at("paper rod parameters (m=a=cA=1, cB=.0025, cD=.03, cT=1/480, Theta=.064), ring of 64"))
    for (const int q : {1, 2, 4, 8, 16})
      if (row.at("k") == "2pi*" + std::to_string(q) + "/64") check(q, row);
}

// The axial law is linear, so the amplitude is free. Left over: rounding of positions, 7e-15 of 1e-2, some
// 1e-12, at a crossing whose phase is 20 and more.
TEST(Dispersion, OfAxialWavesIsThatOfTheChain) {
  int checked = 0;
  for_each_wave([&](int q, const auto& row) {
    Chain c(0.5, testing::clamped);
    const double u = 1e-2;
    for (const ParticleId p : c.specimen.state.r.ids()) c.specimen.state.r[p].x += u * std::sin(phase(q, p));
    Simulation run(c.specimen.model, c.stage, c.specimen.state);
    const double found = testing::frequency_of_mode(
        run, [&](const State& s) { return share(q, u, s, [&](ParticleId p) { return s.r[p].x - p.value; }); },
        10);
    EXPECT_NEAR(found / leap_frog_frequency(number(row.at("omega_axial")), 0.5), 1.0, 1e-12) << "q = " << q;
    ++checked;
  });
  EXPECT_EQ(checked, 5);
}

// Torsion is linear up to (2/3) phi^2 = 1e-12.
TEST(Dispersion, OfTorsionalWavesIsThatOfTheChain) {
  int checked = 0;
  for_each_wave([&](int q, const auto& row) {
    Chain c(0.9, testing::clamped);
    const double turn = 1e-6;
    for (const ParticleId p : c.specimen.state.r.ids())
      c.specimen.state.q[p] = rotation_of({turn * std::sin(phase(q, p)), 0, 0});
    Simulation run(c.specimen.model, c.stage, c.specimen.state);
    const double found = testing::frequency_of_mode(
        run, [&](const State& s) { return share(q, turn, s, [&](ParticleId p) { return 2.0 * s.q[p].x; }); },
        10);
    EXPECT_NEAR(found / leap_frog_frequency(number(row.at("omega_torsion")), 0.9), 1.0, 1e-11) << "q = " << q;
    ++checked;
  });
  EXPECT_EQ(checked, 5);
}

/// Frequency of wave q of bending, started in the shape that frequency `omega` has: deflection w sin(kx) and
/// turn phi cos(kx), where (4 c_D s^2 - m omega^2) w = 2 c_D a s c phi.
double bending_frequency(int q, double omega, double dt) {
  const double c_D = 0.03, k = M_PI * q / bonds, s = std::sin(k / 2), c = std::cos(k / 2);
  const double phi_per_w = (4 * c_D * s * s - omega * omega) / (2 * c_D * s * c);
  const double w = 1e-6 / std::max(1.0, std::abs(phi_per_w));
  Chain chain(dt, testing::translations);
  // A ring's wave has its nodes there: the end particle is shared with the mirror image of the chain.
  for (const std::size_t end : {std::size_t{0}, bonds}) chain.specimen.model.inertia[ParticleId{end}] /= 2;
  for (const ParticleId p : chain.specimen.state.r.ids()) {
    chain.specimen.state.r[p].y = w * std::sin(phase(q, p));
    chain.specimen.state.q[p] = rotation_of({0, 0, phi_per_w * w * std::cos(phase(q, p))});
  }
  Simulation run(chain.specimen.model, chain.stage, chain.specimen.state);
  return testing::frequency_of_mode(
      run, [&](const State& x) { return share(q, w, x, [&](ParticleId p) { return x.r[p].y; }); }, 3);
}

// Stretching between fixed ends stiffens bending by c_A w^2 / (4 c_B) = 1e-10 relative.
TEST(Dispersion, OfBendingWavesIsThatOfTheChainOnBothBranches) {
  int checked = 0;
  for_each_wave([&](int q, const auto& row) {
    const double slow = number(row.at("omega_flex_acoustic")), fast = number(row.at("omega_flex_optical"));
    EXPECT_NEAR(bending_frequency(q, slow, 0.9) / leap_frog_frequency(slow, 0.9), 1.0, 1e-9) << "q = " << q;
    EXPECT_NEAR(bending_frequency(q, fast, 0.9) / leap_frog_frequency(fast, 0.9), 1.0, 1e-9) << "q = " << q;
    ++checked;
  });
  EXPECT_EQ(checked, 5);
}

// D4: two free particles that swing along their bond, omega = sqrt(2); a step that is half the critical one
// shifts the frequency by 5 %, to the last digit as the closed form says.
TEST(LeapFrog, ShiftsAFrequencyByTheClosedForm) {
  const double omega = std::sqrt(2.0), u = 1e-2;
  for (const auto& [label, expected] : validation_case("D4").at("expected").at("table").items()) {
    const double omega_dt = std::stod(label.substr(label.find('=') + 1));
    testing::Specimen s = testing::straight_rod(2);
    s.state.r = {{-u, 0, 0}, {1 + u, 0, 0}};
    Simulation run(s.model, testing::plain_stage(omega_dt / omega, 1e99), s.state);
    const double found = testing::frequency_of_mode(
        run, [&](const State& x) { return (x.r[ParticleId{1}].x - x.r[ParticleId{0}].x - 1.0) / (2 * u); },
        20);
    EXPECT_NEAR(found / omega / number(expected), 1.0, 1e-12) << label;
  }
}

/// Runs an impulse on the middle of a long chain and compares `value` of particle n at the table's times
/// times `slow_down`. Leap-frog lets a wave of frequency w <= 2 (in the table's time) run ahead by
/// w^3 dt^2 t / 24 < t dt^2 / 3, and a velocity of 1 changes by at most twice that.
template <class Start, class Value>
void expect_bessel(Start start, Value value, double slow_down) {
  constexpr std::size_t half = 40;  // the front needs t = 40 to the end: at t <= 20 the chain is endless
  const double dt = 0.005;
  testing::Specimen s = testing::straight_rod(2 * half + 1);
  start(s.state, ParticleId{half});
  Simulation run(s.model, testing::plain_stage(dt * slow_down, 1e99), s.state);
  for (const double t : {1.0, 5.0, 10.0, 20.0}) {
    while (static_cast<double>(run.state().clock.step) * dt < t - 0.5 * dt) run.step();
    int checked = 0;
    for (const auto& row : validation_case("D3").at("expected").at("table")) {
      if (number(row.at("t")) != t) continue;
      const int n = row.at("n");
      for (const int side : {-1, 1})
        EXPECT_NEAR(value(run.state(), ParticleId{static_cast<std::size_t>(40 + side * n)}),
                    number(row.at("v")), 2.0 / 3.0 * t * dt * dt)
            << "n = " << n << ", t = " << t;
      ++checked;
    }
    EXPECT_EQ(checked, 4);
  }
}

// D3, Schroedinger 1914: v_n(t) = J_2n(2t).
TEST(Impulse, SpreadsAlongTheChainAsBesselFunctions) {
  const double v = 1e-3;
  expect_bessel(
      [&](State& s, ParticleId p) {
        s.v[p] = {v, 0, 0};
      },
      [&](const State& s, ParticleId p) { return s.v[p].x / v; }, 1.0);
}

TEST(Impulse, OfSpinSpreadsAlongTheChainAsBesselFunctions) {
  const double spin = 1e-6, Theta = 0.064, c_T = 1.0 / 480.0;
  expect_bessel(
      [&](State& s, ParticleId p) {
        s.omega[p] = {spin, 0, 0};
      },
      [&](const State& s, ParticleId p) { return s.omega[p].x / spin; }, std::sqrt(Theta / c_T));
}

}  // namespace
}  // namespace vbond
