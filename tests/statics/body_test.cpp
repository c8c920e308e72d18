// What a StaticBody says of itself under loads, and at load factors other than 0: tangent_test.cpp has the
// rest.
#include "vbond/statics/detail/body.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "bodies.hpp"
#include "vbond/statics/detail/kinds.hpp"

namespace vbond {
namespace {

using testing::fixed;
using testing::pushed;

/// A rod of four bonds, stiff in shear and bending, clamped at its first particle, under forces and moments
/// in no plane: some constant, some in proportion to the load factor, and weight.
struct BentRod {
  testing::Specimen s;
  StaticStage stage;

  BentRod() {
    BondRecipe recipe = testing::papers_bond();
    recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.2, 0.1};
    s = testing::straight_rod(5, recipe);
    stage = testing::static_stage(StageKind::equilibrium, {fixed({ParticleId{0}}, testing::clamped)},
                                  {pushed(4, {0.004, 0.01, -0.006}, {0.01, -0.03, 0.02}),
                                   pushed(2, {0.003, -0.005, 0.01}, {0.02, 0.01, 0.01})});
    stage.loads[1].constant = true;
    stage.gravity = {0.001, 0.002, -0.003};
  }
};

/// d function / d unknowns, by central differences around where the body is. `function` gives a vector.
template <class Function>
DenseMatrix derivative(StaticBody& body, double h, Function function) {
  const Placement here = body.placement();
  DenseMatrix d;
  for (int k = 0; k < body.unknowns().size(); ++k) {
    const auto at = [&](double x) {
      body.restore(here);
      body.move(x * Vector::Unit(body.unknowns().size(), k), here.load_factor);
      return Vector(function());
    };
    const Vector slope = (at(h) - at(-h)) / (2.0 * h);
    d.conservativeResize(slope.size(), k + 1);
    d.col(k) = slope;
  }
  body.restore(here);
  return d;
}

// As in tangent_test.cpp: rounding 1e-16 / h, truncation h^2 = 1e-10 times third derivatives of order 1.
constexpr double h = 1e-5, tolerance = 1e-9;

// The slope of the potential is the unbalanced load also at a load factor between 0 and 1, with constant and
// growing loads, moments, weight and what is left of the relief. A moment works on the turn as on a small
// one, which is exact for the turns of one step from the placement.
TEST(StaticBody, PotentialUnderLoadsChangesAsTheUnbalancedLoadsSay) {
  const BentRod rod;
  for (const bool relieved : {false, true})
    for (const bool constant_gravity : {false, true}) {
      StaticStage stage = rod.stage;
      stage.constant_gravity = constant_gravity;
      StaticBody body(rod.s.model, stage, rod.s.state);
      if (relieved) body.relieve();
      body.move(Vector::Constant(body.unknowns().size(), 0.02), 0.7);
      const Placement from = body.placement();
      const double energy = body.energies().potential();
      const DenseMatrix slope =
          derivative(body, h, [&] { return Vector::Constant(1, body.potential_change(from, energy)); });
      EXPECT_LE((slope.transpose() + body.unbalanced()).cwiseAbs().maxCoeff(), tolerance);
      EXPECT_NEAR(body.potential_change(from, energy), 0.0, 1e-17);  // moments of 0.03, turns known to eps
    }
}

// Of a pair of which one end can move along the bond, so that there is one unknown only.
TEST(StaticBody, OfOneUnknownStartsInBalanceWhenRelieved) {
  testing::Specimen s = testing::straight_rod(2);
  s.state.r[ParticleId{1}].x += 0.1;
  const StaticStage stage = testing::static_stage(
      StageKind::equilibrium, {fixed({ParticleId{0}}, testing::clamped),
                               fixed({ParticleId{1}}, {false, true, true, true, true, true})});
  StaticBody body(s.model, stage, s.state);
  EXPECT_NEAR(body.unbalanced()[0], -0.1, 1e-15);
  body.relieve();
  EXPECT_EQ(body.residual(), 0.0);
  EXPECT_NEAR(body.load_direction()[0], -0.1, 1e-15);
}

/// The rod in balance at full load, held by these supports besides its clamp.
std::unique_ptr<StaticBody> in_balance_under(BentRod& rod, const std::vector<Support>& supports) {
  for (const Support& s : supports) rod.stage.supports.push_back(s);
  rod.stage.newton.tolerance = 1e-13;
  rod.s.state = find_equilibrium(rod.s.model, rod.stage, rod.s.state, {}).state;
  for (PointLoad& l : rod.stage.loads) l.constant = true;
  rod.stage.constant_gravity = true;
  return std::make_unique<StaticBody>(rod.s.model, rod.stage, rod.s.state);
}

/// In balance the full tangent is the derivative of the loads, not only its symmetric part.
void expect_full_tangent(const std::vector<Support>& supports) {
  BentRod rod;
  const std::unique_ptr<StaticBody> body = in_balance_under(rod, supports);
  ASSERT_LE(body->residual(), 1e-12);
  const DenseMatrix K = -derivative(*body, h, [&] { return body->unbalanced(); });
  EXPECT_LE((DenseMatrix(body->full_tangent()) - K).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_NEAR(body->moment_part(), 0.5 * (K - K.transpose()).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_GT(body->moment_part(), 1e-3);
}

TEST(FullTangent, IsTheDerivativeOfTheLoadsUnderMomentsOfFixedDirection) {
  expect_full_tangent({});
}

// The support of particle 2 holds one turn: its moment has a fixed direction, too.
TEST(FullTangent, IsTheDerivativeOfTheLoadsWhereASupportHoldsOneTurn) {
  for (const std::size_t about : {3u, 4u, 5u}) {
    HeldDofs one{};
    one[about] = true;
    expect_full_tangent({fixed({ParticleId{2}}, one)});
  }
}

// With fewer than two free turns there is nothing that a moment could be antisymmetric with.
TEST(FullTangent, IsSymmetricWhereTwoTurnsAreHeld) {
  BentRod rod;
  const std::unique_ptr<StaticBody> body = in_balance_under(
      rod, {fixed({ParticleId{2}, ParticleId{4}}, {false, false, false, true, true, false})});
  EXPECT_FALSE(body->has_moment_part());
  EXPECT_EQ((DenseMatrix(body->full_tangent()) - DenseMatrix(body->tangent())).cwiseAbs().maxCoeff(), 0.0);
}

TEST(Placements, AreAsFarApartAsTheLargestMovementOrTurnTimesTheLength) {
  Placement a;
  a.r.assign(2, Vec3d{1, 2, 3});
  a.q.assign(2, rotation_of({0.3, -0.2, 0.5}));
  Placement b = a;
  EXPECT_EQ(distance(a, b, 2.0), 0.0);
  b.r[ParticleId{0}] += {0.3, 0, 0.4};
  b.q[ParticleId{1}] = rotation_of({0, 0.2, 0}) * a.q[ParticleId{1}];
  EXPECT_NEAR(distance(a, b, 2.0), 0.5, 1e-15);
  EXPECT_NEAR(distance(a, b, 5.0), 1.0, 1e-14);
}

/// Three particles two apart, the first two bonded: the length scale is 2.
testing::Specimen pair_and_loose_particle() {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {2, 0, 0}, {9, 0, 0}});
  testing::bond(s, 0, 1, testing::papers_bond());
  return s;
}

TEST(LargestBondChange, IsTheLargestOfStretchesTurnsAndMovementsOfLooseParticles) {
  const testing::Specimen s = pair_and_loose_particle();
  const StaticStage stage =  // turns of a loose particle are unknown where a moment drives them
      testing::static_stage(StageKind::equilibrium, {}, {pushed(2, {}, {1, 1, 1})});
  const StaticBody body(s.model, stage, s.state);
  const auto change = [&](std::vector<std::array<double, 3>> moves) {  // particle, degree of freedom, unknown
    Vector x = Vector::Zero(body.unknowns().size());
    for (const auto& [p, dof, value] : moves)
      x[body.unknowns().of(ParticleId{static_cast<std::size_t>(p)}, static_cast<int>(dof))] = value;
    return body.largest_bond_change(x);
  };
  // unknowns of turns are turns times 2, the length scale
  EXPECT_NEAR(change({{0, 0, 0.3}, {0, 1, 0.4}}), 0.25, 1e-15);
  EXPECT_NEAR(change({{0, 1, 0.4}, {1, 1, 0.4}}), 0.0, 1e-15);
  EXPECT_NEAR(change({{0, 1, 0.4}, {1, 1, -0.4}}), 0.4, 1e-15);
  EXPECT_NEAR(change({{0, 3, 0.1}, {1, 3, -0.3}}), 0.2, 1e-15);
  EXPECT_NEAR(change({{0, 5, 0.4}, {1, 5, 0.4}}), 0.0, 1e-15);
  for (const double dof : {0.0, 1.0, 2.0}) {
    EXPECT_NEAR(change({{2, dof, 0.6}}), 0.3, 1e-15);
    EXPECT_NEAR(change({{2, 3 + dof, 0.8}}), 0.4, 1e-15);
    EXPECT_NEAR(change({{1, dof, 0.6}}), 0.3, 1e-15);
    EXPECT_NEAR(change({{1, 3 + dof, 0.8}}), 0.4, 1e-15);
  }
  EXPECT_NEAR(change({{1, 1, 0.2}, {2, 4, 0.1}}), 0.1, 1e-15);
}

// c_A = 1/2: a bond stretched by 0.2 pulls with 0.1; on its second particle the load takes some of it.
TEST(StaticBody, ResidualIsTheLargestUnbalancedForceOverTheLargestForce) {
  testing::Specimen s = pair_and_loose_particle();
  s.state.r[ParticleId{1}].x += 0.2;
  const auto residual = [&s](const Vec3d& force, const Vec3d& moment) {
    const StaticStage stage = testing::static_stage(
        StageKind::equilibrium, {fixed({ParticleId{0}}, testing::clamped)}, {pushed(1, force, moment)});
    StaticBody body(s.model, stage, s.state);
    body.move(Vector::Zero(body.unknowns().size()), 1.0);
    return body.residual();
  };
  EXPECT_NEAR(residual({0.02, 0, 0}, {}), 0.8, 1e-13);
  EXPECT_NEAR(residual({-0.3, 0, 0}, {}), 4.0 / 3.0, 1e-13);
  // a moment counts over the length scale, which is that of the stretched bond: 2.2
  EXPECT_NEAR(residual({0.1, 0, 0}, {0, 0.044, 0}), 0.2, 1e-13);
  EXPECT_NEAR(residual({0.1, 0, 0}, {0, 0, 0.5}), 1.0, 1e-13);
}

// Two particles of radius 0.4 that overlap by 0.1 beside a bond: the energy of the contact is Hertz's.
TEST(StaticBody, EnergiesAreThoseOfBondsAndContacts) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {0.7, 0, 0}, {5, 0, 0}, {6, 0, 0}});
  s.model.contact = {ContactLaw::paper_hertz, ContactPairs::all, 3.0, 1.0, 0, 0};
  testing::bond(s, 2, 3, testing::papers_bond());
  s.state.r[ParticleId{3}].x += 0.02;
  const StaticStage stage = testing::static_stage(StageKind::equilibrium, {});
  const Energies e = StaticBody(s.model, stage, s.state).energies();
  EXPECT_NEAR(e.contact, 0.4 * 3.0 * std::pow(0.1, 2.5), 1e-14);
  EXPECT_NEAR(e.potential() - e.contact, 0.5 * s.state.bonds[BondId{0}].coefficients[0] * sq(0.02), 1e-15);
}

}  // namespace
}  // namespace vbond
