#include <gtest/gtest.h>

#include <cmath>

#include "bodies.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond::tangent_test {
namespace {

/// Six particles in a heap, turned anyhow, bonded by both laws between centres and between surfaces; some
/// overlap. Nothing is in balance. Supports hold some degrees of freedom and move them.
struct Heap {
  testing::Specimen s;
  StaticStage stage = testing::static_stage(StageKind::equilibrium, {});

  Heap() {
    testing::Dice dice(5);
    const auto any = [&dice](double size) {
      return Vec3d{dice(-size, size), dice(-size, size), dice(-size, size)};
    };
    std::vector<Vec3d> r;
    for (int k = 0; k < 6; ++k) r.push_back(Vec3d{1.0 * (k % 2), 1.0 * (k / 2), 0.3 * k} + any(0.1));
    s = testing::particles_at(r, 0.7);
    s.model.contact = {ContactLaw::hertz, ContactPairs::all, 0, 1, 0.5, 0.3};
    for (std::size_t k = 0; k + 1 < 6; ++k) {
      BondRecipe recipe = testing::papers_bond(k % 2 == 0 ? &bond_law<VModel> : &bond_law<Evm>);
      recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.2, 0.1};
      if (k > 2) recipe.attachment = Attachment::given, recipe.R_i = 0.2, recipe.R_j = 0.1;
      testing::bond(s, k, k + 1, recipe);
    }
    for (const ParticleId p : s.state.r.ids()) {
      s.state.r[p] += any(0.05);
      s.state.q[p] = normalised(rotation_of(any(0.3)) * s.state.q[p]);
    }
    const Vec3d shift{0.1, 0.2, -0.3}, turn{0.0, 0.4, 0.0};
    stage.supports = {testing::fixed({ParticleId{2}}, {true, false, true, false, true, false}, shift, turn),
                      testing::fixed({ParticleId{0}}, testing::clamped, {}, {0.3, -0.2, 0.1})};
    stage.loads = {testing::pushed(4, {0.01, 0.02, 0.03}, {0.02, 0.01, -0.03})};
    stage.gravity = {0.0, 0.0, -0.02};
  }
};

/// -d unbalanced / d unknowns by central differences with this step.
DenseMatrix differences(StaticBody& body, double h) {
  const int n = body.unknowns().size();
  const Placement here = body.placement();
  DenseMatrix K(n, n);
  for (int k = 0; k < n; ++k) {
    const auto at = [&](double x) {
      body.restore(here);
      body.move(x * Vector::Unit(n, k), here.load_factor);
      return Vector(body.unbalanced());
    };
    K.col(k) = (at(-h) - at(h)) / (2.0 * h);
  }
  body.restore(here);
  return K;
}

// h = 1e-5: rounding of loads of order 1 makes 1e-16 / h = 1e-11, truncation h^2 = 1e-10 times third
// derivatives of order 1 to 10 (bonds of length 0.5 to 1; an overlap of 0.05 makes Hertz's of order 10).
constexpr double h = 1e-5, tolerance = 1e-8;

TEST(Tangent, IsTheSymmetricPartOfTheDerivativeOfTheLoads) {
  const Heap heap;
  StaticBody body(heap.s.model, heap.stage, heap.s.state);
  ASSERT_GT(body.energies().contact, 1e-3);
  const DenseMatrix K = differences(body, h);
  const DenseMatrix tangent = body.tangent();
  EXPECT_LE((tangent - 0.5 * (K + K.transpose())).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_EQ((tangent - tangent.transpose()).cwiseAbs().maxCoeff(), 0.0);
}

// The rest is half the cross product with the moment that bonds leave unbalanced, at each particle's turns.
TEST(Tangent, LeavesOutOnlyTheUnbalancedMomentsOfBonds) {
  Heap heap;
  heap.stage.loads.clear();  // what is unbalanced comes from bonds alone; gravity makes no moments
  StaticBody body(heap.s.model, heap.stage, heap.s.state);
  const DenseMatrix K = differences(body, h);
  DenseMatrix rest = 0.5 * (K - K.transpose());
  const Unknowns& u = body.unknowns();
  for (const ParticleId p : heap.s.state.r.ids()) {
    if (u.of(p, 3) == Unknowns::held || u.of(p, 4) == Unknowns::held || u.of(p, 5) == Unknowns::held)
      continue;
    const auto M = [&](int k) { return body.unbalanced()[u.of(p, 3 + k)] / u.length(); };
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      rest(u.of(p, 3 + a), u.of(p, 3 + b)) += 0.5 * M(k);
      rest(u.of(p, 3 + b), u.of(p, 3 + a)) -= 0.5 * M(k);
    }
  }
  // particle 2 is held against turning about y: the moment there is not among the unknowns
  const int x = u.of(ParticleId{2}, 3), z = u.of(ParticleId{2}, 5);
  rest(x, z) = rest(z, x) = 0.0;
  EXPECT_LE(rest.cwiseAbs().maxCoeff(), tolerance);
}

TEST(Tangent, KnowsHowLoadsChangeWithTheLoadFactor) {
  const Heap heap;
  StaticBody body(heap.s.model, heap.stage, heap.s.state);
  for (const bool relieved : {false, true}) {
    if (relieved) body.relieve();
    const Placement here = body.placement();
    const auto at = [&](double f) {
      body.restore(here);
      body.move(Vector::Zero(body.unknowns().size()), f);
      return Vector(body.unbalanced());
    };
    const Vector slope = (at(h) - at(-h)) / (2.0 * h);
    body.restore(here);
    EXPECT_LE((body.load_direction() - slope).cwiseAbs().maxCoeff(), tolerance);
  }
}

TEST(StaticBody, IsInNoBalanceWhereALoadIsNotFinite) {
  testing::Specimen rod = testing::straight_rod(3);
  rod.state.r[ParticleId{1}] = rod.state.r[ParticleId{0}];
  StaticStage stage;
  const StaticBody free(rod.model, stage, rod.state);
  stage.supports = {testing::fixed(rod.model.groups[0].particles, testing::clamped)};
  const StaticBody held(rod.model, stage, rod.state);  // nothing can be out of balance
  for (const StaticBody* body : {&free, &held}) {
    EXPECT_TRUE(std::isnan(body->residual())) << body->residual();
    EXPECT_NE(body->first_not_finite().find("bond 0 (particles 0, 1)"), std::string::npos)
        << body->first_not_finite();
    EXPECT_NE(body->first_not_finite().find("0 apart"), std::string::npos) << body->first_not_finite();
  }
}

// Bonded to points of their surfaces particles may lie on each other, and nothing is wrong.
TEST(StaticBody, MayHaveBondedParticlesWhoseCentresMeet) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {2, 0, 0}});
  BondRecipe recipe = testing::papers_bond();
  testing::bond(s, 0, 1, recipe);
  s.state.bonds[BondId{0}].R_i = s.state.bonds[BondId{0}].R_j = 0.5;
  s.state.bonds[BondId{0}].a = 1.0;
  s.state.r[ParticleId{1}] = s.state.r[ParticleId{0}];
  const StaticStage stage;
  const StaticBody body(s.model, stage, s.state);
  EXPECT_EQ(body.first_not_finite(), "");
  EXPECT_TRUE(std::isfinite(body.residual()));
  EXPECT_TRUE(std::isfinite(body.largest_bond_change(Vector::Ones(body.unknowns().size()))));
  EXPECT_TRUE(std::isfinite(body.largest_bond_change(Vector::Zero(body.unknowns().size()))));
}

TEST(MaxNorm, KeepsWhatIsNotANumberWhereverItStands) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int at = 0; at < 9; ++at) {
    Vector x = Vector::LinSpaced(9, -1.0, 2.0);
    EXPECT_EQ(max_norm(x), 2.0);
    x[at] = nan;
    EXPECT_TRUE(std::isnan(max_norm(x))) << at;
  }
  EXPECT_EQ(max_norm(Vector()), 0.0);
  EXPECT_TRUE(std::isnan(larger(nan, 1.0)) && std::isnan(larger(1.0, nan)));
  EXPECT_EQ(larger(1.0, 2.0), 2.0);
  EXPECT_EQ(larger(2.0, 1.0), 2.0);
}

TEST(StaticBody, StartsInBalanceWhenRelieved) {
  const Heap heap;
  StaticBody body(heap.s.model, heap.stage, heap.s.state);
  EXPECT_GT(body.residual(), 0.1);
  body.relieve();
  EXPECT_EQ(body.residual(), 0.0);
}

// The potential's slope is the unbalanced load: order h^2 = 1e-10 in the difference, rounding 1e-16 / h.
TEST(StaticBody, PotentialChangesAsTheUnbalancedLoadsSay) {
  const Heap heap;
  StaticBody body(heap.s.model, heap.stage, heap.s.state);
  const int n = body.unknowns().size();
  const Vector g = body.unbalanced();
  const Placement here = body.placement();
  const double energy = body.energies().potential();
  for (int k = 0; k < n; ++k) {
    const auto at = [&](double x) {
      body.restore(here);
      body.move(x * Vector::Unit(n, k), 0.0);
      return body.potential_change(here, energy);
    };
    EXPECT_NEAR((at(h) - at(-h)) / (2.0 * h), -g[k], tolerance) << body.unknowns().name(k);
  }
}

// A stout rod off the origin, clamped at one end, held along and about z at another particle, under a force,
// a moment and gravity: bonds do nothing to the body as a whole, so that what supports exert is the opposite
// of the loads, in force and in moment about the origin. Of the order of 1, and balanced to 1e-13.
TEST(StaticBody, ReactionsBalanceLoadsOfABodyInBalance) {
  testing::Specimen rod = testing::particles_at({{2, 1, 3}, {3, 1, 3}, {4, 1, 3}, {5, 1, 3}, {6, 1, 3}});
  BondRecipe recipe = testing::papers_bond();
  recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.2, 0.1};
  for (std::size_t k = 0; k + 1 < 5; ++k) testing::bond(rod, k, k + 1, recipe);
  StaticStage stage = testing::static_stage(
      StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped),
                               testing::fixed({ParticleId{3}}, {false, false, true, false, false, true})});
  stage.loads = {testing::pushed(4, {0.01, 0.02, 0.03}, {0.004, -0.003, 0.002})};
  stage.gravity = {0.0, -0.002, -0.001};
  stage.newton.tolerance = 1e-13;
  const std::vector<ParticleId> all = rod.model.groups[0].particles;
  Reaction whole, part;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) {
    whole = p.reaction(all);
    part = p.reaction({ParticleId{3}});
  };
  const State bent = run_static_stage(rod.model, stage, rod.state, hooks).state;
  Vec3d force = stage.loads[0].force, moment = stage.loads[0].moment + cross(bent.r[ParticleId{4}], force);
  for (const ParticleId p : all) {
    const Vec3d weight = rod.model.mass[p] * stage.gravity;
    force += weight;
    moment += cross(bent.r[p], weight);
  }
  EXPECT_GT(norm(bent.r[ParticleId{4}] - rod.state.r[ParticleId{4}]), 0.1);  // bent, so that arms are
  EXPECT_LE(norm(whole.force + force), 1e-13);
  EXPECT_LE(norm(whole.moment + moment), 1e-12);
  // of the second support: a force along z, and its moment about the origin beside one about z
  EXPECT_EQ(part.force.x, 0.0);
  EXPECT_EQ(part.force.y, 0.0);
  EXPECT_GT(std::abs(part.force.z), 1e-3);
  const Vec3d own = part.moment - cross(bent.r[ParticleId{3}], part.force);
  EXPECT_NEAR(own.x, 0.0, 1e-15);
  EXPECT_NEAR(own.y, 0.0, 1e-15);
  EXPECT_GT(std::abs(own.z), 1e-3);
}

}  // namespace
}  // namespace vbond::tangent_test
