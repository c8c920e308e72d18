// The fastest swing that a stage prescribes.
#include "vbond/model/swing_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace vbond {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

/// Cosine of this period in straight pieces, so many a period, with a noise of this size from piece to piece.
TimeFunction wave(double period, int periods, int pieces, double noise = 0.0) {
  TimeFunction f;
  for (int k = 0; k <= periods * pieces; ++k)
    f.points.push_back(
        {period * k / pieces, std::cos(2.0 * M_PI * k / pieces) + (k % 2 == 0 ? noise : -noise)});
  return f;
}

TEST(ShortestPeriod, IsThatOfAWaveWhateverItsPieces) {
  for (const int pieces : {2, 4, 8, 100})
    EXPECT_NEAR(shortest_period(wave(0.7, 5, pieces), endless), 0.7, 1e-12);
}

TEST(ShortestPeriod, OfSeveralIsTheShortest) {
  TimeFunction f = wave(1.0, 4, 8);
  for (TimeFunction::Point p : wave(0.25, 4, 8).points)
    if (p.t > 0.0) f.points.push_back({4.0 + p.t, p.factor});
  EXPECT_NEAR(shortest_period(f, endless), 0.25, 1e-12);
  EXPECT_NEAR(shortest_period(f, 4.0), 1.0, 1e-12);  // what comes after the stage does not count
}

TEST(ShortestPeriod, LeavesNoiseOut) {
  EXPECT_NEAR(shortest_period(wave(1.0, 4, 40, 0.02), endless), 1.0, 2.0 / 40);
  EXPECT_NEAR(shortest_period(wave(1.0, 4, 40, 0.2), endless), 2.0 / 40, 1e-12);  // that is no noise
}

TEST(ShortestPeriod, RampsPulsesAndJumpsHaveNone) {
  const TimeFunction none, constant{{{0, 2}}}, ramp{{{0, 0}, {1e-9, 1}}},
      pulse{{{0, 0}, {1e-9, 1}, {2e-9, 0}}}, there_and_back{{{0, 0}, {1, 1}, {2, -1}, {3, 0}}};
  for (const TimeFunction& f : {none, constant, ramp, pulse, there_and_back})
    EXPECT_EQ(shortest_period(f, endless), endless);
  const TimeFunction square{{{0, 1}, {1, 1}, {1, -1}, {2, -1}, {2, 1}, {3, 1}, {3, -1}, {4, -1}, {4, 1}}};
  EXPECT_DOUBLE_EQ(shortest_period(square, endless), 2.0);
}

TEST(FastestSwing, LooksAtAllThatIsMovedAndNamesIt) {
  Stage stage;
  EXPECT_EQ(fastest_swing(stage).period, endless);
  stage.heating = {{{}, 1.0, wave(64, 4, 8)}};
  EXPECT_EQ(fastest_swing(stage).source, "the factor over time of a temperature");
  stage.cell.component[3] = {CellComponent::By::stress, 0.1, wave(48, 4, 8)};
  EXPECT_EQ(fastest_swing(stage).source, "the factor over time of cell.yz");
  stage.loads = {PointLoad{"end", {}, {}, {}, wave(32, 4, 8)}};
  EXPECT_EQ(fastest_swing(stage).source, "the factor over time of the load on group \"end\"");
  Support support;
  support.group = "grip", support.factor = wave(16, 4, 8);
  stage.supports = {support};
  EXPECT_EQ(fastest_swing(stage).source,
            "the factor over time of the load on group \"end\"");  // it stands still
  stage.supports[0].velocity = {0, 0, 0.1};
  EXPECT_EQ(fastest_swing(stage).source, "the factor over time of the support of group \"grip\"");
  WallDrive lid;
  lid.wall = "lid";
  WallDrive::Servo pressed;
  pressed.factor = wave(8, 4, 8);
  lid.servo = pressed;
  stage.walls = {lid};
  EXPECT_EQ(fastest_swing(stage).source, "the factor over time of the servo of wall \"lid\"");
  stage.walls[0].factor = wave(4, 4, 8);
  EXPECT_EQ(fastest_swing(stage).source, "the factor over time of wall \"lid\"");
  stage.walls[0].frequency = 0.5;
  EXPECT_NEAR(fastest_swing(stage).period, 4.0, 1e-12);  // of no amplitude
  stage.walls[0].amplitude = {0, 0.1, 0};
  EXPECT_EQ(fastest_swing(stage).source, "the oscillation of wall \"lid\"");
  EXPECT_EQ(fastest_swing(stage).period, 2.0);
  EXPECT_EQ(fastest_swing(stage).wanted_step(), 0.1);
  EXPECT_EQ(fastest_swing(stage).longest_step(), 0.2);
}

}  // namespace
}  // namespace vbond
