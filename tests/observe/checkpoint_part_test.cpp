#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "specimen.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::Folder;

using Some = PerParticle<Vec3d>::Some;

/// A chain with bonds of several kinds, as it is made.
Chain made_chain() {
  Chain chain(7);
  chain.model.cell.edges = {{{20, 0, 0}, {0, 20, 0}, {0, 0, 20}}};
  chain.model.cell.periodic = {true, true, true};
  chain.state.cell = cell_at_start(chain.model);
  PerBond<Bond>& bonds = chain.state.bonds;
  BondRules rules;
  rules.strength = elongation_strength(0.1);
  bonds[BondId{1}].law = bonds[BondId{3}].law = &bond_law<WithRules<Evm>::Law>;
  bonds[BondId{1}].rules = &kept(rules);
  bonds[BondId{4}].coefficients.set(6, 0.25);
  set_frames(bonds[BondId{3}], rotation_of({0.1, 0.2, 0.3}), rotation_of({0.3, -0.2, 0.1}));
  set_capsule(bonds[BondId{5}], 0.2);
  set_image_of_j(bonds[BondId{3}], {0, -1, 2});
  return chain;
}

/// What a run has come to with it.
State later(const Chain& made) {
  State s = made.state;
  for (const std::size_t k : {0, 3, 4}) s.bonds[BondId{k}].broken = true;
  s.bonds[BondId{3}].mode = BreakMode::shear;
  s.bonds[BondId{5}].mode = BreakMode::tension;  // it has cracked
  for (const BondId k : s.bonds.ids()) s.bond_history.push_back({0.1 * static_cast<double>(k.value), 0.5});
  for (const ParticleId p : s.r.ids()) {
    const auto x = static_cast<double>(p.value);
    s.r[p] += Vec3d{0.1 * x, 0, 0.3}, s.omega[p] = {x, 1, 2}, s.q[p] = rotation_of({0.1 * x, 0.2, 0});
    s.loads.F.push_back({x, 2, 3}), s.loads.M.push_back({3, 2, x});
  }
  s.temperature.assign(s.r.size(), 12.5);
  s.contact_history = {{ParticleId{0}, ParticleId{2}, {0.5, -0.25}}};
  s.books.released = 0.75;
  return s;
}

/// Bonds and particles of one process.
struct Mine {
  BondsFromSetUp own;
  Some particles;  // null: all
  State made;      // of the case, with own bonds
};
Mine mine_of(const Chain& chain, const std::vector<std::size_t>& bonds,
             const std::vector<ParticleId>& particles) {
  Mine mine;
  mine.own.part.own_alone = true, mine.own.whole = chain.state.bonds.size();
  mine.made = chain.state;
  mine.made.bonds = {};
  for (const std::size_t k : bonds)
    mine.own.part.names.push_back(BondId{k}), mine.made.bonds.push_back(chain.state.bonds[BondId{k}]);
  if (!particles.empty())
    mine.particles = std::make_shared<IdSet<ParticleId>>(chain.state.r.size(), particles);
  if (mine.particles != nullptr)
    mine.made.v.hold(mine.particles), mine.made.omega.hold(mine.particles), mine.made.q.hold(mine.particles);
  return mine;
}

template <class T>
void expect_some(const PerParticle<T>& part, const PerParticle<T>& whole, const Some& some) {
  EXPECT_EQ(part.size(), whole.size());
  for (const ParticleId p : whole.ids()) {
    EXPECT_EQ(part.holds(p), some == nullptr || some->has(p));
    if (part.holds(p)) {
      EXPECT_TRUE(part[p] == whole[p]) << p.value;
    }
  }
}

// Of bonds and of what parts of a body know of particles only what is its own, and all else.
TEST(CheckpointInPart, IsWhatThePartHasOfTheWhole) {
  const Folder folder;
  const Chain chain = made_chain();
  const Checkpoint whole{later(chain), {}};
  write_checkpoint(folder / "checkpoint.h5", chain.model, whole, "1.2.3");
  const std::vector<std::vector<std::size_t>> parts{{0, 3, 4}, {1, 2}, {5}, {}, {0, 1, 2, 3, 4, 5}};
  const std::vector<std::vector<ParticleId>> particles{{ParticleId{0}, ParticleId{5}}, {}};
  for (const auto& bonds : parts)
    for (const auto& of : particles) {
      const Mine mine = mine_of(chain, bonds, of);
      const CheckpointInPart read =
          read_checkpoint(folder / "checkpoint.h5", chain.model, mine.made, mine.own);
      EXPECT_TRUE(read.same_bonds);
      const State& s = read.checkpoint.state;
      ASSERT_EQ(s.bonds.size(), bonds.size());
      ASSERT_EQ(s.bond_history.size(), bonds.size());
      for (std::size_t k = 0; k < bonds.size(); ++k) {
        EXPECT_TRUE(s.bonds[BondId{k}] == whole.state.bonds[BondId{bonds[k]}]) << bonds[k];
        EXPECT_EQ(s.bond_history[BondId{k}], whole.state.bond_history[BondId{bonds[k]}]);
      }
      expect_some(s.v, whole.state.v, mine.particles);
      expect_some(s.q, whole.state.q, mine.particles);
      expect_some(s.omega, whole.state.omega, mine.particles);
      expect_some(s.loads.F, whole.state.loads.F, mine.particles);
      State rest = whole.state, of_part = s;  // without these
      for (State* const each : {&rest, &of_part}) {
        each->bonds = {}, each->bond_history = {}, each->loads = {};
        each->v = each->omega = {};
        each->q = {};
      }
      EXPECT_TRUE(of_part == rest);
    }
}

// Whatever of a bond the case makes otherwise is seen by the part that has it, and by no other.
TEST(CheckpointInPart, TellsWhereBondsAreMadeOtherwise) {
  const Folder folder;
  const Chain chain = made_chain();
  write_checkpoint(folder / "checkpoint.h5", chain.model, {later(chain), {}}, "1.2.3");
  BondRules rules;
  rules.strength = elongation_strength(0.2);
  const std::vector<std::function<void(Bond&)>> edits{
      [](Bond& b) { b.i = ParticleId{6}; },
      [](Bond& b) { b.j = ParticleId{6}; },
      [](Bond& b) { b.law = &bond_law<VModel>; },
      [&](Bond& b) { b.rules = &kept(rules); },
      [](Bond& b) { b.a += 1e-15; },
      [](Bond& b) { b.R_i += 1e-15; },
      [](Bond& b) { b.R_j += 1e-15; },
      [](Bond& b) { b.coefficients.set(1, 0.5); },
      [](Bond& b) { b.coefficients.set(5, 0.5); },
      [](Bond& b) { b.set += 1; },
      [](Bond& b) { set_frames(b, b.frame_i, b.frame_i); },
      [](Bond& b) {
        set_frames(b, rotation_of({1, 0, 0}), frame_j(b));
      },
      [](Bond& b) { set_capsule(b, 0.1); },
      [](Bond& b) {
        set_image_of_j(b, {0, -1, 1});
      },
  };
  const auto same = [&](const Chain& edited, const std::vector<std::size_t>& bonds) {
    const Mine mine = mine_of(edited, bonds, {ParticleId{0}});
    return read_checkpoint(folder / "checkpoint.h5", chain.model, mine.made, mine.own).same_bonds;
  };
  for (std::size_t k = 0; k < edits.size(); ++k) {
    Chain edited = made_chain();
    edits[k](edited.state.bonds[BondId{3}]);
    EXPECT_FALSE(same(edited, {2, 3})) << k;
    EXPECT_TRUE(same(edited, {1, 2, 4})) << k;
  }
  Chain more = made_chain();
  more.state.bonds.push_back(more.state.bonds[BondId{2}]);
  EXPECT_FALSE(same(more, {1, 2}));
}

}  // namespace
}  // namespace vbond
