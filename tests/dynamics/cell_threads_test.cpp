// Periodic bodies that are large enough for several threads: same bits with any number of them.
#include <gtest/gtest.h>

#include <algorithm>

#include "campaigns/bodies.hpp"
#include "vbond/core/images.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/rules.hpp"

namespace vbond::cell_threads_test {
namespace {

using testing::Dice;
using testing::Specimen;

enum class Bonds { elastic, damped, breaking };

/// A cubic lattice that fills a tilted cell, thrown about.
Specimen lattice(int n, Bonds bonds) {
  std::vector<Vec3d> r;
  for (int k = 0; k < n * n * n; ++k) r.push_back({double(k % n), double(k / n % n), double(k / n / n)});
  Specimen s = testing::particles_at(r);
  const double edge = n;
  s.model.cell.edges = {Vec3d{edge, 0, 0}, {0, edge, 0}, {0, 1, edge}};
  s.model.cell.periodic = {true, true, true};
  s.state = at_rest(s.model);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.1, 0.1};
  if (bonds != Bonds::elastic) recipe.damping = {DampingBy::time, {0.1, 0.1, 0.1, 0.1}};
  if (bonds == Bonds::breaking) recipe.rules.strength = linear_strength(0.2, 0.1, 0.1, 0.1);
  for_near_images(s.state.cell, s.model.cell.periodic, s.state.r.values(), 1.1,
                  [&](std::size_t i, std::size_t j, const Image& image, double) {
                    s.state.bonds.push_back(*make_bond(recipe, bond_site(s.model, s.state, ParticleId{i}),
                                                       bond_site(s.model, s.state, ParticleId{j}, image)));
                  });
  Dice dice(3);
  for (Vec3d& v : s.state.v) v = dice.vector(0.3);
  for (Vec3d& w : s.state.omega) w = dice.vector(0.3);
  return s;
}

struct Case {
  Bonds bonds;
  bool moves = false, touches = false;
  double local_damping = 0;
};

void let_touch(ContactModel& contact) {
  contact.law = ContactLaw::hertz, contact.pairs = ContactPairs::unbonded;
  contact.E = 5.0, contact.nu = 0.2;
}

State run_until(const Model& model, const Stage& stage, State state, std::int64_t step, int threads) {
  while (state.clock.step < step) {  // images are found anew on the way
    Simulation motion(model, stage, std::move(state), threads);
    motion.run({}, step - motion.clock().step);
    state = std::move(motion).handover().state;
  }
  return state;
}

TEST(PeriodicBody, OfManyThreadsMovesBitForBit) {
  for (const Case& c : {Case{Bonds::elastic},
                        {Bonds::damped},
                        {Bonds::breaking},
                        {Bonds::damped, true},
                        {Bonds::breaking, true},
                        {Bonds::breaking, true, true}}) {
    Specimen s = lattice(20, c.bonds);
    if (c.touches) let_touch(s.model.contact);
    Stage stage = testing::plain_stage(0.05, 1e3);
    stage.local_damping = c.local_damping;
    if (c.moves) stage.cell.component[5] = {CellComponent::By::strain, 0.01, {}};
    EXPECT_GE(Simulation(s.model, stage, s.state, 2).times().threads, 2);
    const auto run = [&](int threads) { return run_until(s.model, stage, s.state, 40, threads); };
    const State one = run(1);
    EXPECT_EQ(one.breaks > 0, c.bonds == Bonds::breaking) << one.breaks;
    for (const int threads : {2, 3})
      EXPECT_EQ(run(threads), one) << "bonds " << int(c.bonds) << (c.moves ? ", moving" : "")
                                   << (c.touches ? ", touching" : "") << ", threads " << threads;
  }
}

// All bonds are of one kind: only places decide in which order loads are summed, not what is broken or which
// images there are.
TEST(PeriodicBody, OfEqualBondsGoesOnFromAnyStepBitForBit) {
  Specimen s = lattice(12, Bonds::breaking);
  let_touch(s.model.contact);
  Stage stage = testing::plain_stage(0.05, 1e3);
  stage.cell.component[5] = {CellComponent::By::strain, 0.05, {}};
  const State whole = run_until(s.model, stage, s.state, 60, 1);
  EXPECT_GT(whole.breaks, 10);
  State at = s.state;
  for (std::int64_t step = 4; step < 60; step += 4) {
    at = run_until(s.model, stage, std::move(at), step, 1);
    EXPECT_EQ(run_until(s.model, stage, at, 60, 1), whole) << "from step " << step;
  }
}

// A body in uniform motion stays without strain, whatever its number of particles: each image must go where
// its particle goes, once.
TEST(PeriodicBody, InUniformMotionStaysWithoutStrain) {
  for (const int n : {2, 5, 7, 9})
    for (const Bonds bonds : {Bonds::elastic, Bonds::damped})
      for (const bool touches : {false, true}) {
        Specimen s = lattice(n, bonds);
        if (touches) let_touch(s.model.contact);
        for (Vec3d& v : s.state.v) v = {0.3, -0.2, 0.1};
        for (Vec3d& w : s.state.omega) w = {};
        Simulation motion(s.model, testing::plain_stage(0.05, 1e3), s.state);
        motion.run({}, 10);
        // the energy of a bond is a difference of numbers near its stiffnesses, all below 1: it rounds at
        // 1e-15
        EXPECT_LE(motion.energies().potential(), 3.0 * n * n * n * 1e-15)
            << n << ", bonds " << int(bonds) << (touches ? ", touching" : "");
      }
}

}  // namespace
}  // namespace vbond::cell_threads_test
