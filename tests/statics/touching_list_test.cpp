#include "vbond/statics/detail/touching_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "campaigns/dice.hpp"
#include "periodic.hpp"

namespace vbond {
namespace {

using Touching = std::map<std::tuple<ParticleId, ParticleId, Image>, double>;

/// By looking at every pair of particles and images, one by one.
Touching one_by_one(const Model& model, const State& state) {
  Touching found;
  const int far = state.cell.empty() ? 0 : 2;
  const auto is_bonded = [&](ParticleId i, ParticleId j, const Image& n) {
    return std::any_of(state.bonds.begin(), state.bonds.end(), [&](const Bond& b) {
      return !b.broken &&
             ((b.i == i && b.j == j && image_of_j(b) == n) || (b.i == j && b.j == i && image_of_j(b) == -n));
    });
  };
  for (const ParticleId i : state.r.ids())
    for (const ParticleId j : state.r.ids())
      for (int a = -far; a <= far; ++a)
        for (int b = -far; b <= far; ++b)
          for (int c = -far; c <= far; ++c) {
            const Image n{a, b, c};
            if (j < i || (i == j && !(n > Image{})) || is_bonded(i, j, n)) continue;
            const double overlap = model.radius[i] + model.radius[j] - norm(between(state, i, j, n));
            if (overlap > 0.0) found[{i, j, n}] = overlap;
          }
  return found;
}

// Bodies that move by little and by much, lose bonds, and whose cell is strained: the list has what a look at
// all pairs finds, in the order of numbers.
TEST(TouchingList, HasWhatALookAtAllPairsFinds) {
  std::size_t touching = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    testing::Dice dice(seed);
    const bool periodic = dice.chance(0.5);
    std::vector<Vec3d> r;
    for (int k = 0; k < 50; ++k) r.push_back(dice.vector(1.5));
    testing::Specimen s = periodic ? testing::periodic_body(testing::cube(3.0), r) : testing::particles_at(r);
    s.model.contact.law = ContactLaw::hertz;
    s.model.contact.pairs = ContactPairs::unbonded;
    for (const ParticleId p : s.model.radius.ids()) s.model.radius[p] = dice(0.2, 0.4);
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
    testing::bond_within(s, 0.5, recipe);
    TouchingList list;
    for (int move = 0; move < 30; ++move) {
      Touching found;
      auto last = std::make_tuple(ParticleId{0}, ParticleId{0}, Image{-9, 0, 0});
      list.for_each(s.model, s.state, [&](ParticleId i, ParticleId j, const Image& n, double overlap) {
        const auto pair = std::make_tuple(i, j, n);
        EXPECT_LT(last, pair);
        last = pair, found[pair] = overlap;
      });
      const Touching wanted = one_by_one(s.model, s.state);
      ASSERT_EQ(found.size(), wanted.size()) << "seed " << seed << ", move " << move;
      for (const auto& [pair, overlap] : wanted) {
        ASSERT_TRUE(found.contains(pair)) << "seed " << seed << ", move " << move;
        EXPECT_NEAR(found[pair], overlap, 1e-15);
      }
      touching += wanted.size();
      const double step = dice.one_of({0.001, 0.005, 0.02, 0.1});
      for (const ParticleId p : s.state.r.ids()) s.state.r[p] += dice.vector(step);
      if (periodic && dice.chance(0.3)) s.state.cell[0].along.y += dice(-0.05, 0.05);
      if (!s.state.bonds.empty() && dice.chance(0.3)) {
        s.state.bonds[BondId{dice.below(s.state.bonds.size())}].broken = true;
        list.forget();
      }
    }
  }
  EXPECT_GT(touching, 10000u);
}

}  // namespace
}  // namespace vbond
