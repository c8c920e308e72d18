// Fracture at rest with a kept factor against factors made anew.
#include <gtest/gtest.h>

#include "campaigns/dice.hpp"
#include "fracture_bodies.hpp"
#include "vbond/model/touching.hpp"

namespace vbond {
namespace {

using testing::breakable;
using testing::broken_bonds;
using testing::clamp;
using testing::expect_books_close;
using testing::fixed;
using testing::fracture;
using testing::pushed;
using testing::Specimen;
using testing::static_stage;
using testing::unbreakable;
using testing::walk;
using testing::Walked;

/// A block of n^3 particles with scattered strengths, large enough for its factor to be kept.
Specimen scattered_block(std::size_t n, std::vector<Vec3d> further = {}) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n * n * n; ++k)
    r.push_back({static_cast<double>(k % n), static_cast<double>(k / n % n), static_cast<double>(k / n / n)});
  const std::size_t own = r.size();
  r.insert(r.end(), further.begin(), further.end());
  Specimen s = testing::particles_at(r, 0.1);
  testing::Dice dice(7);
  for (std::size_t i = 0; i < own; ++i)
    for (const std::size_t stride : {std::size_t{1}, n, n * n})
      if (i / stride % n + 1 < n)
        bond(s, i, i + stride, breakable({1.0, 0.3, 0.1, 0.1}, 0.01 * dice(0.9, 2.0)));
  return s;
}

/// Its face x = 0 is clamped, the opposite one is drawn.
std::vector<Support> drawn_faces(std::size_t n, double displacement) {
  std::vector<ParticleId> first, last;
  for (std::size_t k = 0; k < n * n; ++k)
    first.push_back(ParticleId{k * n}), last.push_back(ParticleId{k * n + n - 1});
  return {fixed(first, testing::clamped), fixed(last, testing::clamped, {displacement, 0, 0})};
}

/// That both are alike, and that the first has kept factors.
void expect_the_same(const Walked& kept, const Walked& anew) {
  EXPECT_EQ(kept.result.ended, anew.result.ended);
  EXPECT_NEAR(kept.result.load_factor, anew.result.load_factor, 1e-7);
  const FractureResult &f = fracture(kept), &g = fracture(anew);
  EXPECT_EQ(broken_bonds(f), broken_bonds(g));
  EXPECT_EQ(f.avalanches, g.avalanches);
  ASSERT_EQ(f.breaks.size(), g.breaks.size());
  for (std::size_t k = 0; k < f.breaks.size(); ++k) {
    // the utilisation at a break is 1 to 1e-10, forces are in balance to 1e-10 of the largest
    EXPECT_NEAR(f.breaks[k].use.load_factor, g.breaks[k].use.load_factor, 1e-9);
    EXPECT_NEAR(f.breaks[k].load, g.breaks[k].load, 1e-9 * g.peak_load);
    EXPECT_NEAR(f.breaks[k].released, g.breaks[k].released, 1e-8 * g.books.largest);
  }
  EXPECT_LT(kept.result.factors, anew.result.factors);
  expect_books_close(f);
}

Walked walk_by(const Specimen& s, StaticStage stage, LinearSolver solver) {
  stage.newton.solver = solver;
  return walk(s, stage);
}

TEST(KeptFactorAtRest, BreaksABlockAsNewFactorsDo) {
  constexpr std::size_t n = 9;
  const Specimen s = scattered_block(n);
  StaticStage stage = static_stage(StageKind::fracture, drawn_faces(n, 0.4));
  stage.fracture.most_breaks = 20;
  const Walked anew = walk_by(s, stage, LinearSolver::direct);
  expect_the_same(walk_by(s, stage, LinearSolver::automatic), anew);
  stage.newton.iterations = 4;  // corrections by the factor alone are more, and do not count
  expect_the_same(walk_by(s, stage, LinearSolver::automatic), anew);
}

// Beside the block, and not bonded to it, stands a straight rod that is pressed along its axis: it buckles
// after some bonds of the block have broken. No residual has a part in that mode, so that solving never meets
// it. The column of N bonds of c_B, clamped below, buckles at less than Euler's pi^2 c_B / (4 N^2).
TEST(KeptFactorAtRest, NoticesThatAStraightRodBuckles) {
  constexpr std::size_t n = 9, bonds = 10;
  std::vector<Vec3d> rod;
  for (std::size_t k = 0; k <= bonds; ++k) rod.push_back({20.0 + static_cast<double>(k), 0, 0});
  Specimen s = scattered_block(n, rod);
  const std::size_t foot = n * n * n;
  for (std::size_t k = 0; k < bonds; ++k)
    bond(s, foot + k, foot + k + 1, breakable({1.0, 0.3, 0.1, 0.1}, unbreakable));
  std::vector<Support> supports = drawn_faces(n, 0.4);
  supports.insert(supports.begin(), clamp(foot));
  const double euler = M_PI * M_PI * 0.1 / (4.0 * bonds * bonds);
  constexpr double most = 5.0;  // times that at load factor 1
  const StaticStage stage =
      static_stage(StageKind::fracture, supports, {pushed(foot + bonds, {-most * euler, 0, 0})});
  const Walked kept = walk_by(s, stage, LinearSolver::automatic);
  expect_the_same(kept, walk_by(s, stage, LinearSolver::direct));
  EXPECT_EQ(kept.result.ended, "lost stability");
  EXPECT_GT(fracture(kept).breaks.size(), 3u);
  EXPECT_GT(most * kept.result.load_factor, 0.9);
  EXPECT_LT(most * kept.result.load_factor, 1.0);
}

/// The block with particles of radii that differ, so that those one over the diagonal of a cell come to touch
/// one pair after the other as it is sheared by some 2 %.
Specimen block_that_touches(std::size_t n) {
  Specimen s = scattered_block(n);
  testing::Dice dice(11);
  for (const ParticleId p : s.model.radius.ids()) s.model.radius[p] = dice(0.67, 0.7);
  s.model.contact.law = ContactLaw::linear;
  s.model.contact.k = 0.5;
  s.model.contact.pairs = ContactPairs::unbonded;
  return s;
}

// Pairs that come to touch change the pattern of the tangent: no new factor is made for that alone.
TEST(KeptFactorAtRest, IsKeptWhereParticlesComeToTouch) {
  constexpr std::size_t n = 9;
  const Specimen s = block_that_touches(n);
  std::vector<Support> supports = drawn_faces(n, 0.0);
  supports.back().velocity = {0.1, 0.6, 0};
  StaticStage stage = static_stage(StageKind::fracture, supports);
  stage.fracture.most_breaks = 30;
  const Walked kept = walk_by(s, stage, LinearSolver::automatic);
  expect_the_same(kept, walk_by(s, stage, LinearSolver::direct));
  int touching = 0;
  for_touching_pairs(s.model, kept.last(), [&](ParticleId, ParticleId, const Image&, double) { ++touching; });
  EXPECT_GT(touching, 20);
  EXPECT_LT(kept.result.factors, 20);
}

}  // namespace
}  // namespace vbond
