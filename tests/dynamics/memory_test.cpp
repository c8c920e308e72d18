#include "vbond/dynamics/step_memory.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include "rods.hpp"

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
Measured memory_of_a_rod(std::size_t N, bool bonded, std::size_t tops = 0) {
  const double before = in_use();
  Specimen s = straight_rod(N);
  if (!bonded) s.state.bonds = {};
  s.model.specimen.assign(N, 0);
  for (std::size_t k = 0; k < tops; ++k) make_top(s.model, ParticleId{k}, {{0.064, 0.07, 0.08}, {}});
  if (tops > 0) s.state.spin.assign(N, {});
  const MemoryUse use = memory_use(s.model, s.state);
  const auto n = static_cast<double>(N), bonds = static_cast<double>(s.state.bonds.size());
  const Simulation run(s.model, plain_stage(0.1, 1.0), std::move(s.state));
  return {in_use() - before, n * use.per_particle + bonds * use.per_bond};
}

// Blocks, groups and the like take less than a hundredth of it.
TEST(MemoryUse, IsWhatARunTakes) {
  for (const bool bonded : {false, true}) {
    const Measured m = memory_of_a_rod(std::size_t{1} << 16, bonded);
    if (m.bytes == 0.0) GTEST_SKIP() << "this allocator does not tell, as under a sanitizer";
    EXPECT_NEAR(m.estimate / m.bytes, 1.0, 0.01) << (bonded ? "bonded" : "particles alone");
    EXPECT_LE(m.estimate, m.bytes) << (bonded ? "bonded" : "particles alone");
  }
}

// The same with particles whose moments of inertia differ: one of them, and all.
TEST(MemoryUse, CountsTops) {
  constexpr std::size_t N = std::size_t{1} << 16;
  for (const std::size_t tops : {std::size_t{1}, N}) {
    const Measured m = memory_of_a_rod(N, true, tops);
    if (m.bytes == 0.0) GTEST_SKIP() << "this allocator does not tell, as under a sanitizer";
    EXPECT_NEAR(m.estimate / m.bytes, 1.0, 0.01) << tops;
  }
}

// One rank takes what a run takes. With very many, each holds model and state of the whole body where it has
// all bonds as the stage begins, but not the rows of particles (three of 64 bytes, four numbers and a name),
// and of bonds not the constants (56 bytes of the rod's kind, and what a pack has besides) and the two
// entries of the index (8 bytes each).
TEST(MemoryUse, OfRanksIsWhatEachHoldsAsAStageBegins) {
  constexpr std::size_t N = 1000;
  const Specimen s = straight_rod(N);
  const MemoryUse use = memory_use(s.model, s.state);
  const double bonds = N - 1, whole = N * use.per_particle + bonds * use.per_bond;
  for (const RanksKeep keep : {RanksKeep::all_bonds, RanksKeep::own_bonds})
    EXPECT_DOUBLE_EQ(memory_of_each_rank(s.model, s.state, bonds, 1, keep), whole);
  const double many = memory_of_each_rank(s.model, s.state, bonds, 1 << 20, RanksKeep::all_bonds);
  const double rows = N * (3 * 64.0 + 4 * 8.0 + 4.0);
  EXPECT_GT(whole - many, rows + (56.0 + 16.0) * bonds);
  EXPECT_LT(whole - many, rows + (66.0 + 16.0) * bonds);
  // where ranks keep their own bonds, there is nothing of the others, but a name for each; and of particles
  // of others the model alone, no state, no place of their row and of their entries of the index
  const double half = memory_of_each_rank(s.model, s.state, bonds, 2, RanksKeep::own_bonds);
  EXPECT_DOUBLE_EQ(whole - half,
                   0.5 * (rows + N * (104.0 + 4.0 + 16.0) + bonds * (use.per_bond - sizeof(BondId))));
}

}  // namespace
}  // namespace vbond
