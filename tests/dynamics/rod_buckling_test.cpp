// The paper's quasi-static buckling of a rod, [KA12] section VI A, with the step of 0.1 T0 for speed: dt
// between 0.002 and 0.1 T0 was found to give the same peak to 1e-5.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "rods.hpp"

namespace vbond {
namespace {

double critical_force(unsigned seed) {
  testing::Specimen s = testing::straight_rod(10);
  const double T_0 = s.model.T_0, v_0 = 1e-6;
  testing::Dice dice(seed);
  for (Vec3d& v : s.state.v) do
      v = {0, dice(-v_0, v_0), dice(-v_0, v_0)};
    while (norm(v) > v_0);
  Stage stage = testing::plain_stage(0.1 * T_0, 40000 * T_0);
  const auto& all = s.model.groups[0].particles;
  stage.supports = {testing::held({ParticleId{0}, ParticleId{9}}, testing::translations)};
  stage.strain = StrainProgram{all, {1, 0, 0}, {4.5, 0, 0}, -1e-7, 10 * T_0};
  stage.stops.peak = PeakStop{PeakQuantity::compressive_force, all, {}, 0.015, 10 * T_0};
  Simulation run(s.model, stage, s.state);
  EXPECT_EQ(run.run(), StopReason::peak);
  EXPECT_LT(std::abs(run.balance_error()), 1e-3);
  return run.state().peak.peak;
}

// Reference: 100 seeds of an independent computation gave 3.180e-4 +- 0.010e-4; the exact static value of
// this discrete rod, below which it cannot buckle, is in statics.json. The interval is four standard
// deviations and the 0.5 % by which seeds drawn in another way may differ.
TEST(QuasiStaticRod, BucklesAboveTheExactStaticForceByTheDynamicOvershoot) {
  std::ifstream file(std::string(VBOND_TEST_DATA) + "/statics.json");
  double exact = 0.0;
  const auto statics = nlohmann::json::parse(file);
  for (const auto& rod : statics["rods"])
    if (rod["label"] == "BE N=10 d/a=0.2 nu=0.2") exact = std::stod(rod["f_crit_exact"].get<std::string>());
  ASSERT_NEAR(exact, 3.078e-4, 1e-7);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const double f = critical_force(seed);
    RecordProperty("seed_" + std::to_string(seed), std::to_string(f));
    std::printf("seed %u: critical force %.4e\n", seed, f);
    EXPECT_GT(f, 3.14e-4) << "seed " << seed;
    EXPECT_LT(f, 3.24e-4) << "seed " << seed;
    EXPECT_GT(f, exact) << "seed " << seed;
  }
}

}  // namespace
}  // namespace vbond
