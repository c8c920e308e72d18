#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "dynamics/processes.hpp"
#include "dynamics/spheres_and_walls.hpp"
#include "vbond/core/images.hpp"
#include "vbond/dynamics/partition.hpp"
#include "vbond/dynamics/simulation.hpp"

/// A bar in parts, each of which a thread has that stands for a process.
namespace vbond::parts_test {

using testing::ImageRow;
using testing::Meeting;
using testing::Process;
using testing::Specimen;

/// Tests of bars whose particles touch or not, and that are periodic or not.
using OfBars = ::testing::TestWithParam<std::tuple<bool, bool>>;
inline const auto kinds_of_bars = ::testing::Combine(::testing::Bool(), ::testing::Bool());
inline std::string name_of_kind(const ::testing::TestParamInfo<std::tuple<bool, bool>>& kind) {
  return std::string(std::get<0>(kind.param) ? "Touching" : "Bonded") +
         (std::get<1>(kind.param) ? "Periodic" : "");
}

/// A bar of particles on a floor, bonded at random to neighbours by bonds that yield, each somewhat out of
/// its place, some far; one was taken out. Some bonds are broken, have turned frames or expand with heat.
inline Specimen random_bar(unsigned seed, bool touches, bool periodic) {
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

/// The k-th of so many parts: a piece along the bar, with the particles that it must know. All others are
/// somewhere else in its state, and bonds between them are broken there.
inline Share part_of_bar(const Specimen& s, State& state, std::size_t k, std::size_t parts,
                         std::vector<ImageRow>& images) {
  const auto owner = [&](ParticleId p) { return std::min(parts - 1, p.value * parts / s.model.particles()); };
  Holding holding{.own = {}, .early = {}, .ghosts = {}, .others_in_one_row = true};
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
  return {.order = order, .farthest = inf, .lost_beyond = inf, .begins = state.clock.stage_step == 0};
}

/// A bar that has moved, so that bonds and contacts remember something, as a run begins with it.
inline Specimen moved_bar(unsigned seed, bool touches, bool periodic) {
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

}  // namespace vbond::parts_test
