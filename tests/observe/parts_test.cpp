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

#include "dynamics/processes.hpp"
#include "dynamics/spheres_and_walls.hpp"
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

using testing::ImageRow;
using testing::Meeting;
using testing::Process;
using testing::Specimen;

/// A bar of particles on a floor, bonded at random to neighbours by bonds that yield, each somewhat out of
/// its place, some far; one was taken out. Some bonds are broken, have turned frames or expand with heat.
Specimen random_bar(unsigned seed, bool touches, bool periodic) {
  testing::Dice dice(seed);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < 288; ++k)
    r.push_back({static_cast<double>(k / 12), static_cast<double>(k % 4), static_cast<double>(k / 4 % 3)});
  Specimen s = testing::particles_at(r, 0.45);
  for (const ParticleId p : s.model.mass.ids()) {
    s.model.mass[p] = dice.chance(0.5) ? 1.0 : 1.25, s.model.inertia[p] = dice.chance(0.5) ? 0.5 : 0.625;
    s.model.specimen.push_back(static_cast<std::uint32_t>(dice.below(5)));
  }
  if (touches)
    s.model.contact = testing::linear(1.0, 0.4, 0.7), s.model.contact.pairs = ContactPairs::unbonded;
  if (touches && !periodic) s.model.walls = {testing::floor_at(-0.44)};
  if (periodic) {
    s.model.cell.edges = {Vec3d{24.2, 0.3, 0.0}, {0.2, 4.1, 0.1}, {0.0, -0.1, 3.0}};
    s.model.cell.periodic = {true, true, true};
    s.state.cell = cell_at_start(s.model);
  }
  BondRecipe recipe = testing::papers_bond();
  recipe.rules.yield.limit.axial = 0.01;
  const std::size_t taken = dice.below(r.size());
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (i != taken && j != taken && norm(r[j] - r[i]) < 1.1 && dice.chance(0.7)) {
        const bool turned = dice.chance(0.5);
        testing::bond(s, turned ? j : i, turned ? i : j, recipe);
      }
  s.state.bond_history.resize(s.state.bonds.size());
  for (const BondId k : s.state.bonds.ids()) {
    Bond& b = s.state.bonds[k];
    b.broken = dice.chance(0.3);
    if (dice.chance(0.2)) set_frames(b, b.frame_i, rotation_of(dice.vector(0.1)) * frame_j(b));
    if (dice.chance(0.2)) s.state.warm_bonds.push_back({k, 0.1, b.a, b.R_i, b.R_j});
  }
  for (const ParticleId p : s.state.r.ids()) {
    s.state.r[p] += dice.vector(dice.chance(0.1) ? 0.3 : 0.03);
    s.state.q[p] = rotation_of(dice.vector(dice.chance(0.03) ? 1.5 : 0.1));
    s.state.v[p] = dice.vector(0.1), s.state.omega[p] = dice.vector(0.1);
  }
  s.state.dropped = s.state.taken = {ParticleId{taken}};
  s.state.v[ParticleId{taken}] = s.state.omega[ParticleId{taken}] = {};
  return s;
}

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

/// The k-th of so many parts: a piece along the bar, with the particles that it must know. All others are
/// somewhere else in its state, and bonds between them are broken there.
Share part_of_bar(const Specimen& s, State& state, std::size_t k, std::size_t parts,
                  std::vector<ImageRow>& images) {
  const auto owner = [&](ParticleId p) { return std::min(parts - 1, p.value * parts / s.model.particles()); };
  Holding holding{.own = {}, .sent = {}, .ghosts = {}, .others_in_one_row = true};
  PerParticle<char> known(s.model.particles(), 0);
  for (const ParticleId p : known.ids())
    if (owner(p) == k && !is_absent(state, p)) holding.own.push_back(p), known[p] = 1;
  const auto ghost = [&](ParticleId p, const Image& n) {
    if (n.is_itself() && known[p] == 0) known[p] = 2;
    if (owner(p) != k || !n.is_itself()) holding.ghosts.push_back({p, n});
  };
  for (const Bond& b : state.bonds)
    if (owner(b.i) == k) ghost(b.j, image_of_j(b));
  if (particles_touch(s.model.contact)) {
    const std::vector<double> sizes(s.model.particles(), 1.0);  // farther than contacts reach
    for_overlapping_images(state.cell, s.model.cell.periodic, state.r.values(), sizes, 0.0,
                           [&](std::size_t i, std::size_t j, const Image& n, double) {
                             const ParticleId p{i}, q{j};
                             if (is_absent(state, p) || is_absent(state, q)) return;
                             if (owner(p) == k) ghost(q, n);
                             if (owner(q) == k) ghost(p, -n);
                           });
  }
  std::sort(holding.ghosts.begin(), holding.ghosts.end());
  holding.ghosts.erase(std::unique(holding.ghosts.begin(), holding.ghosts.end()), holding.ghosts.end());
  const Order order = part_of(spatial_order(s.model.r_0), holding);
  for (Row row{order.ghosts}; row.value < order.known; ++row.value)
    if (!order.image(row).is_itself())
      images.push_back({row.value, order.image(row), state.r[order.particle[row]]});
  for (const ParticleId p : known.ids())
    if (known[p] == 0 && !is_absent(state, p)) state.r[p] += Vec3d{0.3, 1.7, 0.4}, state.v[p] = {9, 9, 9};
  for (Bond& b : state.bonds)
    if (known[b.i] == 0 && known[b.j] == 0) b.broken = true;
  constexpr double inf = std::numeric_limits<double>::infinity();
  return {order, inf, inf, state.clock.stage_step == 0};
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

class Parts : public ::testing::TestWithParam<std::tuple<bool, bool>> {};
INSTANTIATE_TEST_SUITE_P(, Parts, ::testing::Combine(::testing::Bool(), ::testing::Bool()),
                         [](const auto& p) {
                           return std::string(std::get<0>(p.param) ? "Touching" : "Bonded") +
                                  (std::get<1>(p.param) ? "Periodic" : "");
                         });

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

/// A bar that has moved, so that bonds and contacts remember something, as a run begins with it.
Specimen moved_bar(unsigned seed, bool touches, bool periodic) {
  Specimen s = random_bar(seed, touches, periodic);
  Simulation before(s.model, testing::plain_stage(0.02, 1e9), s.state);
  for (int k = 0; k < 20; ++k) before.step();
  s.state = std::move(before).handover().state;
  s.state.clock = {};
  return s;
}

/// Runs work(k) in threads, which are processes that meet.
template <class Work>
void in_processes(std::size_t processes, Work work) {
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < processes; ++k) threads.emplace_back([&work, k] { work(k); });
  for (std::thread& t : threads) t.join();
}

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
