// Periodic bodies in motion, against sums over explicit copies of their neighbours and what must hold for
// them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "derivative.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/images.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/rules.hpp"

namespace vbond {
namespace cell_tests {

using Random = std::mt19937_64;
double number(Random& random, double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}

struct Body {
  Model model;
  State state;
};

/// A body of n particles in a tilted cell, bonded within a distance that may be larger than the cell.
Body random_body(std::uint64_t seed, std::size_t n, const BondLaw* law, double edge, double reach,
                 bool damped = false) {
  Random random(seed);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)
    r.push_back({number(random, -edge, 2 * edge), number(random, 0, edge), number(random, 0, edge)});
  Body b{equal_particles(r, 1.3, 0.2, 0.5), {}};
  const auto tilt = [&] { return number(random, -0.3, 0.3) * edge; };
  b.model.cell.edges = {Vec3d{edge, 0, 0}, {tilt(), edge, 0}, {tilt(), tilt(), 1.1 * edge}};
  b.model.cell.periodic = {true, true, true};
  b.state = at_rest(b.model);
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.12, 0.08};
  if (damped) recipe.damping = {DampingBy::time, {0.1, 0.1, 0.1, 0.1}};
  for_near_images(b.state.cell, b.model.cell.periodic, b.state.r.values(), reach,
                  [&](std::size_t i, std::size_t j, const Image& image, double d2) {
                    if (d2 < 0.04) return;
                    const auto bond = make_bond(recipe, bond_site(b.model, b.state, ParticleId{i}),
                                                bond_site(b.model, b.state, ParticleId{j}, image));
                    b.state.bonds.push_back(*bond);
                  });
  for (const ParticleId p : b.state.r.ids()) {
    b.state.r[p] +=
        Vec3d{number(random, -0.05, 0.05), number(random, -0.05, 0.05), number(random, -0.05, 0.05)};
    b.state.q[p] =
        rotation_of({number(random, -0.1, 0.1), number(random, -0.1, 0.1), number(random, -0.1, 0.1)});
  }
  return b;
}

Stage stage_of(double dt) {
  Stage stage;
  stage.name = "motion";
  stage.dt = dt;
  stage.stops.duration = 1e6 * dt;
  return stage;
}

/// A bond as copies of its particles stand, without any function of the cell: the shift is written out.
Vec3d far_end(const State& s, const Bond& b) {
  const Vec3d &A = s.cell[0].along, &B = s.cell[1].along, &C = s.cell[2].along, &r = s.r[b.j];
  const auto at = [&](double x, double a, double bb, double c) {
    return x + image_of_j(b).a * a + image_of_j(b).b * bb + image_of_j(b).c * c;
  };
  return {at(r.x, A.x, B.x, C.x), at(r.y, A.y, B.y, C.y), at(r.z, A.z, B.z, C.z)};
}

double size_of(const PerParticle<Vec3d>& x) {
  double most = 0.0;
  for (const Vec3d& v : x) most = std::max(most, norm(v));
  return most;
}

TEST(PeriodicBody, LoadsAreThoseOfExplicitCopies) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::size_t n = 1 + seed % 7;
    const BondLaw* law = find_law(seed % 2 == 0 ? "v-model" : "evm");
    const Body b = random_body(seed, n, law, 1.0 + 0.2 * static_cast<double>(seed % 5), 1.2);
    if (b.state.bonds.empty()) continue;
    Loads sum{PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)};
    double U = 0.0;
    for (const Bond& bond : b.state.bonds) {
      const BondPose<double> pose =
          bond_pose(bond, far_end(b.state, bond) - b.state.r[bond.i], b.state.q[bond.i], b.state.q[bond.j]);
      const BondLoads<double> l = bond.law->loads(bond, pose, no_history);
      const BondEnergy<double> u = bond.law->energy(bond, pose, no_history);
      U += u.U_L + u.U_B + u.U_T;
      sum.F[bond.i] += l.F, sum.F[bond.j] -= l.F;
      sum.M[bond.i] += l.M_ij, sum.M[bond.j] += l.M_ji;
    }
    for (const int threads : {1, 3}) {
      const Simulation motion(b.model, stage_of(1e-3), b.state, threads);
      const Loads loads = motion.loads();
      double off = 0.0;
      for (const ParticleId p : sum.F.ids())
        off = std::max({off, norm(loads.F[p] - sum.F[p]), norm(loads.M[p] - sum.M[p])});
      // some hundred bonds of forces below 1, each known to some roundings of terms of the size of 1
      EXPECT_LT(off, 1e-13 * (1.0 + static_cast<double>(b.state.bonds.size()))) << "seed " << seed;
      EXPECT_NEAR(motion.energies().potential(), U, 1e-13 * (1.0 + static_cast<double>(b.state.bonds.size())))
          << "seed " << seed;
      EXPECT_GT(size_of(sum.F) + size_of(sum.M), 0.0) << "seed " << seed;
    }
  }
}

TEST(PeriodicBody, OneParticleIsBondedToItsOwnImages) {
  Body b{equal_particles({{0, 0, 0}}, 1.0, 0.1, 0.5), {}};
  b.model.cell.edges = {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  b.model.cell.periodic = {true, true, true};
  b.state = at_rest(b.model);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
  const ParticleId p{0};
  for (const Image n : {Image{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
    b.state.bonds.push_back(
        *make_bond(recipe, bond_site(b.model, b.state, p), bond_site(b.model, b.state, p, n)));
  Stage stage = stage_of(0.01);
  stage.cell.component[0] = {CellComponent::By::strain, 1e-3, {}};
  stage.cell.component[5] = {CellComponent::By::strain, 5e-4, {}};
  Simulation motion(b.model, stage, b.state);
  for (int k = 0; k < 1000; ++k) motion.step();  // F_xx - 1 = 0.01, F_xy = 0.005
  const State& s = motion.state();
  const SymmetricParts stress = symmetric_part(cell_stress(b.model, s));
  // PB1 of a simple cubic lattice: C11 = c_A/a, C44 = c_D/(2 a); to first order, so but for strains of 1 %
  EXPECT_NEAR(stress[0], 0.01, 2e-4);
  EXPECT_NEAR(stress[5], 0.175 * 0.01, 1e-4);
  EXPECT_NEAR(s.cell[0].along.x, 1.01, 1e-13);
  EXPECT_NEAR(s.cell[0].along.y, 0.005, 1e-14);
  EXPECT_NEAR(s.cell[1].along.x, 0.005, 1e-14);
  EXPECT_LT(std::abs(motion.balance_error()),
            1e-6);  // leapfrog's own error: (omega dt)^2/24 of what vibrates
}

/// dU/dH H^T / V by differences, the particles following the cell.
Tensor stress_of_energy(const Model& model, const State& s) {
  Tensor sum;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const auto energy = [&](double e) {
        State strained = s;
        const auto strain = [&](Vec3d& x) { component(x, row) += e * component(x, column); };
        for (Vec3d& r : strained.r) strain(r);
        for (CellEdge& edge : strained.cell) strain(edge.along);
        return potential_energies(model, strained).potential();
      };
      component(sum.row[static_cast<std::size_t>(row)], column) = testing::derivative(energy, 2e-3);
    }
  return (1.0 / volume(s.cell)) * sum;
}

TEST(PeriodicBody, StressIsTheDerivativeOfTheEnergy) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Body b = random_body(seed, 3 + seed % 5, find_law(seed % 2 == 0 ? "v-model" : "evm"), 1.6, 1.4);
    const Tensor by_forces = cell_stress(b.model, b.state), by_energy = stress_of_energy(b.model, b.state);
    for (std::size_t row = 0; row < 3; ++row)
      EXPECT_LT(norm(by_forces.row[row] - by_energy.row[row]), 1e-10) << "seed " << seed;  // eps/h
  }
}

TEST(PeriodicBody, StressDoesNotDependOnOriginOrCell) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Body b = random_body(seed, 4, find_law("v-model"), 1.5, 1.4);
    const Tensor stress = cell_stress(b.model, b.state);
    Body moved = b;
    for (Vec3d& r : moved.state.r) r += Vec3d{3.7, -2.2, 0.9};
    Body other = b;  // b' = a + b: the same lattice, so that n_a a + n_b b = (n_a - n_b) a + n_b b'
    other.state.cell[1].along += other.state.cell[0].along;
    for (Bond& bond : other.state.bonds) {
      Image n = image_of_j(bond);
      n.a -= n.b;
      set_image_of_j(bond, n);
    }
    for (const Body& same : {moved, other}) {
      const Tensor again = cell_stress(same.model, same.state);
      for (std::size_t row = 0; row < 3; ++row)
        EXPECT_LT(norm(again.row[row] - stress.row[row]), 1e-12) << "seed " << seed;
    }
  }
}

TEST(PeriodicBody, BooksCloseWhileTheCellMoves) {
  // The error of leapfrog and of the trapezia of the cell's work goes with dt^2.
  for (const bool damped : {false, true}) {
    std::vector<double> errors;
    for (const double dt : {0.04, 0.02, 0.01}) {
      Body b = random_body(11, 6, find_law("v-model"), 1.6, 1.4, damped);
      Stage stage = stage_of(dt);
      b.model.cell.triangular = damped;
      if (damped) stage.b_translation = 0.02, stage.local_damping = 0.1;
      stage.cell.component[0] = {CellComponent::By::strain, 0.002, {}};
      stage.cell.component[3] = {CellComponent::By::strain, -0.003, {{{0.0, 0.0}, {5.0, 1.0}}}};
      stage.cell.component[5] = {CellComponent::By::strain, 0.01, {}};
      stage.cell.component[2] = {CellComponent::By::stress, 0.02, {}};
      stage.cell.servo = {20.0, 1.0, 0.01};
      Simulation motion(b.model, stage, b.state);
      double most = 0.0;
      while (motion.clock().time() < 10.0 - 0.5 * dt) {
        motion.step();
        most = std::max(most, std::abs(motion.balance_error()));
      }
      errors.push_back(most);
    }
    EXPECT_LT(errors[2], 1e-3) << damped;
    EXPECT_NEAR(errors[0] / errors[1], 4.0, 1.0) << damped;
    EXPECT_NEAR(errors[1] / errors[2], 4.0, 1.0) << damped;
  }
}

TEST(PeriodicBody, StrainedLatticeHasNoVelocitiesOfItsOwn) {
  std::vector<Vec3d> r;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z) r.push_back({1.0 * x, 1.0 * y, 1.0 * z});
  Body b{equal_particles(r, 1.0, 0.1, 0.5), {}};
  b.model.cell.edges = {Vec3d{3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
  b.model.cell.periodic = {true, true, true};
  b.model.cell.triangular = true;
  b.state = at_rest(b.model);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.1, 0.1};
  for_near_images(b.state.cell, b.model.cell.periodic, b.state.r.values(), 1.1,
                  [&](std::size_t i, std::size_t j, const Image& n, double) {
                    b.state.bonds.push_back(*make_bond(recipe, bond_site(b.model, b.state, ParticleId{i}),
                                                       bond_site(b.model, b.state, ParticleId{j}, n)));
                  });
  ASSERT_EQ(b.state.bonds.size(), 81u);
  Stage stage = stage_of(0.05);
  stage.cell.component[0] = {CellComponent::By::strain, 0.003, {{{0.0, 0.0}, {3.0, 1.0}, {6.0, 0.0}}}};
  stage.cell.component[1] = {CellComponent::By::strain, -0.002, {}};
  Simulation motion(b.model, stage, b.state);
  for (int k = 0; k < 200; ++k) {
    motion.step();
    // centres follow the cell, by any rate: forces of 6 bonds each are off by two roundings, for a time of 10
    ASSERT_LT(motion.energies().kinetic_translation, 0.5 * 27 * std::pow(6 * 4.4e-16 * 10.0, 2))
        << "step " << k;
  }
  EXPECT_NEAR(motion.state().cell[0].along.x, 3.0 + 3.0 * 0.003 * 3.0, 1e-12);
}

/// Steps on until this step; images are found anew on the way.
State run_until(const Model& model, const Stage& stage, State state, std::int64_t step, int threads) {
  while (true) {
    Simulation motion(model, stage, std::move(state), threads);
    motion.run({}, step - motion.clock().step);
    const bool is_there = motion.clock().step == step;
    state = std::move(motion).handover().state;
    if (is_there) return state;
  }
}

/// Grains with friction, bonds that damp and break, in a cell that is sheared and gives way to stresses.
Body granular_body(std::uint64_t seed) {
  Body b = random_body(seed, 24, find_law("v-model"), 3.0, 1.0, true);
  Random random(seed + 1000);
  for (Bond& bond : b.state.bonds) {
    BondRules rules = *bond.rules;
    rules.strength = linear_strength(0.02, 0.03, 0.03, 0.03);
    bond.rules = &kept(rules);
  }
  for (Vec3d& v : b.state.v)
    v = {number(random, -0.1, 0.1), number(random, -0.1, 0.1), number(random, -0.1, 0.1)};
  ContactModel& c = b.model.contact;
  c.law = ContactLaw::hertz;
  c.pairs = ContactPairs::unbonded;
  c.E = 5.0, c.nu = 0.2;
  c.tangential = TangentialForm::mindlin;
  c.surface.friction = 0.4;
  c.damping = 0.1;
  return b;
}

double kinetic_energy_beside_cell(const Model& model, const State& s) {
  State own = s;
  for (const ParticleId p : own.v.ids()) own.v[p] -= times(cell_velocity_gradient(s.cell), s.r[p]);
  return kinetic_energy(model, own);
}

Stage shear(double dt) {
  Stage stage = stage_of(dt);
  stage.b_translation = 0.01;
  stage.local_damping = 0.05;
  stage.cell.component[0] = {CellComponent::By::strain, -0.001, {}};
  stage.cell.component[5] = {CellComponent::By::strain, 0.01, {}};
  stage.cell.component[1] = {CellComponent::By::stress, -0.05, {}};
  stage.cell.servo = {5.0, 2.0, 0.02};
  return stage;
}

TEST(PeriodicBody, GoesOnFromAnyStepBitForBit) {
  for (const bool touch : {true, false})
    for (const std::uint64_t seed : {1, 2, 3}) {
      Body b = granular_body(seed);
      if (!touch) b.model.contact = {};
      const Stage stage = shear(0.01);
      const State whole = run_until(b.model, stage, b.state, 300, 1);
      EXPECT_GT(whole.breaks, 3) << seed;
      EXPECT_EQ(whole.contact_history.empty(), !touch) << seed;
      State at = b.state;
      for (std::int64_t step = 1; step < 300; ++step) {
        at = run_until(b.model, stage, std::move(at), step, 1 + static_cast<int>(step % 3));
        if (step % 10 != 0) continue;
        ASSERT_EQ(run_until(b.model, stage, at, 300, 2), whole)
            << "seed " << seed << ", from step " << step << (touch ? ", with contacts" : "");
      }
    }
}

// What rubs through a face goes on rubbing in the next stage: without that its energy would be gone unbooked.
TEST(PeriodicBody, PairsRememberTheirSlipInTheNextStage) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Body b = granular_body(seed);
    State s = run_until(b.model, shear(0.01), b.state, 200, 1);
    const auto through_faces = std::count_if(s.contact_history.begin(), s.contact_history.end(),
                                             [](const PairMemory& m) { return !m.image_j.is_itself(); });
    ASSERT_GT(through_faces, 0) << seed;
    const double contact = Simulation(b.model, shear(0.01), s).energies().contact;
    begin_next_stage(s.clock);
    const Simulation next(b.model, stage_of(0.01), s);
    EXPECT_NEAR(next.energies().contact, contact, 1e-14 * contact) << seed;
    EXPECT_EQ(next.state().contact_history.size(), s.contact_history.size()) << seed;
  }
}

/// Grains that fall on a floor and stick to each other, in a cell that is open upwards; `times` of it along
/// a.
Body falling_body(std::uint64_t seed, int times) {
  Random random(seed);
  std::vector<Vec3d> r, v;
  for (int k = 0; k < 12; ++k) {
    r.push_back({0.8 * (k % 4) + number(random, -0.1, 0.1), 1.1 * (k / 4) + number(random, -0.1, 0.1),
                 0.6 + number(random, 0.0, 1.0)});
    v.push_back({number(random, -0.1, 0.1), number(random, -0.1, 0.1), number(random, -0.3, 0.0)});
  }
  const Vec3d a{3.2, 0, 0};
  std::vector<Vec3d> all;
  for (int copy = 0; copy < times; ++copy)
    for (const Vec3d& x : r) all.push_back(x + double(copy) * a);
  Body b{equal_particles(all, 1.0, 0.1, 0.5), {}};
  b.model.cell.edges = {double(times) * a, {0.3, 3.3, 0}, {0, 0, 5}};
  b.model.cell.periodic = {true, true, false};
  b.model.contact.law = ContactLaw::hertz;
  b.model.contact.pairs = ContactPairs::unbonded;
  b.model.contact.E = 10.0, b.model.contact.nu = 0.2;
  b.model.contact.tangential = TangentialForm::mindlin;
  b.model.contact.surface.friction = 0.4;
  b.model.walls = {{"floor", PlaneWall{{}, {0, 0, 1}}, 0, {}}};
  b.state = at_rest(b.model);
  for (const ParticleId p : b.state.v.ids()) b.state.v[p] = v[p.value % r.size()];
  return b;
}

/// Pairs within a distance are bonded, and break again.
Stage sticking(std::size_t particles) {
  Stage stage = stage_of(0.01);
  stage.gravity = {0.02, 0, -0.1};
  BondRecipe recipe;
  recipe.law = find_law("v-model");
  recipe.parameters = BondStiffness<double>{3.0, 1.0, 0.3, 0.2};
  recipe.rules.strength = linear_strength(0.05, 0.08, 0.05, 0.05);
  stage.bonding = {{"any", std::vector<char>(particles, 1), std::vector<char>(particles, 1), 0.95, recipe}};
  return stage;
}

// On a floor, with bonds made and broken through faces. What is at one place in both cells moves alike, to
// rounding that grows as grains hit each other.
TEST(PeriodicBody, MovesAlikeInACellTwiceAsLong) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Body one = falling_body(seed, 1), two = falling_body(seed, 2);
    const Stage stage_of_one = sticking(12), stage_of_two = sticking(24);
    const State s = run_until(one.model, stage_of_one, one.state, 250, 1),
                t = run_until(two.model, stage_of_two, two.state, 250, 2);
    const auto through_faces = std::count_if(s.bonds.begin(), s.bonds.end(),
                                             [](const Bond& b) { return !image_of_j(b).is_itself(); });
    EXPECT_GT(through_faces, 0) << seed;
    EXPECT_GT(s.breaks, 0) << seed;
    EXPECT_EQ(t.bonds.size(), 2 * s.bonds.size()) << seed;
    EXPECT_EQ(t.breaks, 2 * s.breaks) << seed;
    for (const ParticleId p : s.r.ids())
      for (const std::size_t copy : {0, 1}) {
        const Vec3d at = s.r[p] + double(copy) * one.model.cell.edges[0];
        EXPECT_LT(norm(t.r[ParticleId{p.value + 12 * copy}] - at), 1e-10) << seed;
      }
    EXPECT_GT(s.walls[0].force.z, -10.0);
    EXPECT_NEAR(t.walls[0].force.z, 2.0 * s.walls[0].force.z, 1e-9) << seed;
    const Simulation end(one.model, stage_of_one, s), end_of_two(two.model, stage_of_two, t);
    EXPECT_NEAR(end_of_two.energies().total(), 2.0 * end.energies().total(), 1e-9) << seed;
    EXPECT_NEAR(end_of_two.balance_error(), end.balance_error(), 1e-9) << seed;
    EXPECT_LT(std::abs(end.balance_error()), 1e-3) << seed;
  }
}

// A particle that stands near the origin hardly moves while its images come on.
TEST(PeriodicBody, ImagesThatComeNearAreFelt) {
  Body b{equal_particles({{0.01, 0, 0}}, 1.0, 0.1, 0.5), {}};
  b.model.cell.edges = {Vec3d{3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
  b.model.cell.periodic = {true, true, true};
  b.model.contact.law = ContactLaw::hertz;
  b.model.contact.E = 1.0, b.model.contact.nu = 0.0;
  b.state = at_rest(b.model);
  Stage stage = stage_of(0.01);
  stage.cell.component[0] = {CellComponent::By::strain, -0.02, {}};
  State s = b.state;
  for (int k = 1; k <= 7; ++k) {
    s = run_until(b.model, stage, std::move(s), 500 * k, 1);
    const double a = 3.0 - 0.3 * k, overlap = std::max(0.0, 1.0 - a);
    // 8/15 E* sqrt(R) delta^(5/2), E* = E/2, R = 1/4
    const Simulation now(b.model, stage, s);
    EXPECT_NEAR(now.energies().contact, 8.0 / 15.0 * 0.5 * 0.5 * std::pow(overlap, 2.5), 1e-12) << a;
    EXPECT_NEAR(s.cell[0].along.x, a, 1e-11);
    // trapezia of a work that begins at the overlap 0.1, in steps of 0.0006; no energy before that
    if (overlap > 0.0) {
      EXPECT_LT(std::abs(now.balance_error()), 1e-4) << a;
    }
  }
}

// Two that meet through a face do what they would do inside the cell, though no image was near as they began:
// by contact or by a bond, flying or brought together by the cell.
TEST(PeriodicBody, WhatComesThroughAFaceLaterIsFelt) {
  enum : int { flying, bonded, squeezed };
  for (const int how : {flying, bonded, squeezed}) {
    const auto distance_at_end = [how](double x_first, double x_second, const Image& of_second) {
      Body b{equal_particles({{x_first, 10, 10}, {x_second, 10, 10}}, 1.0, 0.1, 0.5), {}};
      b.model.cell.edges = {Vec3d{20, 0, 0}, {0, 20, 0}, {0, 0, 20}};
      b.model.cell.periodic = {true, true, true};
      Stage stage = sticking(2);
      stage.gravity = {};
      stage.dt = 0.05;
      if (how != bonded) {
        stage.bonding.clear();
        b.model.contact.law = ContactLaw::hertz;
        b.model.contact.E = 1.0, b.model.contact.nu = 0.3;
      }
      b.state = at_rest(b.model);
      b.state.v = {{-0.0997, 0, 0}, {}};
      if (how == squeezed) {  // at rest in space if they stand at 3 and 17, while the image comes on
        stage.cell.component[0] = {CellComponent::By::strain, -0.01, {}};
        b.state.v = {{0.03, 0, 0}, {0.17, 0, 0}};
      }
      const State end = run_until(b.model, stage, b.state, how == squeezed ? 700 : 1400, 1);
      EXPECT_EQ(end.bonds.size(), how == bonded ? 1u : 0u);
      return norm(between(end.r, end.cell, ParticleId{0}, ParticleId{1}, of_second));
    };
    const double inside = distance_at_end(13, 7, {}), through = distance_at_end(3, 17, {-1, 0, 0});
    EXPECT_NEAR(through, inside, 1e-9) << how;
    EXPECT_GT(inside, 0.5) << how;  // without a contact they would have gone on
    EXPECT_LT(inside, 4.0) << how;
  }
}

// Only where images may be missing is a body begun anew: in the time loop that would take all its time.
TEST(PeriodicBody, AnOpenBodyIsNeverBegunAnew) {
  for (const bool periodic : {true, false}) {
    Body b = falling_body(1, 1);
    if (!periodic) b.model.cell = {}, b.state.cell = {};
    Stage stage = stage_of(0.01);
    stage.gravity = {0.2, 0, 0};
    Simulation run(b.model, stage, b.state);
    run.run({}, 400);
    EXPECT_EQ(run.clock().step == 400, !periodic);
  }
}

TEST(PeriodicBody, ComesToRestWithItsCell) {
  Body b = random_body(5, 6, find_law("v-model"), 1.6, 1.4);
  State s = run_until(b.model, shear(0.01), b.state, 100, 1);
  ASSERT_NE(s.cell[0].rate, Vec3d{});
  begin_next_stage(s.clock);
  Stage still = stage_of(0.01);
  Support support;
  support.particles = {ParticleId{0}};
  support.held = all_held;
  still.supports = {support};
  const double own = kinetic_energy_beside_cell(b.model, s);
  Simulation motion(b.model, still, s);
  EXPECT_LE(motion.energies().kinetic(), own * (1.0 + 1e-12));
  for (int k = 0; k < 200; ++k) motion.step();
  EXPECT_EQ(motion.state().cell[0].rate, Vec3d{});
  EXPECT_LT(std::abs(motion.balance_error()), 1e-3);
}

TEST(PeriodicBody, EndsWhereItsCellHasNoVolume) {
  const auto why = [](int component, double rate, double dt) -> std::string {
    const Body b = random_body(3, 4, find_law("v-model"), 1.6, 1.4);
    Stage stage = stage_of(dt);
    stage.cell.component[static_cast<std::size_t>(component)] = {CellComponent::By::strain, rate, {}};
    Simulation motion(b.model, stage, b.state);
    try {
      for (int k = 0; k < 1000; ++k) motion.step();
    } catch (const Diverged& e) {
      return e.what();
    }
    return "";
  };
  // "its volume is ..." or, on the way there, "it strains by ... in a step"
  for (const std::string& told :
       {why(0, -1.0, 0.01), why(5, 1.0, 0.01), why(1, 100.0, 0.01)})  // xy: symmetric
    EXPECT_NE(told.find("the cell: it"), std::string::npos) << told;
  EXPECT_NE(why(2, -1e4, 0.01).find("the cell: its volume is -"), std::string::npos) << why(2, -1e4, 0.01);
}

/// D1: waves along a chain whose ends are joined through the face of its cell. From rest a linear wave goes
/// as cos(w t), where leapfrog makes 2/dt asin(w_0 dt/2) of w_0: to any time, but for the chain's own
/// curvature.
TEST(PeriodicBody, PlaneWavesHaveTheDispersionOfAChain) {
  constexpr std::size_t n = 12;
  constexpr double amplitude = 1e-7, c_A = 1.0, c_T = 0.04, Theta = 0.1, dt = 0.02;
  const auto n_pi = [](std::size_t k, std::size_t wave) {
    return 2.0 * std::numbers::pi * static_cast<double>(k * wave) / static_cast<double>(n);
  };
  for (const bool turns : {false, true})
    for (std::size_t wave = 1; wave <= n / 2; ++wave) {
      std::vector<Vec3d> r;
      for (std::size_t k = 0; k < n; ++k) r.push_back({static_cast<double>(k), 0, 0});
      Body b{equal_particles(r, 1.0, Theta, 0.5), {}};
      b.model.cell.edges = {Vec3d{n, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      b.model.cell.periodic = {true, false, false};
      b.state = at_rest(b.model);
      BondRecipe recipe;
      recipe.parameters = BondStiffness<double>{c_A, 0.3, 0.1, c_T};
      for_near_images(
          b.state.cell, b.model.cell.periodic, b.state.r.values(), 1.1,
          [&](std::size_t i, std::size_t j, const Image& image, double) {
            b.state.bonds.push_back(*make_bond(recipe, bond_site(b.model, b.state, ParticleId{i}),
                                               bond_site(b.model, b.state, ParticleId{j}, image)));
          });
      ASSERT_EQ(b.state.bonds.size(), n);
      for (std::size_t k = 0; k < n; ++k) {
        const double u = amplitude * std::cos(n_pi(k, wave));
        if (turns)
          b.state.q[ParticleId{k}] = rotation_of({u, 0, 0});
        else
          b.state.r[ParticleId{k}].x += u;
      }
      Simulation motion(b.model, stage_of(dt), b.state);
      const double w_0 = 2.0 * std::sqrt(turns ? c_T / Theta : c_A) * std::sin(0.5 * n_pi(1, wave));
      const double w = 2.0 / dt * std::asin(0.5 * w_0 * dt);
      for (int step = 1; step <= 1000; ++step) {
        motion.step();
        if (step % 100 != 0) continue;
        const State& s = motion.state();
        double found = 0.0, of_wave = 0.0;  // the part of the wave in what has become of it
        for (std::size_t k = 0; k < n; ++k) {
          const ParticleId p{k};
          const double x = turns ? rotation_vector(s.q[p]).x : s.r[p].x - b.model.r_0[p].x,
                       c = std::cos(n_pi(k, wave));
          found += x * c, of_wave += c * c;
        }
        // places are known to 1e-15, 1e-8 of the amplitude, and rounding adds up over the steps
        EXPECT_NEAR(found / of_wave / amplitude, std::cos(w * step * dt), 1e-6)
            << (turns ? "torsion" : "axial") << ", wave " << wave << ", step " << step;
      }
    }
}

}  // namespace cell_tests
}  // namespace vbond
