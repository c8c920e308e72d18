// Fibres of periodic bodies that touch as capsules, also where they are images: against explicit copies, and
// what must hold for them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "fibres.hpp"
#include "vbond/core/images.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/fibre_rings.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/rules.hpp"

namespace vbond::periodic_capsules {
namespace {

using testing::Specimen;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
  Vec3d vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }

 private:
  std::mt19937_64 random_;
};

void bond_to(Specimen& s, const BondRecipe& recipe, std::size_t i, std::size_t j, const Image& n) {
  s.state.bonds.push_back(*make_bond(recipe, bond_site(s.model, s.state, ParticleId{i}),
                                     bond_site(s.model, s.state, ParticleId{j}, n)));
}

/// What a random mat is made of.
struct Recipe {
  ContactModel contact = testing::hertz();
  bool damped = false, breaks = false;
};

/// Bent fibres that go through the faces of a tilted cell and through one another, one without an end along
/// a, and balls. Particles stand in any cells, so that bonds join images of any kind.
Specimen mat(std::uint64_t seed, const Recipe& of) {
  Dice dice(seed);
  const double R = 0.2, l = 0.5;
  const Vec3d a{dice(2.0, 3.0), 0, 0}, b{dice(-0.5, 0.5), dice(2.0, 3.0), 0},
      c{dice(-0.5, 0.5), dice(-0.5, 0.5), dice(1.6, 2.5)};
  struct Chain {
    std::size_t first, particles;
    bool endless;
  };
  std::vector<Vec3d> r;
  std::vector<Chain> chains;
  for (int k = dice.whole(3, 5); k > 0; --k) {
    Vec3d at = dice.vector(1.0), along = normalised(dice.vector(1.0) + Vec3d{0, 0, 1e-3});
    chains.push_back({r.size(), static_cast<std::size_t>(dice.whole(2, 5)), false});
    for (std::size_t p = 0; p < chains.back().particles; ++p) {
      r.push_back(at);
      along = normalised(along + dice.vector(0.25));
      at += l * along;
    }
  }
  const auto around = static_cast<std::size_t>(std::ceil(a.x / 0.6));  // radius below the length of bonds
  chains.push_back({r.size(), around, true});
  const Vec3d begin = dice.vector(1.0);
  for (std::size_t p = 0; p < around; ++p)
    r.push_back(begin + (static_cast<double>(p) / static_cast<double>(around)) * a);
  for (int k = dice.whole(0, 3); k > 0; --k) r.push_back(dice.vector(1.0));

  Specimen s{equal_particles(r, 1.0, 0.4 * R * R, R), {}};
  s.model.contact = of.contact;
  s.model.cell.edges = {a, b, c};
  s.model.cell.periodic = {true, true, true};
  std::vector<Image> moved(r.size());
  for (std::size_t p = 0; p < r.size(); ++p) {
    moved[p] = {dice.whole(0, 1), dice.whole(0, 1), dice.whole(0, 1)};
    s.model.r_0[ParticleId{p}] =
        r[p] + double(moved[p].a) * a + double(moved[p].b) * b + double(moved[p].c) * c;
  }
  s.state = at_rest(s.model);
  BondRecipe recipe = testing::capsules(R);
  if (of.damped) recipe.damping = {DampingBy::time, {0.1, 0.1, 0.1, 0.1}};
  if (of.breaks) recipe.rules.strength = linear_strength(0.05, 0.08, 0.05, 0.05);
  for (const Chain& chain : chains) {
    for (std::size_t k = chain.first; k + 1 < chain.first + chain.particles; ++k)
      bond_to(s, recipe, k, k + 1, moved[k] - moved[k + 1]);
    const std::size_t last = chain.first + chain.particles - 1;
    if (chain.endless)
      bond_to(s, recipe, last, chain.first, moved[last] - moved[chain.first] + Image{1, 0, 0});
  }
  for (const ParticleId p : s.state.q.ids()) s.state.q[p] = rotation_of(dice.vector(0.05));
  for (Vec3d& v : s.state.v) v = dice.vector(0.1);
  return s;
}

/// Copies of all particles and bonds side by side, `n` on either side of the first one along each edge.
Specimen with_copies(const Specimen& s, int n) {
  const auto index = [n](const Image& k) {
    const int side = 2 * n + 1;
    return static_cast<std::size_t>(((k.a + n) * side + k.b + n) * side + k.c + n);
  };
  const std::size_t particles = s.model.particles();
  std::vector<Vec3d> r;
  std::vector<Image> copies;
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      for (int z = -n; z <= n; ++z) copies.push_back({x, y, z});
  for (const Image& k : copies)
    for (const Vec3d& of : s.state.r)
      r.push_back(of + double(k.a) * s.state.cell[0].along + double(k.b) * s.state.cell[1].along +
                  double(k.c) * s.state.cell[2].along);
  const ParticleId p{0};
  Specimen all{equal_particles(r, s.model.mass[p], s.model.inertia[p], s.model.radius[p]), {}};
  all.model.contact = s.model.contact;
  all.state = at_rest(all.model);
  for (const ParticleId q : all.state.q.ids()) all.state.q[q] = s.state.q[ParticleId{q.value % particles}];
  for (const Image& k : copies)
    for (Bond b : s.state.bonds) {
      const Image of_j = k + image_of_j(b);
      if (std::max({std::abs(of_j.a), std::abs(of_j.b), std::abs(of_j.c)}) > n) continue;
      b.i = ParticleId{index(k) * particles + b.i.value};
      b.j = ParticleId{index(of_j) * particles + b.j.value};
      set_image_of_j(b, {});
      all.state.bonds.push_back(b);
    }
  return all;
}

std::size_t through_faces(const Specimen& s) {
  std::size_t n = 0;
  for (const FibreContact& c : fibre_contacts(s.model, s.state))
    n += c.b.i.image.is_itself() && c.b.j.image.is_itself() && c.a.j.image.is_itself() ? 0 : 1;
  return n;
}

TEST(PeriodicCapsules, LoadsAndEnergyAreThoseOfCopies) {
  std::size_t met = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Specimen s = mat(seed, {});
    met += through_faces(s);
    constexpr int n = 4;  // what touches lies 4 units of space apart at most, and a cell further on
    const Specimen all = with_copies(s, n);
    const std::size_t particles = s.model.particles(), side = 2 * n + 1,
                      middle = particles * ((n * side + n) * side + n);
    const Loads loads = testing::loads_of(s), of_copies = testing::loads_of(all);
    double scale = 1.0;
    for (std::size_t p = 0; p < particles; ++p)
      scale = std::max(
          {scale, norm(of_copies.F[ParticleId{middle + p}]), norm(of_copies.M[ParticleId{middle + p}])});
    for (const ParticleId p : loads.F.ids()) {  // overlaps are known to some 1e-15, by stiffnesses below 100
      const ParticleId q{middle + p.value};
      EXPECT_LT(norm(loads.F[p] - of_copies.F[q]), 1e-11 * scale) << "seed " << seed << ", " << p.value;
      EXPECT_LT(norm(loads.M[p] - of_copies.M[q]), 1e-11 * scale) << "seed " << seed << ", " << p.value;
    }
    double U = 0.0;  // each contact to one half where each of its places begins
    for (const auto& [c, touching, history] : fibre_touches(all.model, all.state))
      for (const FibrePlace& place : {c.a, c.b})
        if (const std::size_t p = place.i.particle.value; p >= middle && p < middle + particles)
          U += 0.5 * c.weight *
               normal_energy(fibre_forms(all.model.contact),
                             touch_numbers(all.model, c.a.i.particle, c.b.i.particle), touching.R,
                             touching.overlap);
    EXPECT_NEAR(fibre_energy(s.model, s.state), U, 1e-12 * (1.0 + U)) << "seed " << seed;
  }
  EXPECT_GT(met, 60u);
}

/// V times the stress: the derivative of the energy by a strain of everything, by central differences.
Tensor derivative_of_energy(const Specimen& s) {
  constexpr double h = 1e-6;
  Tensor sum;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const auto energy = [&](double e) {
        State strained = s.state;
        const auto strain = [&](Vec3d& x) { component(x, row) += e * component(x, column); };
        for (Vec3d& r : strained.r) strain(r);
        for (CellEdge& edge : strained.cell) strain(edge.along);
        return potential_energies(s.model, strained).potential();
      };
      component(sum.row[static_cast<std::size_t>(row)], column) = (energy(h) - energy(-h)) / (2.0 * h);
    }
  return sum;
}

Stage moving_cell(double dt) {
  Stage stage = testing::plain_stage(dt, 1e6 * dt);
  stage.b_translation = 0.02;
  stage.cell.component[0] = {CellComponent::By::strain, -0.02, {}};
  stage.cell.component[5] = {CellComponent::By::strain, 0.03, {}};
  stage.cell.component[2] = {CellComponent::By::stress, -0.2, {}};
  stage.cell.servo = {20.0, 2.0, 0.02};
  return stage;
}

TEST(PeriodicCapsules, StressIsTheDerivativeOfTheEnergy) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Specimen s = mat(seed, {});
    s.state.v = PerParticle<Vec3d>(s.model.particles());
    const Tensor by_energy = derivative_of_energy(s);
    double scale = 1.0;
    for (const Vec3d& row : by_energy.row) scale = std::max(scale, norm(row));
    const double V = volume(s.state.cell);
    const Tensor by_forces = V * cell_stress(s.model, s.state);
    Stage still = testing::plain_stage(1e-3, 1.0);  // moves by nothing, but keeps the virial
    still.cell.component[0] = {CellComponent::By::strain, 0.0, {}};
    const State begun = Simulation(s.model, still, s.state).state();
    for (std::size_t k = 0; k < 3; ++k) {  // eps/h of energies, and h^2
      EXPECT_LT(norm(by_forces.row[k] - by_energy.row[k]), 1e-7 * scale) << "seed " << seed;
      EXPECT_LT(norm(begun.cell[k].virial - by_energy.row[k]), 1e-7 * scale) << "seed " << seed;
    }
  }
}

/// The cell's corner, and which images particles are, change nothing.
TEST(PeriodicCapsules, MoveAlikeWhereverTheirParticlesAre) {
  std::size_t touching = 0;
  std::int64_t breaks = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    Specimen one = mat(seed, {testing::rough(0.3, 0.7), true, true}), other = one;
    Dice dice(seed + 77);
    std::vector<Image> moved;
    for (const ParticleId p : other.state.r.ids()) {
      moved.push_back({dice.whole(-2, 2), dice.whole(-2, 2), dice.whole(-2, 2)});
      other.state.r[p] += to_image(other.state.cell, moved.back());
      other.model.r_0[p] = other.state.r[p];
    }
    for (Bond& b : other.state.bonds) set_image_of_j(b, image_of_j(b) + moved[b.i.value] - moved[b.j.value]);
    Stage stage = moving_cell(0.005);
    stage.b_translation = 0.0;
    Simulation a(one.model, stage, one.state), b(other.model, stage, other.state, 3);
    for (int k = 0; k < 60; ++k) a.step(), b.step();
    breaks += a.state().breaks;
    EXPECT_EQ(a.state().breaks, b.state().breaks) << seed;
    touching += a.state().fibre_history.size();
    for (const ParticleId p : one.state.r.ids())
      EXPECT_LT(norm(a.state().r[p] + to_image(a.state().cell, moved[p.value]) - b.state().r[p]), 1e-10)
          << seed << ", particle " << p.value;
    EXPECT_NEAR(a.energies().total(), b.energies().total(), 1e-9) << seed;
  }
  EXPECT_GT(touching, 5u);
  EXPECT_GT(breaks, 5);
}

TEST(PeriodicCapsules, BooksCloseWhileTheCellMoves) {
  for (const bool breaks : {false, true})
    for (const std::uint64_t seed : {3, 8}) {
      std::vector<double> errors;
      for (const double dt : {0.01, 0.005, 0.0025}) {
        const Specimen s = mat(seed, {testing::rough(0.3, 0.7), true, breaks});
        Simulation motion(s.model, moving_cell(dt), s.state);
        double most = 0.0;
        while (motion.clock().time() < 3.0 - 0.5 * dt) {
          motion.step();
          most = std::max(most, std::abs(motion.balance_error()));
        }
        EXPECT_EQ(motion.state().breaks > 0, breaks) << seed;
        errors.push_back(most);
      }
      // friction and damping of touching pairs are of first order in the step, see docs/contacts.md
      EXPECT_LT(errors[2], 0.7 * errors[0])
          << breaks << ", " << seed << ": " << errors[0] << ", " << errors[1] << ", " << errors[2];
      EXPECT_LT(errors[2], 5e-3) << breaks << ", " << seed;
    }
}

State run_to(const Specimen& s, const Stage& stage, State state, std::int64_t step, int threads) {
  while (true) {
    Simulation motion(s.model, stage, std::move(state), threads);
    motion.run({}, step - motion.clock().step);
    const bool is_there = motion.clock().step == step;
    state = std::move(motion).handover().state;
    if (is_there) return state;
  }
}

TEST(PeriodicCapsules, GoOnFromAnyStepBitForBit) {
  std::int64_t rubbing = 0;  // through faces
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Specimen s = mat(seed, {testing::rough(0.3, 0.7), true, true});
    const Stage stage = moving_cell(0.005);
    const State whole = run_to(s, stage, s.state, 200, 1);
    EXPECT_GT(whole.breaks, 0) << seed;
    for (const FibreMemory& m : whole.fibre_history)
      rubbing += !m.image_b_i.is_itself() && m.history[0] != 0.0 ? 1 : 0;
    State at = s.state;
    for (std::int64_t step = 1; step < 200; ++step) {
      at = run_to(s, stage, std::move(at), step, 1 + static_cast<int>(step % 3));
      if (step % 10 != 0) continue;
      ASSERT_EQ(run_to(s, stage, at, 200, 2), whole) << "seed " << seed << ", from step " << step;
    }
  }
  EXPECT_GT(rubbing, 0);
}

// Fibres without ends that lie along each other are not felt, and that is told; crossing ones are.
TEST(PeriodicCapsules, ContactsThatCloseToARingAreTold) {
  const auto along_each_other = [](bool endless, const Vec3d& along) {
    Specimen s{equal_particles({{0, 0, 0}, {0.5, 0, 0}, {0, 0.35, 0}, Vec3d{0, 0.35, 0} + 0.5 * along}, 1.0,
                               0.016, 0.2),
               {}};
    s.model.contact = testing::hertz();
    s.model.cell.edges = {Vec3d{1, 0, 0}, {0, 3, 0}, {0, 0, 3}};
    s.model.cell.periodic = {true, true, true};
    s.state = at_rest(s.model);
    for (const std::size_t k : {0, 2}) {
      bond_to(s, testing::capsules(0.2), k, k + 1, {});
      if (endless) bond_to(s, testing::capsules(0.2), k + 1, k, {1, 0, 0});
    }
    return s;
  };
  const Specimen ring = along_each_other(true, {1, 0, 0}), open = along_each_other(false, {1, 0, 0});
  EXPECT_EQ(fibre_energy(ring.model, ring.state), 0.0);
  const auto told = ring_of_contact(ring.model, ring.state);
  ASSERT_TRUE(told);
  EXPECT_NE(told->first, told->second);
  EXPECT_GT(fibre_energy(open.model, open.state), 0.0);
  EXPECT_FALSE(ring_of_contact(open.model, open.state));
  std::size_t rings = 0;  // a region between fibres that are deep in each other may have a hole
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Specimen s = mat(seed, {});
    rings += ring_of_contact(s.model, s.state) ? 1 : 0;
  }
  EXPECT_LT(rings, 3u);
}

/// Two fibres without ends cross at a distance, and one flies at the other through a face.
TEST(PeriodicCapsules, MeetThroughAFace) {
  Specimen s{equal_particles({{0, 0.3, 0.5}, {0.4, 0, 3.0}}, 1.0, 0.016, 0.2), {}};
  s.model.contact = testing::hertz();
  s.model.cell.edges = {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 4}};
  s.model.cell.periodic = {true, true, true};
  s.state = at_rest(s.model);
  bond_to(s, testing::capsules(0.2), 0, 0, {1, 0, 0});
  bond_to(s, testing::capsules(0.2), 1, 1, {0, 1, 0});
  s.state.v[ParticleId{1}].z = 0.5;  // from 3.0 to 4.5 - 0.4, and back
  Simulation motion(s.model, testing::plain_stage(1e-3, 1e3), s.state);
  EXPECT_EQ(motion.energies().contact, 0.0);
  double deepest = 0.0;
  for (int k = 0; k < 6000; ++k) {
    motion.step();
    deepest = std::max(deepest, motion.energies().contact);
  }
  EXPECT_NEAR(deepest, 0.5 * 0.5 * 0.25, 1e-4);  // in the frame of their mean all kinetic energy
  EXPECT_EQ(motion.energies().contact, 0.0);
  EXPECT_NEAR(motion.state().v[ParticleId{0}].z, 0.5, 1e-6);
  EXPECT_NEAR(motion.state().v[ParticleId{1}].z, 0.0, 1e-6);
}

}  // namespace
}  // namespace vbond::periodic_capsules
