// The largest stable step of leap-frog: reference values, and runs just below and just above it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bodies.hpp"
#include "validation/cases.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond {
namespace {

double reference(const char* name) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/statics.json");
  return nlohmann::json::parse(file).at("stability_limits").at(name);
}

std::vector<Support> pinned_ends() {
  return {testing::held({ParticleId{0}, ParticleId{9}}, testing::translations)};
}

TEST(ExactCriticalStep, OfThePapersRodIsTheReference) {
  const testing::Specimen s = testing::straight_rod(10);
  EXPECT_NEAR(exact_critical_step(s.model, s.state, {}) / s.model.T_0 / reference("rod_free_dt_over_T0"), 1.0,
              1e-10);
  EXPECT_NEAR(
      exact_critical_step(s.model, s.state, pinned_ends()) / s.model.T_0 / reference("rod_pinned_dt_over_T0"),
      1.0, 1e-10);
}

TEST(ExactCriticalStep, IsAboveTheElementBound) {
  const testing::Specimen s = testing::straight_rod(10);
  const double bound = step_bound(s.model, s.state).dt, exact = exact_critical_step(s.model, s.state, {});
  EXPECT_GT(exact, bound);
  EXPECT_LT(exact, 1.02 * bound);  // some per cent, see step_bound
}

TEST(ExactCriticalStep, IsInfiniteWhereNothingSwings) {
  const testing::Specimen loose = testing::particles_at({{0, 0, 0}, {5, 0, 0}});
  EXPECT_TRUE(std::isinf(exact_critical_step(loose.model, loose.state, {})));
  const testing::Specimen s = testing::straight_rod(2);
  EXPECT_TRUE(std::isinf(exact_critical_step(
      s.model, s.state, {testing::held({ParticleId{0}, ParticleId{1}}, testing::clamped)})));
}

// Two particles that touch: omega^2 = 2 k_c / m.
TEST(ExactCriticalStep, CountsPresentContacts) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0.75, 0, 0}});
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::all, 1.0, 1.0, 0, 0};
  const double k_c = contact_stiffness(paper_hertz(1.0, 1.0), 0.05);
  EXPECT_NEAR(exact_critical_step(s.model, s.state, {}), 2 / std::sqrt(2 * k_c), 1e-9);
}

/// The largest displacement, after 400 steps, of a rod struck at random, over that which the blow causes in a
/// quarter period of its fastest mode.
double growth(double share, const std::vector<Support>& supports) {
  testing::Specimen s = testing::straight_rod(10);
  testing::Dice dice(1);
  const double speed = 1e-12;
  for (const ParticleId p : s.state.v.ids())
    for (int k = 0; k < 3; ++k) {
      component(s.state.v[p], k) = dice(-speed, speed);
      component(s.state.omega[p], k) = dice(-speed, speed);
    }
  Stage stage = testing::plain_stage(share * exact_critical_step(s.model, s.state, supports), 1e99);
  stage.supports = supports;
  Simulation run(s.model, stage, s.state);
  for (int n = 0; n < 400; ++n) run.step();
  double largest = 0.0;
  for (const ParticleId p : s.state.r.ids())  // along the rod: its fastest mode is axial
    largest = std::max(largest, std::abs(run.state().r[p].x - p.value - run.state().r[ParticleId{0}].x));
  return largest / speed;
}

// Above, the fastest mode grows by acosh(2 * 1.001^2 - 1) = 0.0894 a step, exp(36) = 3e15 in 400 steps, until
// bonds turn over. Below, by 1 / sqrt(1 - 0.999^2) = 22 in all, and so by less than 10 modes with 22 each.
TEST(ExactCriticalStep, IsWhereLeapFrogBlowsUp) {
  for (const std::vector<Support>& supports : {std::vector<Support>{}, pinned_ends()}) {
    EXPECT_LT(growth(0.999, supports), 1e3);
    EXPECT_GT(growth(1.001, supports), 1e8);
  }
}

}  // namespace
}  // namespace vbond
