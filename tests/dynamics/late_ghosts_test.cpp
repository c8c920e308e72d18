// A part of a body may go on with what does not concern its ghosts until their poses have come.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "processes.hpp"
#include "random_pose.hpp"
#include "rods.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

// Sorted along y first, so that each block has particles at the middle. The left half has two blocks and a
// half.
constexpr std::size_t along_x = 24, along_y = 28;

/// A sheet whose particles stand and turn anyhow. Bonds that cross its middle begin in the left half.
testing::Specimen crumpled_halves() {
  std::vector<Vec3d> r;
  for (std::size_t x = 0; x < along_x; ++x)
    for (std::size_t y = 0; y < along_y; ++y)
      r.push_back({static_cast<double>(x), static_cast<double>(y), 0});
  testing::Specimen s = testing::particles_at(r);
  for (std::size_t k = 0; k < along_x * along_y; ++k) {
    if (k % along_y + 1 < along_y) testing::bond(s, k, k + 1, testing::papers_bond());
    if (k + along_y < along_x * along_y) testing::bond(s, k, k + along_y, testing::papers_bond());
  }
  testing::PoseSource random(7);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.r[p] += random.vector(0.02);
    s.state.q[p] = random.rotation(0.1);
    s.state.v[p] = random.vector(0.1);
  }
  return s;
}

bool is_left(ParticleId p) {
  return p.value < along_x / 2 * along_y;
}

/// Ghosts are nowhere from the first call to the second, then where this state has them.
class LateProcess final : public testing::Process {
 public:
  LateProcess(testing::Meeting& meeting, const State& now) : ProcessOf(meeting, 0), now_(&now) {}

  void begin_halo(const HaloColumns& columns) override {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [row, p] : ghosts) columns.pose[row].r = {nan, nan, nan};
  }
  void end_halo(const HaloColumns& columns) override {
    for (const auto& [row, p] : ghosts) columns.pose[row].r = now_->r[p], columns.pose[row].q = now_->q[p];
  }
  void reverse_sum(std::span<LoadRow> load) override {
    for (const auto& [row, p] : ghosts) load[row] = {};
  }
  void is_at(const State& now) { now_ = &now; }

  std::vector<std::pair<std::size_t, ParticleId>> ghosts;

 private:
  const State* now_;
};

/// early: whether particles bonded to ghosts are said to move early.
void expect_the_step_of_the_whole(bool early) {
  SCOPED_TRACE(early);
  const double dt = 0.01;
  const testing::Specimen s = crumpled_halves();
  Simulation whole(s.model, testing::plain_stage(dt, 1e9), s.state);

  Holding holding{.own = {}, .early = {}, .ghosts = {}, .ghost_bonds_last = true, .others_in_one_row = true};
  for (const ParticleId p : s.state.r.ids())
    if (is_left(p)) holding.own.push_back(p);
  std::size_t crossing = 0;
  for (const Bond& b : s.state.bonds)
    if (is_left(b.i) && !is_left(b.j)) {
      holding.ghosts.push_back({b.j, {}});
      if (early) holding.early.push_back(b.i);
      ++crossing;
    }
  ASSERT_EQ(crossing, along_y);
  Share share{.order = part_of(spatial_order(s.state.r), holding), .begins = true};
  share.farthest = share.lost_beyond = std::numeric_limits<double>::infinity();
  testing::Meeting meeting(1);
  LateProcess process(meeting, s.state);
  for (const ImageOf& g : holding.ghosts)
    process.ghosts.emplace_back(share.order.row[g.particle].value, g.particle);
  State mine = s.state;
  Simulation part(s.model, testing::plain_stage(dt, 1e9), &mine, std::move(share), process);

  for (int step = 1; step <= 3; ++step) {
    whole.step();
    const State now = whole.state();
    process.is_at(now);
    part.step();
    // the same sums, those of crossing bonds last of all: some roundings of the largest load
    const Loads expected = whole.loads(), loads = part.loads();
    double largest = 0.0;
    for (const ParticleId p : now.r.ids())
      largest = std::max({largest, norm(expected.F[p]), norm(expected.M[p])});
    const double tolerance = 20.0 * step * std::numeric_limits<double>::epsilon() * largest;
    for (const ParticleId p : holding.own) {
      EXPECT_LT(norm(loads.F[p] - expected.F[p]), tolerance) << p.value;
      EXPECT_LT(norm(loads.M[p] - expected.M[p]), tolerance) << p.value;
    }
  }
  Energies bonds;
  for (const Bond& b : s.state.bonds)
    if (is_left(b.i)) {
      const BondEnergy<double> U = b.law->energy(b, bond_pose(b, whole.state()), no_history);
      bonds.U_L += U.U_L, bonds.U_B += U.U_B, bonds.U_T += U.U_T;
    }
  EXPECT_NEAR(part.survey().energies.potential(), bonds.potential(), 1e-12 * bonds.potential());
}

TEST(LateGhosts, DoNotChangeAStep) {
  for (const bool early : {true, false}) expect_the_step_of_the_whole(early);
}

}  // namespace
}  // namespace vbond
