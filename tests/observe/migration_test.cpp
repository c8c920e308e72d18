// Particles of a body in parts go to other parts: each part has afterwards what the whole body says of its
// own particles, their bonds and their contacts. The processes are threads here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

#include "observe/bar_in_parts.hpp"
#include "vbond/dynamics/migration.hpp"
#include "vbond/dynamics/owned_columns.hpp"

namespace vbond::parts_test {
namespace {

/// Which part has each particle, and which of all others each part asks for besides.
struct Spread {
  PerParticle<std::size_t> owner;
  std::vector<std::vector<ParticleId>> own, besides;
};

Spread spread_at_random(const State& s, std::size_t parts, testing::Dice& dice) {
  Spread spread{PerParticle<std::size_t>(s.r.size()), {}, {}};
  spread.own.resize(parts), spread.besides.resize(parts);
  const std::size_t most = 1 + dice.below(parts);  // the last parts may be left without any
  for (const ParticleId p : s.r.ids()) {
    if (is_absent(s, p)) continue;
    spread.owner[p] = dice.below(most);
    spread.own[spread.owner[p]].push_back(p);
    for (std::size_t k = 0; k < parts; ++k)
      if (k != spread.owner[p] && dice.chance(0.2)) spread.besides[k].push_back(p);
  }
  return spread;
}

void expect_the_same(const State& part, const Model& of_part, const State& whole, const Model& of_whole,
                     const std::vector<ParticleId>& particles) {
  for (const ParticleId p : particles) {
    EXPECT_TRUE(part.r[p] == whole.r[p] && part.v[p] == whole.v[p] && part.q[p] == whole.q[p] &&
                part.omega[p] == whole.omega[p])
        << p.value;
    EXPECT_TRUE(part.loads.F[p] == whole.loads.F[p] && part.loads.M[p] == whole.loads.M[p]) << p.value;
    EXPECT_TRUE(of_part.mass[p] == of_whole.mass[p] && of_part.inertia[p] == of_whole.inertia[p] &&
                of_part.r_0[p] == of_whole.r_0[p] && of_part.specimen[p] == of_whole.specimen[p])
        << p.value;
  }
}

/// What parts tell each other of bonds of which they know an end, and what one found that had all of them.
void expect_the_same(const std::vector<BondEnds>& told, const std::vector<BondEnds>& found) {
  ASSERT_EQ(told.size(), found.size());
  for (std::size_t k = 0; k < told.size(); ++k) {
    const BondEnds &a = told[k], &b = found[k];
    EXPECT_TRUE(a.name == b.name && a.i == b.i && a.j == b.j && a.image_j == b.image_j &&
                a.cracked == b.cracked);
  }
}

/// How many bonds, and rows of lists, it has.
std::size_t expect_all_of_the_own(const State& part, const PartBonds& bonds, const State& whole,
                                  const Spread& spread, std::size_t k, bool leads) {
  const auto is_own = [&](ParticleId p) { return is_absent(whole, p) ? leads : spread.owner[p] == k; };
  std::size_t n = 0, warm = 0;
  for (const BondId b : whole.bonds.ids()) {
    if (!is_own(whole.bonds[b].i)) continue;
    const BondId here{n++};
    if (n > part.bonds.size()) continue;
    EXPECT_EQ(bonds.names[here], b);
    EXPECT_TRUE(part.bonds[here] == whole.bonds[b]) << b.value;
    EXPECT_EQ(part.bond_history[here], whole.bond_history[b]);
    for (WarmBond w : whole.warm_bonds)
      if (w.bond == b) {
        w.bond = here;
        EXPECT_TRUE(warm < part.warm_bonds.size() && part.warm_bonds[warm] == w) << b.value;
        ++warm;
      }
  }
  EXPECT_EQ(n, part.bonds.size());
  EXPECT_EQ(warm, part.warm_bonds.size());
  std::vector<PairMemory> pairs;
  for (const PairMemory& m : whole.contact_history)
    if (is_own(m.i)) pairs.push_back(m);
  EXPECT_TRUE(pairs == part.contact_history);
  std::vector<WallMemory> touches;
  for (const WallMemory& m : whole.wall_history)
    if (is_own(m.p)) touches.push_back(m);
  EXPECT_TRUE(touches == part.wall_history);
  return n + pairs.size() + touches.size();
}

class Migration : public OfBars {};
INSTANTIATE_TEST_SUITE_P(, Migration, kinds_of_bars, name_of_kind);

TEST_P(Migration, BringsAllThatBelongsToAParticle) {
  const auto [touches, periodic] = GetParam();
  std::size_t moved = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    Specimen s = moved_bar(seed, touches, periodic);
    s.state.clock.stage_step = 20;  // the stage goes on
    const std::size_t processes = 2 + seed % 3;
    testing::Dice dice(seed + 100);
    const Spread spread = spread_at_random(s.state, processes, dice);
    const Spread again = spread_at_random(s.state, processes, dice);
    Meeting meeting(processes);
    std::vector<std::size_t> compared(processes);
    in_processes(processes, [&](std::size_t k) {
      Process process(meeting, k);
      State mine = s.state;
      Share share = part_of_bar(s, mine, k, processes, process.images);
      std::vector<ParticleId> before;
      for (const ParticleId p : mine.r.ids())
        if (share.order.has(p)) before.push_back(p);
      const Order order = share.order;
      Model model = s.model;
      share.model = &model;
      Simulation part(model, testing::plain_stage(0.02, 1e9), &mine, std::move(share), process);
      const State whole = part.state();
      Handover next = std::move(part).handover_of_part();
      ASSERT_TRUE(next.part);
      expect_the_same(ends_of_others(next.part->bonds.names, next.state, order, process),
                      next.part->bonds.others);
      for (const Spread* to : {&spread, &again}) {
        const std::vector<ParticleId>& own = to->own[k];
        migrate(before, own, model, next.state, *next.part, process);
        expect_the_same(next.state, model, whole, s.model, own);
        compared[k] += expect_all_of_the_own(next.state, next.part->bonds, whole, *to, k, k == 0);

        const std::vector<ParticleId>& besides = to->besides[k];
        const std::vector<int> owners = owners_of(besides, own, s.model.particles(), process);
        for (std::size_t n = 0; n < besides.size(); ++n)
          EXPECT_EQ(static_cast<std::size_t>(owners[n]), to->owner[besides[n]]);
        know_besides(besides, owners, own, model, next.state, process);
        expect_the_same(next.state, model, whole, s.model, own);
        expect_the_same(next.state, model, whole, s.model, besides);
        before = own;
      }
    });
    for (const std::size_t n : compared) moved += n;
  }
  EXPECT_GT(moved, touches ? 10000u : 9000u);
}

TEST_P(Migration, ConcernsSecondEndsOfBondsAndGhosts) {
  const auto [touches, periodic] = GetParam();
  const Specimen s = moved_bar(1, touches, periodic);
  const std::vector<ParticleId> own{ParticleId{7}, ParticleId{100}};
  State mine = s.state;
  const ImageOf ghost{ParticleId{200}, {}}, image{ParticleId{7}, {1, 0, 0}};
  const std::vector<ParticleId> others = others_to_know(own, {ghost, image}, mine);
  EXPECT_TRUE(std::is_sorted(others.begin(), others.end()));
  const auto has = [&others](ParticleId p) { return std::binary_search(others.begin(), others.end(), p); };
  EXPECT_TRUE(has(ParticleId{200}));
  for (const ParticleId p : own) EXPECT_FALSE(has(p));
  for (const Bond& b : mine.bonds)
    for (const ParticleId p : {b.i, b.j})
      EXPECT_EQ(has(p), !is_absent(mine, p) && p != own[0] && p != own[1]);
  for (const ParticleId p : absent(mine)) EXPECT_FALSE(has(p));
}

}  // namespace
}  // namespace vbond::parts_test
