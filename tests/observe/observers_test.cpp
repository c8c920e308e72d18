#include "vbond/observe/observers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <set>
#include <stdexcept>

#include "dynamics/processes.hpp"
#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/statics/point_view.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::lines_of;

constexpr double dt = 0.05;

OutputPlan plan_in(const std::filesystem::path& folder) {
  OutputPlan plan;
  plan.folder = folder;
  plan.history_every = 10 * dt;
  plan.frames_every = 16 * dt;
  plan.lammps_dump = true;
  plan.checkpoint_every = 7 * dt;
  plan.watch_every = 3;
  plan.reactions = {{"left", {ParticleId{0}}}};
  plan.axial_force = {{"all", {ParticleId{0}, ParticleId{1}, ParticleId{2}}}};
  plan.displacements = {{"2", {ParticleId{2}}}};
  return plan;
}

/// Two stages of 25 and 31 steps: neither is a multiple of an interval.
std::vector<Stage> two_stages() {
  Stage first, second;
  first.name = "pull";
  first.dt = dt;
  first.loads = {{"end", {ParticleId{2}}, {1e-3, 1e-4, 0}, {}, {}}};
  first.stops.duration = 25 * dt;
  second.name = "let go";
  second.dt = dt;
  second.b_translation = 0.01;
  second.stops.duration = 31 * dt;
  return {first, second};
}

/// Neither interval divides another, a stage or is a whole number of steps; the stages differ in their step.
OutputPlan awkward_plan_in(const std::filesystem::path& folder) {
  OutputPlan plan = plan_in(folder);
  plan.history_every = 17.3 * dt;
  plan.frames_every = 41.6 * dt;
  plan.checkpoint_every = 29.4 * dt;
  plan.watch_every = 23;
  return plan;
}

std::vector<Stage> awkward_stages() {
  std::vector<Stage> stages = two_stages();
  stages[0].stops.duration = 101 * dt;
  stages[1].dt = 0.7 * dt;
  stages[1].stops.duration = 97 * 0.7 * dt;
  return stages;
}

State at_rest(const Chain& chain) {
  State s = chain.state;
  s.clock = {};
  for (Vec3d& v : s.v) v = {};
  for (Vec3d& w : s.omega) w = {};
  return s;
}

/// Runs from this state to the end, or until `stop_at` steps have been made.
StopReason run_from(const OutputPlan& plan, const Model& model, State state, const Checkpoint* resume,
                    std::int64_t stop_at, const std::vector<Stage>& stages = two_stages(),
                    const std::shared_ptr<Observer>& another = {}) {
  const FileObservers files = open_output(plan, {}, "1.2.3", resume);
  StopReason why = StopReason::running;
  for (auto k = static_cast<std::size_t>(state.clock.stage); k < stages.size(); ++k) {
    Simulation run(model, stages[k], state);
    for (const auto& o : files.all()) run.add_observer(o);
    if (another) run.add_observer(another);
    why = run.run([&] { return run.clock().step >= stop_at; });
    if (why == StopReason::interrupted) return why;
    state = run.state();
    state.clock.stage_start = state.clock.time();
    state.clock.stage_step = 0;
    ++state.clock.stage;
  }
  return why;
}

constexpr std::int64_t never = 1 << 30;

std::vector<std::int64_t> history_steps(const std::filesystem::path& folder) {
  const auto lines = lines_of(content_of(folder / "history.csv"));
  std::vector<std::int64_t> steps;
  for (std::size_t k = 1; k < lines.size(); ++k) steps.push_back(std::strtoll(lines[k].c_str(), nullptr, 10));
  return steps;
}

TEST(Observers, RowsStandAtTheIntervalAndAtStageEndsAndNeverTwice) {
  const Folder folder;
  const Chain chain;
  EXPECT_EQ(run_from(plan_in(folder.path()), chain.model, at_rest(chain), nullptr, never),
            StopReason::duration);
  EXPECT_EQ(history_steps(folder.path()), (std::vector<std::int64_t>{0, 10, 20, 25, 35, 45, 55, 56}));
  std::vector<std::string> frames;
  for (const auto& f : std::filesystem::directory_iterator(folder / "frames"))
    frames.push_back(f.path().filename().string());
  std::sort(frames.begin(), frames.end());
  EXPECT_EQ(frames.size(), 2u * 5);  // 0, 16, 25, 41, 56
  EXPECT_EQ(frames.back(), "particles_000000000056.vtp");
  EXPECT_EQ(read_checkpoint(folder / "checkpoint.h5", chain.model).state.clock.step, 56);
}

TEST(Observers, InterruptionAddsNoRowAndNoFrame) {
  const Folder folder;
  const Chain chain;
  EXPECT_EQ(run_from(plan_in(folder.path()), chain.model, at_rest(chain), nullptr, 13),
            StopReason::interrupted);
  EXPECT_EQ(history_steps(folder.path()), (std::vector<std::int64_t>{0, 10}));
  EXPECT_EQ(read_checkpoint(folder / "checkpoint.h5", chain.model).state.clock.step, 13);
}

void expect_same_files(
    const std::filesystem::path& a, const std::filesystem::path& b,
    std::size_t expected = 2 * 5 + 6) {  // frames; history, its columns, dump, two lists, checkpoint
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(a)) {
    if (!entry.is_regular_file()) continue;
    const auto name = std::filesystem::relative(entry.path(), a);
    EXPECT_TRUE(content_of(entry.path()) == content_of(b / name)) << name;
    ++files;
  }
  EXPECT_EQ(files, expected);
}

TEST(Observers, ResumedRunLeavesTheFilesOfAnUndisturbedOne) {
  const Chain chain;
  const Folder folder;
  std::filesystem::create_directories(folder / "whole");
  run_from(plan_in(folder / "whole"), chain.model, at_rest(chain), nullptr, never);
  // in the first stage, at a row, at the end of the stage, and in the second one
  for (const std::int64_t step : {3, 10, 24, 25, 26, 40}) {
    SCOPED_TRACE(step);
    const auto cut = folder / ("cut_" + std::to_string(step));
    std::filesystem::create_directories(cut);
    run_from(plan_in(cut), chain.model, at_rest(chain), nullptr, step);
    const Checkpoint c = read_checkpoint(cut / "checkpoint.h5", chain.model);
    EXPECT_EQ(run_from(plan_in(cut), chain.model, c.state, &c, never), StopReason::duration);
    expect_same_files(folder / "whole", cut);
  }
}

/// Wants to look at every step, and so makes all others decide at every step.
class EveryStep : public Observer {
 public:
  void observe(const Simulation&) override {}
};

/// Asks for nothing and writes down the steps at which others want to look.
class Bystander : public Observer {
 public:
  void observe(const Simulation& run) override { steps.push_back(run.clock().step); }
  std::int64_t steps_to_next_look(const Clock&) const override { return no_next_look; }
  std::vector<std::int64_t> steps;
};

TEST(Observers, FilesAreThoseOfDecidingAtEveryStepAlsoWhenResumed) {
  const Chain chain;
  const Folder folder;
  const auto run_in = [&](const std::filesystem::path& where, const State& state, const Checkpoint* resume,
                          std::int64_t stop_at, const std::shared_ptr<Observer>& another = {}) {
    return run_from(awkward_plan_in(where), chain.model, state, resume, stop_at, awkward_stages(), another);
  };
  std::filesystem::create_directories(folder / "every_step");
  run_in(folder / "every_step", at_rest(chain), nullptr, never, std::make_shared<EveryStep>());
  // 17 steps of the first stage, 25 of the second (17.3 / 0.7 = 24.7)
  EXPECT_EQ(history_steps(folder / "every_step"),
            (std::vector<std::int64_t>{0, 17, 34, 51, 68, 85, 101, 126, 151, 176, 198}));
  std::filesystem::create_directories(folder / "asked");
  run_in(folder / "asked", at_rest(chain), nullptr, never);
  expect_same_files(folder / "every_step", folder / "asked", 2 * 6 + 6);  // frames 0, 42, 84, 101, 160, 198
  for (const std::int64_t step : {1, 16, 17, 18, 46, 100, 102, 125, 126, 197}) {
    SCOPED_TRACE(step);
    const auto cut = folder / ("cut_" + std::to_string(step));
    std::filesystem::create_directories(cut);
    run_in(cut, at_rest(chain), nullptr, step);
    const Checkpoint c = read_checkpoint(cut / "checkpoint.h5", chain.model);
    EXPECT_EQ(c.state.clock.step, step);
    EXPECT_EQ(run_in(cut, c.state, &c, never), StopReason::duration);
    expect_same_files(folder / "every_step", cut, 2 * 6 + 6);
  }
}

TEST(Observers, NothingIsAskedOnStepsWhereNothingIsDue) {
  const Chain chain;
  const Folder folder;
  const OutputPlan plan = awkward_plan_in(folder.path());
  const auto bystander = std::make_shared<Bystander>();
  run_from(plan, chain.model, at_rest(chain), nullptr, never, awkward_stages(), bystander);
  std::vector<std::int64_t> due;
  std::int64_t start = 0;
  for (const auto& [dt_over_dt, steps] : {std::pair<double, std::int64_t>{1.0, 101}, {0.7, 97}}) {
    for (std::int64_t k = 0; k <= steps; ++k)
      for (const double interval : {23.0, std::round(17.3 / dt_over_dt), std::round(41.6 / dt_over_dt),
                                    std::round(29.4 / dt_over_dt)})
        if (k % static_cast<std::int64_t>(interval) == 0) {
          due.push_back(start + k);
          break;
        }
    start += steps;
  }
  EXPECT_EQ(bystander->steps, due);
  EXPECT_LT(due.size(), 198u / 4);  // or this would show little
}

TEST(TableObserver, IsAskedOnlyForItsRows) {
  const Chain chain;
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  Stage stage = two_stages()[0];
  stage.stops.duration = 2400 * dt;  // a row every 100 steps
  Simulation run(chain.model, stage, at_rest(chain));
  const auto bystander = std::make_shared<Bystander>();
  run.add_observer(std::make_shared<TableObserver>(out));
  run.add_observer(bystander);
  run.run();
  std::fclose(out);
  std::vector<std::int64_t> rows;
  for (std::int64_t k = 0; k <= 2400; k += 100) rows.push_back(k);
  EXPECT_EQ(bystander->steps, rows);
}

/// The second stage, of 2400 steps, from its step 1250 on.
struct Resumed {
  Chain chain;
  Stage stage = two_stages()[1];
  State state = at_rest(chain);
  Resumed() {
    stage.stops.duration = 2400 * dt;
    state.clock = {.step = 1275, .stage_step = 1250, .stage = 1, .stage_start = 25 * dt, .dt = dt};
  }
};

TEST(TableObserver, OfAResumedStageHasTheRowsOfTheWholeOne) {
  Resumed r;
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  Simulation run(r.chain.model, r.stage, r.state);
  const auto bystander = std::make_shared<Bystander>();
  run.add_observer(std::make_shared<TableObserver>(out));
  run.add_observer(bystander);
  run.run();
  std::fclose(out);
  std::vector<std::int64_t> rows{1276};  // after the first step all are asked
  for (std::int64_t k = 1300; k <= 2400; k += 100) rows.push_back(25 + k);
  EXPECT_EQ(bystander->steps, rows);
}

TEST(ProgressObserver, SaysNothingOfAResumedStageAtItsFirstLook) {
  Resumed r;
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  const Simulation run(r.chain.model, r.stage, r.state);
  ProgressObserver(out, {25, 2400}).observe(run);  // no step made, no speed known
  EXPECT_EQ(std::ftell(out), 0);
  std::fclose(out);
}

// All processes that step a body wait for a look at it.
TEST(ProgressObserver, WaitsUntilProcessesMeetAnyway) {
  const Chain chain(2);
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  Simulation run(chain.model, two_stages()[1], at_rest(chain));
  ProgressObserver alone(out, {0, 1000}), of_parts(out, {0, 1000});
  alone.observe(run);
  EXPECT_EQ(alone.steps_to_next_look(run.clock()), 1);
  State begun = run.state();
  testing::Meeting meeting(1);
  testing::Process process(meeting, 0);
  const Simulation part(chain.model, two_stages()[1], &begun, {spatial_order(chain.model.r_0)}, process);
  of_parts.observe(part);
  EXPECT_EQ(of_parts.steps_to_next_look(part.clock()), part.processes().steps_between_meetings());
  EXPECT_GT(part.processes().steps_between_meetings(), 1);
  std::fclose(out);
}

TEST(ProgressObserver, SeldomAsksOnFastSteps) {
  const Chain chain(2);
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  Stage stage = two_stages()[1];
  constexpr std::int64_t steps = 20000;
  stage.stops.duration = steps * dt;
  Simulation run(chain.model, stage, at_rest(chain));
  const auto bystander = std::make_shared<Bystander>();
  const auto progress = std::make_shared<ProgressObserver>(out, std::vector<std::int64_t>{0, steps});
  run.add_observer(progress);
  run.add_observer(bystander);
  const auto start = std::chrono::steady_clock::now();
  run.run();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::fclose(out);
  // intervals grow from 1 step by factors of two: 15 looks to 2^15 > 20000. A look may come early if the
  // steps before it were slow, but then that slow interval took its tenth of a second, and what was lost is
  // made up again in at most 15 doublings.
  EXPECT_LE(static_cast<double>(bystander->steps.size()), 16 + (1 + 15) * 10 * seconds);
  EXPECT_GE(bystander->steps.size(), 10u);
}

TEST(Observers, KilledRunGoesOnFromItsLastCheckpoint) {
  const Chain chain;
  const Folder folder;
  std::filesystem::create_directories(folder / "whole");
  std::filesystem::create_directories(folder / "killed");
  run_from(plan_in(folder / "whole"), chain.model, at_rest(chain), nullptr, never);
  // a checkpoint of step 13 beside files that have gone on to the end, as after a kill
  run_from(plan_in(folder / "killed"), chain.model, at_rest(chain), nullptr, 13);
  std::filesystem::copy_file(folder / "killed/checkpoint.h5", folder / "early.h5");
  run_from(plan_in(folder / "killed"), chain.model, at_rest(chain), nullptr, never);
  const Checkpoint c = read_checkpoint(folder / "early.h5", chain.model);
  run_from(plan_in(folder / "killed"), chain.model, c.state, &c, never);
  expect_same_files(folder / "whole", folder / "killed");
}

TEST(Observers, UnphysicalStateIsNeverWritten) {
  const Folder folder;
  Chain chain;
  OutputPlan plan = plan_in(folder.path());
  plan.watch_every = 1;
  plan.energy_error = 1e-30;  // below rounding: the first moving step breaks it
  EXPECT_THROW(run_from(plan, chain.model, at_rest(chain), nullptr, never), Diverged);
  EXPECT_EQ(history_steps(folder.path()), std::vector<std::int64_t>{0});
  EXPECT_FALSE(std::filesystem::exists(folder / "checkpoint.h5"));
}

TEST(TableObserver, PrintsOneHeaderAndEachStepOnce) {
  const Chain chain;
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  const auto table = std::make_shared<TableObserver>(out);
  State state = at_rest(chain);
  for (const Stage& stage : two_stages()) {
    Simulation run(chain.model, stage, state);
    run.add_observer(table);
    run.run();
    state = run.state();
    state.clock.stage_start = state.clock.time();
    state.clock.stage_step = 0;
    ++state.clock.stage;
  }
  std::rewind(out);
  std::string text(100000, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), out));
  std::fclose(out);
  const auto lines = lines_of(text);
  // 25 steps: every second, 13 rows and the end; 31 steps: 16 rows less the first, which is that end
  EXPECT_EQ(lines.size(), 1u + 14 + 15 + 1);
  std::set<std::string> distinct(lines.begin(), lines.end());
  EXPECT_EQ(distinct.size(), lines.size());
}

/// A point of balance of a static stage that is the second of the run and begins at step 25.
State point_state(const Chain& chain, std::int64_t point) {
  State s = at_rest(chain);
  s.clock = {.step = 25 + point, .stage_step = point, .stage = 1, .stage_start = 25 * dt, .dt = 1.0};
  return s;
}

TEST(Observers, EveryStaticPointGivesARowAndAFrameAndThoseAfterACheckpointAreDropped) {
  const Chain chain;
  const Folder folder;
  OutputPlan plan = plan_in(folder.path());
  plan.statics = true;
  const auto reaction = [](const std::vector<ParticleId>&) { return Reaction{}; };
  const auto record = [&](const FileObservers& files, std::int64_t number) {
    const State state = point_state(chain, number);
    const StaticPoint point{state, 0.1 * static_cast<double>(number), PointKind::regular, 0, {}, reaction};
    const PointView view(chain.model, point);
    for (const auto& o : files.all()) o->observe_balance(view, *view.balance());
  };
  Stage first = two_stages()[0];
  Checkpoint start;
  {
    const FileObservers files = open_output(plan, {}, "1.2.3");
    Simulation run(chain.model, first, at_rest(chain));
    for (const auto& o : files.all()) run.add_observer(o);
    run.run();
    start.state = point_state(chain, 0);
    for (const std::int64_t number : {1, 2, 3}) record(files, number);
    // the next stage finds the step written
    EXPECT_EQ(history_steps(folder.path()), (std::vector<std::int64_t>{0, 10, 20, 25, 26, 27, 28}));
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "frames/bonds_000000000028.vtp"));
  const FileObservers files = open_output(plan, {}, "1.2.3", &start);
  EXPECT_EQ(history_steps(folder.path()), (std::vector<std::int64_t>{0, 10, 20, 25}));
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/bonds_000000000026.vtp"));
  record(files, 1);
  EXPECT_EQ(history_steps(folder.path()), (std::vector<std::int64_t>{0, 10, 20, 25, 26}));
  EXPECT_NE(content_of(folder / "particles.pvd").find("timestep=\"2.25\""), std::string::npos);
  EXPECT_NE(content_of(folder / "frames/bonds_000000000026.vtp").find(">0.1</DataArray>"), std::string::npos);
}

TEST(TableObserver, HeaderIsPrintedWhereverDynamicsAndStaticsMeet) {
  const Chain chain;
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  const auto table = std::make_shared<TableObserver>(out);
  for (int round = 0; round < 2; ++round) {
    for (const std::int64_t number : {1, 2}) {
      const State state = point_state(chain, 10 * round + number);
      const StaticPoint point{state, 0.5, PointKind::regular, 0, {}, {}};
      const PointView view(chain.model, point);
      table->observe_balance(view, *view.balance());
    }
    Stage stage = two_stages()[0];
    stage.stops.duration = 3 * dt;
    Simulation run(chain.model, stage, at_rest(chain));
    run.add_observer(table);
    run.run();
  }
  std::rewind(out);
  std::string text(100000, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), out));
  std::fclose(out);
  const auto lines = lines_of(text);
  ASSERT_EQ(lines.size(), 2u * (1 + 2 + 1 + 4));
  for (const std::size_t k : {0u, 8u}) EXPECT_NE(lines[k].find("load factor"), std::string::npos) << k;
  for (const std::size_t k : {3u, 11u}) EXPECT_NE(lines[k].find("kinetic"), std::string::npos) << k;
}

}  // namespace
}  // namespace vbond
