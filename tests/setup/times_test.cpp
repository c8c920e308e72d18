#include "vbond/setup/times.hpp"

#include <random>

#include "cases.hpp"
#include "vbond/dynamics/simulation.hpp"

namespace vbond::test {
namespace {

TEST(FittingStep, IsTheWantedOneWhereTimesAreWholeNumbersOfIt) {
  EXPECT_EQ(fitting_step(0.1, 1.0), 0.1);  // to the last bit, though 1.0 / 0.1 rounds
  EXPECT_EQ(fitting_step(0.3, 0.9), 0.3);
  const double T_0 = 2.0 * std::numbers::pi;
  EXPECT_EQ(fitting_step(0.01 * T_0, 12345 * (0.01 * T_0)), 0.01 * T_0);
  EXPECT_EQ(fitting_step(0.01, 50.0, 0.25), 0.01);
}

TEST(FittingStep, IsTheLongestBelowOfWhichTheDurationIsAWholeNumber) {
  EXPECT_EQ(fitting_step(0.3, 1.0), 0.25);
  EXPECT_EQ(fitting_step(0.3, 0.8), 0.8 / 3);
  EXPECT_EQ(fitting_step(0.3, 0.31), 0.155);
}

TEST(FittingStep, MeetsTheStrainFirstAndTheDurationIfTheirRatioIsSimple) {
  EXPECT_DOUBLE_EQ(fitting_step(0.3, 1.0, 0.6), 0.2);     // 3 and 5 steps
  EXPECT_DOUBLE_EQ(fitting_step(0.1, 10.0, 0.15), 0.05);  // 3 and 200
  EXPECT_DOUBLE_EQ(fitting_step(0.3, 3.0, 0.5), 0.25);    // the strain alone asks: 2 and 12
  const double every = std::sqrt(2.0);
  EXPECT_EQ(fitting_step(0.3, 1.0, every), every / 5);  // no step meets both
}

TEST(TimesNotMet, NameKeyWantedAndGot) {
  Stage s;
  s.name = "pull";
  s.dt = fitting_step(0.3, 1.0);
  s.stops.duration = 1.0;
  EXPECT_TRUE(times_not_met(s).empty());
  s.strain = StrainProgram{{}, {}, {}, 0.1, std::sqrt(2.0)};
  s.dt = fitting_step(0.3, 1.0, s.strain->every);
  EXPECT_EQ(times_not_met(s),
            std::vector<std::string>{"stage pull: duration = 1 becomes 1.13137, 4 steps of 0.282843"});
}

// What is looked at over a time does not hang on a step more or less, unless it is a large part of it.
TEST(TimesNotMet, LeaveOutAveragesThatAreOffByLessThanAHundredth) {
  Stage s;
  s.name = "pull";
  s.dt = 0.3;
  s.stops.duration = 30.0;
  s.stops.rest = RestStop{1.0, 30.1};
  EXPECT_TRUE(times_not_met(s).empty());
  s.stops.rest->during = 0.5;
  EXPECT_EQ(times_not_met(s),
            std::vector<std::string>{"stage pull: stop.rest.during = 0.5 becomes 0.6, 2 steps of 0.3"});
}

/// What leap-frog makes of a factor: half at both ends.
double sum_over_steps(const TimeFunction& f, double dt, std::int64_t last) {
  double sum = 0.0;
  for (std::int64_t n = 0; n <= last; ++n)
    sum += (n == 0 || n == last ? 0.5 : 1.0) * f(static_cast<double>(n) * dt);
  return sum * dt;
}

TEST(OnSteps, ChangesNothingIfAllBendsAreOnSteps) {
  const TimeFunction ramp{{{0.0, 0.0}, {0.5, 2.0}, {0.9, -1.0}}};
  const TimeFunction same = on_steps(ramp, 0.1, 10);
  ASSERT_EQ(same.points.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(same.points[k].t, ramp.points[k].t);
}

// The sums are the integrals, and no value is outside those of the table.
TEST(OnSteps, KeepsTheIntegralOfRampsJumpsAndPulses) {
  const struct {
    TimeFunction f;
    double integral, low, high;
  } rows[] = {
      {{{{0.0, 0.0}, {0.37, 1.0}}}, 0.5 * 0.37 + 0.63, 0.0, 1.0},                 // a ramp
      {{{{0.0, 1.0}, {0.43, 1.0}, {0.43000001, 0.0}}}, 0.43 + 0.5e-8, 0.0, 1.0},  // a jump between steps
      {{{{0.0, 1.0}, {0.4, 1.0}, {0.40000001, 0.0}}}, 0.4 + 0.5e-8, 0.0, 1.0},    // a jump on a step
      {{{{0.0, 1.0}, {0.39999999, 1.0}, {0.4, 0.0}}}, 0.4 - 0.5e-8, 0.0, 1.0},    // just before one
      {{{{0.0, 0.0}, {1e-9, 1.0}}}, 1.0 - 0.5e-9, 0.0, 1.0},                      // a jump at the start
      {{{{0.0, 1.0}, {1.0, 1.0}, {1.00000001, 0.0}}}, 1.0, 0.0, 1.0},             // a jump at the end
      {{{{0.51, 0.0}, {0.52, 8.0}, {0.56, 0.0}}}, 0.5 * 8.0 * 0.05, 0.0, 8.0},    // a pulse between two steps
      {{{{0.0, 0.0}, {0.33, 1.0}, {2.0, -4.0}}}, 0.0, -4.0, 1.0},                 // goes on after the end
  };
  for (const auto& row : rows) {
    const TimeFunction g = on_steps(row.f, 0.1, 10);
    double expected = row.integral;
    if (row.f.points.back().t == 2.0) {
      const double at_end = 1.0 - 5.0 * 0.67 / 1.67;
      expected = 0.5 * 0.33 + 0.5 * (1.0 + at_end) * 0.67;
    }
    EXPECT_NEAR(sum_over_steps(g, 0.1, 10), expected, 1e-14) << row.f.points[1].t;  // some 20 roundings
    for (int k = 0; k <= 1000; ++k) {
      EXPECT_GE(g(1e-3 * k), row.low - 1e-12);
      EXPECT_LE(g(1e-3 * k), row.high + 1e-12);
    }
  }
}

TEST(OnSteps, KeepsTheIntegralOfAnyTable) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> gap(0.001, 0.4), value(-1.0, 1.0);
  for (int table = 0; table < 200; ++table) {
    TimeFunction f;
    for (double t = gap(random); t < 1.0; t += gap(random)) f.points.push_back({t, value(random)});
    double integral =
        f.points.front().t * f.points.front().factor + (1.0 - f.points.back().t) * f.points.back().factor;
    for (std::size_t k = 1; k < f.points.size(); ++k)
      integral += 0.5 * (f.points[k].factor + f.points[k - 1].factor) * (f.points[k].t - f.points[k - 1].t);
    EXPECT_NEAR(sum_over_steps(on_steps(f, 0.125, 8), 0.125, 8), integral, 1e-14) << "table " << table;
  }
}

// ---- the same in a run
// -------------------------------------------------------------------------------------

Case free_particle(double step, double duration) {
  Case c = case_of(ListedSpecimen{{{0, 0, 0}}});
  c.time.step = Placed<std::variant<CaseTime, ExactStep>>{CaseTime{step, false}, {"case.toml", 50, 1}};
  c.stages[0].duration = {duration, false};
  return c;
}

State after_run(const Case& c) {
  Built b = build(c);
  Stage s = build_stage(c, b.model, 0, b.state);
  Simulation run(b.model, std::move(s), std::move(b.state), 1);
  run.run();
  return std::move(run).handover().state;
}

TEST(Duration, IsMetToTheLastStep) {
  for (const auto& [step, duration, steps] : {std::tuple{0.3, 0.8, 3}, {0.3, 1.0, 4}, {0.3, 0.9, 3}}) {
    const State s = after_run(free_particle(step, duration));
    EXPECT_EQ(s.clock.stage_step, steps);
    EXPECT_DOUBLE_EQ(s.clock.time(), duration);
  }
}

TEST(Duration, GivesTheImpulseOfAConstantForce) {
  for (const double duration : {0.8, 1.0}) {
    Case c = free_particle(0.3, duration);
    c.stages[0].loads.push_back({{}, {"all", {}}, {5.0, 0, 0}, {}, {}});
    EXPECT_NEAR(after_run(c).v[ParticleId{0}].x, 5.0 * duration, 1e-14);
  }
}

// Force 5 for 0.43 of the unit of time; a support that moves at 2 for as long.
TEST(TimeTable, GivesItsImpulseAndItsWay) {
  TimeFunctionSpec pulse;
  for (const auto& [t, f] : {std::pair{0.0, 1.0}, {0.43, 1.0}, {0.43000001, 0.0}})
    pulse.points.push_back({{t, false}, f});
  const double on = 0.43 + 0.5e-8;
  Case c = free_particle(0.1, 1.0);
  c.stages[0].loads.push_back({{}, {"all", {}}, {5.0, 0, 0}, {}, pulse});
  EXPECT_NEAR(after_run(c).v[ParticleId{0}].x, 5.0 * on, 1e-13);

  c.stages[0].loads.clear();
  SupportSpec support;
  support.group = {"all", {}};
  support.held[0] = true;
  support.velocity = {2.0, 0, 0};
  support.factor = pulse;
  c.stages[0].supports = {support};
  EXPECT_NEAR(after_run(c).r[ParticleId{0}].x, 2.0 * on, 1e-13);
}

TEST(TimeTable, OfAStageUnderWayIsWhatItWas) {
  Case c = free_particle(0.1, 1.0);
  c.stages[0].loads.push_back(
      {{}, {"all", {}}, {5.0, 0, 0}, {}, {{{{0.0, false}, 0.0}, {{0.37, false}, 1.0}}}});
  Built b = build(c);
  const TimeFunction fresh = build_stage(c, b.model, 0, b.state).loads[0].factor;
  ASSERT_GT(fresh.points.size(), 2u);  // bends beside 0.37
  b.state.clock.stage_step = 3;
  b.state.clock.dt = 0.1;
  const TimeFunction again = build_stage(c, b.model, 0, b.state).loads[0].factor;
  ASSERT_EQ(again.points.size(), fresh.points.size());
  for (std::size_t k = 0; k < fresh.points.size(); ++k) {
    EXPECT_EQ(again.points[k].t, fresh.points[k].t);
    EXPECT_EQ(again.points[k].factor, fresh.points[k].factor);
  }
}

// Three particles in a row, the middle one at the centre: 10 applications of 1 % in 10 times `every`.
TEST(Strain, IsAppliedAsOftenAsTheCaseSays) {
  Case c = case_of(ListedSpecimen{{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}});
  c.time.step = Placed<std::variant<CaseTime, ExactStep>>{CaseTime{0.3, false}, {"case.toml", 50, 1}};
  c.stages[0].duration = {4.0, false};
  c.stages[0].strain = StrainSpec{{"case.toml", 40, 1}, {"all", {}}, {1, 0, 0}, 0.01, {0.4, false}};
  const State s = after_run(c);
  EXPECT_NEAR(s.r[ParticleId{2}].x, std::pow(1.01, 10), 1e-14);
  EXPECT_DOUBLE_EQ(s.clock.time(), 4.0);
}

TEST(Duration, OfMoreStepsThanAnyRunTakesIsRefused) {
  Case c = free_particle(0.1, 1e60);
  const std::string error = text_of_error(c);
  for (const char* part : {"case.toml:20:1: stage \"run\": duration = 1e+60", "that is 1e+61 steps of 0.1",
                           "1e+15 are the most"})
    EXPECT_TRUE(contains(error, part)) << part << "\nnot in\n" << error;
}

}  // namespace
}  // namespace vbond::test
