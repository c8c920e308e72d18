// A body that drifts through its cell: what all of it has in common is no stress.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rods.hpp"
#include "vbond/model/periodic_cell.hpp"

namespace vbond::cell_drift_test {
namespace {

using testing::Dice;
using testing::Specimen;

/// Soft balls of different masses that fly about in a cell and push each other.
Specimen gas(unsigned seed, const Vec3d& drift) {
  Dice dice(seed);
  std::vector<Vec3d> r;
  for (int k = 0; k < 27; ++k)
    r.push_back(Vec3d{k % 3 + 0.5, k / 3 % 3 + 0.5, k / 9 + 0.5} + dice.vector(0.1));
  Specimen s{equal_particles(r, 1.0, 0.2, 0.55), {}};
  for (double& m : s.model.mass) m = dice(0.5, 2.0);
  s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::all};
  s.model.contact.k = 2.0;
  s.model.cell.edges = {Vec3d{3, 0, 0}, {0.2, 3, 0}, {0, -0.3, 3}};
  s.model.cell.periodic = {true, true, true};
  s.state = at_rest(s.model);
  for (Vec3d& v : s.state.v) v = dice.vector(0.1) + drift;
  return s;
}

/// One side is strained, one gives way to a stress, one shears.
Stage drawn() {
  Stage stage = testing::plain_stage(0.01, 20.0);
  stage.cell.component[0] = {CellComponent::By::strain, 0.004, {}};
  stage.cell.component[1] = {CellComponent::By::stress, -0.2, {}};
  stage.cell.component[5] = {CellComponent::By::strain, 0.003, {}};
  stage.cell.servo = {5.0, 2.0, 0.02};
  return stage;
}

/// From any state: images are found anew on the way.
State moved(const Specimen& s, const Stage& stage, double& worst) {
  State state = s.state;
  while (true) {
    Simulation run(s.model, stage, std::move(state));
    const StopReason why = run.run();
    worst = std::max(worst, std::abs(run.balance_error()));
    state = std::move(run).handover().state;
    if (why == StopReason::duration) return state;
  }
}

// Stress, and the cell that gives way to it, are those of the body without its drift, whose square is some
// hundred times what rounding of places adds up to.
TEST(CellDrift, MovesNoCell) {
  const Vec3d drift{0.4, -0.3, 0.2};
  for (const unsigned seed : {1u, 2u, 3u}) {
    double worst = 0.0, worst_drifting = 0.0;
    const Specimen still = gas(seed, {}), drifting = gas(seed, drift);
    const State a = moved(still, drawn(), worst), b = moved(drifting, drawn(), worst_drifting);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(norm(a.cell[k].along - b.cell[k].along), 1e-9) << "seed " << seed;
      EXPECT_LT(norm(cell_stress(still.model, a).row[k] - cell_stress(drifting.model, b).row[k]), 1e-9);
    }
    const ParticleId p{0}, q{13};
    EXPECT_LT(norm(between(a, p, q) - between(b, p, q)), 1e-9);
    EXPECT_GT(norm(a.cell[1].along - still.state.cell[1].along), 0.01);  // it has given way
    EXPECT_LT(worst, 1e-3);
    EXPECT_LT(worst_drifting, 1e-3);
  }
}

// m c c alone, of a gas whose particles do not touch.
TEST(CellDrift, StressIsThatOfVelocitiesBesideTheMean) {
  Specimen s = gas(4, {0.5, 0.1, 0.0});
  s.model.contact = {};
  Vec3d P;
  double M = 0.0;
  for (const ParticleId p : s.model.mass.ids()) P += s.model.mass[p] * s.state.v[p], M += s.model.mass[p];
  Tensor sum;
  for (const ParticleId p : s.model.mass.ids()) {
    const Vec3d c = s.state.v[p] - P / M;
    sum += dyad(-s.model.mass[p] / 27.0 * c, c);
  }
  const Tensor stress = cell_stress(s.model, s.state);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(norm(stress.row[k] - sum.row[k]), 1e-14);
}

// A drift along a side that is strained changes as L says, and the books know what that takes.
TEST(CellDrift, LosesTheEnergyThatTheCellTakes) {
  Specimen s = gas(5, {1.0, 0.0, 0.0});
  s.model.contact = {};
  for (Vec3d& v : s.state.v) v = {1.0, 0.0, 0.0};
  Stage stage = testing::plain_stage(0.01, 10.0);
  stage.cell.component[0] = {CellComponent::By::strain, 0.01, {}};
  double worst = 0.0;
  const State end = moved(s, stage, worst);
  // c goes down as the edge grows: dc/dt = -L c; by steps of 0.01 L with an error of second order
  const Tensor L = cell_velocity_gradient(end.cell);
  EXPECT_NEAR((end.v[ParticleId{3}] - times(L, end.r[ParticleId{3}])).x, 1.0 / 1.1, 1e-7);
  EXPECT_LT(worst, 1e-7);
  EXPECT_LT(norm(cell_stress(s.model, end).row[0]), 1e-13);
}

}  // namespace
}  // namespace vbond::cell_drift_test
