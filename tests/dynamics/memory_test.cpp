#include "vbond/dynamics/step_memory.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include "rods.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond {
namespace {

using testing::plain_stage;
using testing::Specimen;
using testing::straight_rod;

/// What this program has from the allocator at present; 0 if that is one that does not tell.  [bytes]
double in_use() {
  const auto m = mallinfo2();
  return static_cast<double>(m.uordblks + m.hblkhd);
}

struct Measured {
  double bytes, estimate;
};

/// What model, state and simulation of a rod take beside what is said of them. Columns that have grown to a
/// power of two have no room to spare.
Measured memory_of_a_rod(std::size_t N, bool bonded, std::size_t tops = 0,
                         const BondRecipe& recipe = testing::papers_bond()) {
  const double before = in_use();
  Specimen s = straight_rod(N, recipe);
  if (!bonded) s.state.bonds = {};
  s.model.specimen.assign(N, 0);
  for (std::size_t k = 0; k < tops; ++k) make_top(s.model, ParticleId{k}, {{0.064, 0.07, 0.08}, {}});
  if (tops > 0) s.state.spin.assign(N, {});
  const MemoryUse use = memory_use(s.model, s.state);
  const auto n = static_cast<double>(N), bonds = static_cast<double>(s.state.bonds.size());
  const Simulation run(s.model, plain_stage(0.1, 1.0), std::move(s.state));
  return {in_use() - before, n * use.per_particle + bonds * use.per_bond};
}

/// Columns of a power of two, each below what is put into large pages: those have addresses to spare, which
/// count here and are never touched.
constexpr std::size_t particles_of_rod = std::size_t{1} << 15;

// Blocks, groups and the like take less than a hundredth of it.
TEST(MemoryUse, IsWhatARunTakes) {
  for (const bool bonded : {false, true}) {
    const Measured m = memory_of_a_rod(particles_of_rod, bonded);
    if (m.bytes == 0.0) GTEST_SKIP() << "this allocator does not tell, as under a sanitizer";
    EXPECT_NEAR(m.estimate / m.bytes, 1.0, 0.01) << (bonded ? "bonded" : "particles alone");
    EXPECT_LE(m.estimate, m.bytes) << (bonded ? "bonded" : "particles alone");
  }
}

// The same with particles whose moments of inertia differ: one of them, and all.
TEST(MemoryUse, CountsTops) {
  constexpr std::size_t N = particles_of_rod;
  for (const std::size_t tops : {std::size_t{1}, N}) {
    const Measured m = memory_of_a_rod(N, true, tops);
    if (m.bytes == 0.0) GTEST_SKIP() << "this allocator does not tell, as under a sanitizer";
    EXPECT_NEAR(m.estimate / m.bytes, 1.0, 0.01) << tops;
  }
}

// The same with a row of damping for each particle.
TEST(MemoryUse, CountsDamping) {
  BondRecipe recipe = testing::papers_bond(&bond_law<WithRules<VModel>::Law>);
  recipe.damping = {DampingBy::coefficients, {0.1, 0.1, 0.1, 0.1}};
  const Measured m = memory_of_a_rod(particles_of_rod, true, 0, recipe);
  if (m.bytes == 0.0) GTEST_SKIP() << "this allocator does not tell, as under a sanitizer";
  EXPECT_NEAR(m.estimate / m.bytes, 1.0, 0.01);
}

// One rank takes what a run takes, and what LAMMPS takes. With very many, each holds model and state of the
// whole body where it has all bonds as the stage begins, but not the rows of particles (three of 64 bytes,
// four numbers and a name), and of bonds not the constants (56 bytes of the rod's kind, and what a pack has
// besides) and the two entries of the index (8 bytes each).
TEST(MemoryUse, OfRanksIsWhatEachHoldsAsItIsMadeOrSteps) {
  constexpr std::size_t N = 1000;
  const Specimen s = straight_rod(N);
  const MemoryUse use = memory_use(s.model, s.state);
  const double bonds = N - 1, whole = N * use.per_particle + bonds * use.per_bond, atom = 110.0;
  const auto of_each = [&](int ranks, RanksKeep keep) {
    return memory_of_each_rank(s.model, s.state, bonds, ranks, keep);
  };
  const double program = of_each(1, RanksKeep::all_bonds) - whole - N * atom;
  EXPECT_NEAR(program, 53 * 0x1p20, 1e-6);
  EXPECT_DOUBLE_EQ(of_each(1, RanksKeep::own_bonds), of_each(1, RanksKeep::all_bonds));
  const auto of_own = [&](int ranks) { return of_each(ranks, RanksKeep::own_bonds) / 1.05; };
  constexpr int very_many = 1 << 20;
  const double many = of_each(very_many, RanksKeep::all_bonds) - program;
  const double rows = N * (3 * 64.0 + 4 * 8.0 + 4.0);
  EXPECT_GT(whole - many, rows + (56.0 + 16.0) * bonds);
  EXPECT_LT(whole - many, rows + (66.0 + 16.0) * bonds);
  // where ranks keep their own bonds, they have all particles as these are made: model, state, counts, marks
  const double made = of_own(very_many) - program;
  EXPECT_NEAR(made, N * (52.0 + 104.0 + 8.0 + 4.0), 1.0 + 250.0 * (1 + bonds) / very_many * N);
  // or of the state, the places alone of all
  const double placed = of_each(very_many, RanksKeep::own_motion) / 1.05 - program;
  EXPECT_NEAR(placed, made - N * 80.0, 1.0 + 4.0 * 80.0);  // of two: its own and its ghosts
  const double first = of_each(very_many, RanksKeep::own_first_places) / 1.05 - program;
  EXPECT_NEAR(first, placed - N * 24.0, 1.0 + 4.0 * 24.0);
  // as they step, own bonds with their names, own particles, and ghosts on three faces of a cube; LAMMPS has
  // gone; overlaps are looked for among all of them at once, as they are few
  const double quarter = N / 4.0,
               ghosts = 3.0 * (std::pow(2.0 * quarter, 2.0 / 3.0) - std::pow(quarter, 2.0 / 3.0));
  EXPECT_NEAR(of_own(2) - of_own(4),
              (quarter + ghosts) * (use.per_particle - 8.0 + 84.0 + 5.0) +
                  0.25 * bonds * (use.per_bond + sizeof(BondId)),
              1e-3);
}

}  // namespace
}  // namespace vbond
