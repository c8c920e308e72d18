// Observers of a body in parts: sums over what each process has of it are what one process sees of the whole,
// and nobody collects the whole body for them. The processes are threads here, and the body stands still.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "observe/bar_in_parts.hpp"
#include "temporary_folder.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/observe/breaks_observer.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/history.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/run/run.hpp"

namespace vbond::parts_test {
namespace {

OutputPlan plan_of(const Model& model) {
  OutputPlan plan;
  Group some{"some", {}};
  for (const ParticleId p : model.r_0.ids())
    if (p.value % 3 != 0) some.particles.push_back(p);
  plan.axial_force = plan.displacements = plan.velocities = {some, model.groups[0]};
  plan.stresses = {{some, 70.0}, {model.groups[0], 100.0}};
  plan.losses = {Loss::yield_axial, Loss::friction, Loss::contact_damping};
  plan.cell = model.cell.any();
  plan.breaks = true;
  return plan;
}

/// Those that a part with these bonds must know of, absent ones apart.
std::size_t particles_of(const Order& order, const State& state) {
  PerParticle<char> known(state.r.size(), 0);
  for (Row row{0}; row.value < order.known; ++row.value) known[order.particle[row]] = 1;
  for (const Bond& b : state.bonds)
    if (order.has(b.i)) known[b.j] = 1;
  return static_cast<std::size_t>(std::count(known.begin(), known.end(), 1));
}

/// How many particles a state and a model have room for.
std::vector<std::size_t> particles_held(const State& s, const Model& m) {
  return {s.v.values().capacity(),       s.q.values().capacity(),       s.omega.values().capacity(),
          s.loads.F.values().capacity(), s.loads.M.values().capacity(), m.mass.values().capacity(),
          m.inertia.values().capacity(), m.specimen.values().capacity()};
}

bool have_the_same_particles(const Model& a, const Model& b) {
  return a.mass == b.mass && a.inertia == b.inertia && a.r_0 == b.r_0 && a.specimen == b.specimen;
}

struct Seen {
  std::vector<Cell> row;
  WatchRecord record;
  std::vector<std::string> told;
};

Seen look_at(const OutputPlan& plan, const BodyView& body) {
  Seen seen;
  constexpr double no_bound = 1e9;  // energies here are of no motion
  Watch watch(no_bound, [&seen](const std::string& text) { seen.told.push_back(text); });
  seen.row = history_row(plan, history_values(plan, body));
  watch.look(body);
  watch.look_at_overlaps(body, 0.1);
  seen.record = watch.record();
  std::sort(seen.told.begin(), seen.told.end());
  return seen;
}

double number_in(const Cell& cell) {
  if (const auto* x = std::get_if<double>(&cell)) return *x;
  if (const auto* n = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*n);
  return -1.0;  // no number in it
}

class Parts : public OfBars {};
INSTANTIATE_TEST_SUITE_P(, Parts, kinds_of_bars, name_of_kind);

TEST_P(Parts, AddUpToWhatOneProcessSeesAndCollectNothing) {
  const auto [touches, periodic] = GetParam();
  std::size_t overlaps = 0, deformed = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Specimen s = random_bar(seed, touches, periodic);
    const Stage stage = testing::plain_stage(0.02, 1e9);
    Simulation before(s.model, stage, s.state);
    for (int k = 0; k < 20; ++k) before.step();
    State state = std::move(before).handover().state;
    if (seed % 4 < 2) begin_next_stage(state.clock);  // else the stage goes on
    const Simulation run(s.model, stage, state);
    const OutputPlan plan = plan_of(s.model);
    const std::vector<std::string> names = history_columns(plan);
    const Seen whole = look_at(plan, run);
    overlaps += whole.record.overlapping.size(), deformed += whole.record.bonds.size() > 0 ? 1 : 0;

    const std::size_t processes = 2 + seed % 2;
    Meeting meeting(processes);
    std::vector<Seen> seen(processes);
    std::vector<std::size_t> gathered(processes), gathered_whole(processes), bonds(processes);
    std::vector<std::size_t> known(processes), near(processes), has_row(processes);
    std::vector<std::vector<std::size_t>> held(processes);
    std::vector<char> same_bonds(processes), same_model(processes);
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < processes; ++k)
      threads.emplace_back([&, k] {
        Process process(meeting, k);
        State mine = state;
        Share share = part_of_bar(s, mine, k, processes, process.images);
        known[k] = particles_of(share.order, mine);
        has_row[k] = share.order.row.held() ? share.order.row.held()->size() : s.model.particles();
        Model model = s.model;
        share.model = &model;
        const Simulation part(model, stage, &mine, std::move(share), process);
        EXPECT_EQ(model.r_0.values().capacity(), model.mass.values().capacity());  // none across borders yet
        seen[k] = look_at(plan, part);
        gathered[k] = process.largest_gather;
        const State& here = part.part().state;
        bonds[k] = here.bonds.size();
        held[k] = particles_held(here, model);
        near[k] = std::max(here.r.values().size(), model.r_0.values().size());
        const State& all = part.state();
        same_bonds[k] = all.bonds == state.bonds && all.bond_history == state.bond_history &&
                        all.warm_bonds == state.warm_bonds;
        same_model[k] = have_the_same_particles(model, s.model);
        gathered_whole[k] = process.largest_gather;
      });
    for (std::thread& t : threads) t.join();

    // each has its own bonds and no others
    EXPECT_EQ(std::accumulate(bonds.begin(), bonds.end(), std::size_t{0}), state.bonds.size());
    EXPECT_EQ(std::count(bonds.begin(), bonds.end(), 0u), 0);
    const std::size_t places = s.model.particles() * sizeof(Vec3d);
    for (std::size_t k = 0; k < processes; ++k) {
      EXPECT_LT(known[k], s.model.particles());
      EXPECT_LE(has_row[k], known[k]);
      for (const std::size_t n : held[k]) EXPECT_LE(n, known[k] + 1) << "seed " << seed;  // one is absent
      EXPECT_LE(near[k], s.model.particles() - (periodic ? 0u : 1u));  // with those across borders
      EXPECT_TRUE(same_bonds[k]) << "seed " << seed;
      EXPECT_TRUE(same_model[k]) << "seed " << seed;
      EXPECT_LT(gathered[k], places) << "seed " << seed;
      EXPECT_GE(gathered_whole[k], places) << "seed " << seed;
      ASSERT_EQ(seen[k].row.size(), whole.row.size());
      for (std::size_t c = 0; c < whole.row.size(); ++c)  // sums of at most some hundred terms of size 10
        EXPECT_NEAR(number_in(seen[k].row[c]), number_in(whole.row[c]), 1e-12)
            << names[c] << ", seed " << seed << ", process " << k << " of " << processes;
      EXPECT_TRUE(seen[k].record == whole.record) << "seed " << seed << ", process " << k;
      EXPECT_EQ(seen[k].told, whole.told) << "seed " << seed << ", process " << k;
    }
  }
  EXPECT_GT(overlaps, 20u);
  EXPECT_GT(deformed, 10u);
}

// ---- what the process that leads writes for all --------------------------------------------------------

TEST_P(Parts, CheckpointIsThatOfTheWholeAndNobodyCollectsIt) {
  const auto [touches, periodic] = GetParam();
  const test::TemporaryFolder folder("vbond_parts_checkpoint");
  const std::string none = "no checkpoint";
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Specimen s = moved_bar(seed, touches, periodic);
    const std::size_t processes = 2 + seed % 2;
    Meeting meeting(processes);
    std::vector<std::size_t> gathered(processes);
    std::vector<std::string> failure(processes, none);
    in_processes(processes, [&](std::size_t k) {
      Process process(meeting, k);
      State mine = s.state;
      Share share = part_of_bar(s, mine, k, processes, process.images);
      Model model = s.model;
      share.model = &model;
      const Simulation part(model, testing::plain_stage(0.02, 1e9), &mine, std::move(share), process);
      const auto write = [&](const std::filesystem::path& path) {
        write_checkpoint(path, model, part.state_of_part().value(), {}, "1.2.3");
      };
      write(folder / "parts.h5");
      try {  // the others must not wait for it
        write(folder / "missing" / "parts.h5");
      } catch (const IoError& e) {
        failure[k] = e.what();
      }
      gathered[k] = process.largest_gather;
      const State& all = part.state();
      EXPECT_FALSE(part.state_of_part());  // the whole is at hand
      if (process.leads()) write_checkpoint(folder / "whole.h5", s.model, all, {}, "1.2.3");
    });
    EXPECT_EQ(read_all(folder / "parts.h5"), read_all(folder / "whole.h5")) << "seed " << seed;
    for (std::size_t k = 0; k < processes; ++k) {
      EXPECT_LT(gathered[k], s.model.particles() * sizeof(Vec3d)) << "seed " << seed;
      EXPECT_EQ(failure[k] == none, k != 0) << failure[k];
    }
  }
}

/// Spreads the bar as part_of_bar does.
class BarPartition : public testing::ProcessOf<Partition> {
 public:
  BarPartition(const Specimen& s, Meeting& meeting, std::size_t rank) : ProcessOf(meeting, rank), s_(s) {}
  Share spread(const Model&, const State& state, double, bool) override {
    State mine = state;
    Share share =
        part_of_bar(s_, mine, static_cast<std::size_t>(rank()), static_cast<std::size_t>(ranks()), images);
    share.begins = true;
    return share;
  }
  Share spread_anew(const Model& model, const State& state) override {
    return spread(model, state, 0, false);
  }
  Share migrate(Model&, State&, PartHandedOver) override {
    throw std::logic_error("particles of the bar stay in their parts");
  }

 private:
  const Specimen& s_;
};

TEST_P(Parts, EndOfTheLastStageCollectsNothingBeforeItIsAskedFor) {
  const auto [touches, periodic] = GetParam();
  const test::TemporaryFolder folder("vbond_parts_end");
  const Specimen s = moved_bar(1, touches, periodic);
  constexpr std::size_t processes = 3;
  Meeting meeting(processes);
  std::vector<std::size_t> gathered(processes);
  std::vector<State> whole(processes);
  in_processes(processes, [&](std::size_t k) {
    BarPartition partition(s, meeting, k);
    Stage stage = testing::plain_stage(0.02, 0.02);
    stage.insist = true;
    vbond::Run run(s.model, s.state, std::vector<AnyStage>{stage});
    run.spread_over(partition);
    OutputPlan plan = plan_of(s.model);
    plan.folder = folder.path(), plan.overlap = 0.0;
    plan.writes = k == 0 ? Writes::everything : Writes::own_parts;
    const auto watch = std::make_shared<WatchObserver>(plan, nullptr);
    run.add_observer(std::make_shared<BreaksObserver>(plan, std::nullopt, false));
    run.add_observer(std::make_shared<CheckpointObserver>(plan, watch, "1.2.3"));
    run.run();
    gathered[k] = partition.largest_gather;
    EXPECT_TRUE(run.complete());
    whole[k] = run.state();
    EXPECT_GE(partition.largest_gather, s.model.particles() * sizeof(Vec3d));
  });
  Checkpoint end = read_checkpoint(folder / "checkpoint.h5", s.model);
  end.state.clock = whole[0].clock;  // that of the next stage
  for (std::size_t k = 0; k < processes; ++k) {
    EXPECT_TRUE(whole[k] == end.state) << "process " << k;
    if (!periodic) {  // of which fragments are found in the whole body
      EXPECT_LT(gathered[k], s.model.particles() * sizeof(Vec3d)) << "process " << k;
    }
  }
}

}  // namespace
}  // namespace vbond::parts_test
