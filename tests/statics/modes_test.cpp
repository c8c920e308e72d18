// Validation cases D1, D7 and P1; natural frequencies of free, held and loaded bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bodies.hpp"
#include "dynamics/tops.hpp"
#include "validation/cases.hpp"
#include "validation/rings.hpp"
#include "vbond/core/error.hpp"

namespace vbond::modes_test {
namespace {

using testing::fixed;
using testing::number;
using testing::pushed;
using testing::validation_case;

std::vector<NaturalMode> modes_of(const testing::Specimen& s, int count, std::vector<Support> supports = {},
                                  std::vector<PointLoad> loads = {}) {
  StaticStage stage = testing::static_stage(StageKind::modes, std::move(supports), std::move(loads));
  stage.count = count;
  return run_static_stage(s.model, stage, s.state, {}).result.modes;
}

/// Square frames of particles one apart, bonded to neighbours along the axes.
testing::Specimen block(std::size_t nx, std::size_t ny, std::size_t nz) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < nz; ++k)
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i)
        r.push_back({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
  testing::Specimen s = testing::particles_at(r);
  const auto at = [&](std::size_t i, std::size_t j, std::size_t k) { return i + nx * (j + ny * k); };
  for (std::size_t k = 0; k < nz; ++k)
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i) {
        if (i + 1 < nx) testing::bond(s, at(i, j, k), at(i + 1, j, k), testing::papers_bond());
        if (j + 1 < ny) testing::bond(s, at(i, j, k), at(i, j + 1, k), testing::papers_bond());
        if (k + 1 < nz) testing::bond(s, at(i, j, k), at(i, j, k + 1), testing::papers_bond());
      }
  return s;
}

/// Six rigid motions, reported as exactly zero and first, and then elastic modes only.
void expect_six_rigid(const testing::Specimen& s, const char* name) {
  const std::vector<NaturalMode> modes = modes_of(s, 4);
  ASSERT_EQ(modes.size(), 10u) << name;
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_EQ(modes[k].rigid, k < 6) << name << " " << k;
    if (k < 6) {
      EXPECT_EQ(modes[k].omega2, 0.0);
    } else {
      EXPECT_GT(modes[k].omega, 1e-5) << name << " " << k;
    }
  }
}

/// The block with random moments of inertia of two of three particles, stood at random about random axes.
testing::Specimen block_of_tops() {
  testing::Specimen s = block(4, 3, 2);
  testing::Dice dice(11);
  for (const ParticleId p : s.state.r.ids())
    if (p.value % 3 != 0)
      make_top(s.model, p, {0.064 * testing::drawn_moments(dice), rotation_of(dice.vector(2.0))});
  return s;
}

TEST(Modes, OfAFreeBodyBeginWithSixRigidMotions) {
  expect_six_rigid(testing::straight_rod(10), "rod");
  expect_six_rigid(testing::ring(24, 1e6), "ring");
  expect_six_rigid(block(4, 3, 2), "block");
  expect_six_rigid(block_of_tops(), "block of tops");
}

// Nothing is left that could swing.
TEST(Modes, OfLooseParticlesAreRigidMotionsOnly) {
  for (const std::size_t particles : {1u, 3u}) {
    std::vector<Vec3d> r;
    for (std::size_t k = 0; k < particles; ++k) r.push_back({static_cast<double>(k), 0, 0});
    const std::vector<NaturalMode> modes = modes_of(testing::particles_at(r, 0.3), 4);
    EXPECT_EQ(modes.size(), 6 * particles);
    for (const NaturalMode& mode : modes) EXPECT_TRUE(mode.rigid);
  }
}

/// How far the body has moved along a mode: its displacement times the mode, weighed by mass.
double along(const NaturalMode& mode, const Model& model, const State& s) {
  double sum = 0.0;
  for (const ParticleId p : model.mass.ids())
    sum += model.mass[p] * dot(mode.shape.translation[p], s.r[p] - model.r_0[p]) +
           (model.is_top(p) ? dot(angular_momentum(model.principal[p].moments, model.principal[p].axes,
                                                   mode.shape.rotation[p]),
                                  rotation_vector(s.q[p]))
                            : model.inertia[p] * dot(mode.shape.rotation[p], rotation_vector(s.q[p])));
  return sum;
}

// Let go in a mode, a body swings along it as cos(W t), with leap-frog's W = (2 / dt) asin(omega dt / 2)
// (case D4). At an amplitude of 1e-6 forces that are not linear are 1e-6 of the others and odd ones change
// the frequency by 1e-12; even ones excite other modes to 1e-6 of the swing. Rounding of positions, 1e-15, is
// 1e-9 of it. Near a zero of the cosine that is the phase: 1e-5 in about 300 radians is 3e-8 of W, where
// omega in place of W would be off by (omega dt)^2 / 24, up to 4e-3.
void expect_swings(const testing::Specimen& s) {
  const std::vector<NaturalMode> modes = modes_of(s, 100);
  const double dt = 0.5 * exact_critical_step(s.model, s.state, {});
  for (const std::size_t k : {6u, 9u, 30u, 100u}) {
    const NaturalMode& mode = modes[k];
    ASSERT_FALSE(mode.rigid);
    State start = s.state;
    for (const ParticleId p : start.r.ids()) {
      start.r[p] += 1e-6 * mode.shape.translation[p];
      start.q[p] = rotation_of(1e-6 * mode.shape.rotation[p]);
    }
    const double W = 2.0 / dt * std::asin(mode.omega * dt / 2.0), amplitude = along(mode, s.model, start);
    const double swings = 48.25;
    const auto steps = static_cast<std::int64_t>(swings * 2.0 * M_PI / W / dt);
    Simulation run(s.model, testing::plain_stage(dt, 1e9), start);
    for (std::int64_t n = 0; n < steps; ++n) run.step();
    const double phase = W * dt * static_cast<double>(steps);
    EXPECT_NEAR(along(mode, s.model, run.state()) / amplitude, std::cos(phase), 1e-5) << "mode " << k;
    EXPECT_GT(std::abs(std::cos(phase) - std::cos(phase * mode.omega / W)),
              k == 6 ? 1e-6 : 1e-4);  // the shift can be told
  }
}
TEST(Modes, AreWhatTheTimeStepSwingsIn) {
  expect_swings(block(4, 3, 2));
  expect_swings(block_of_tops());
}

// A top at the end of a bond, whose other end is clamped, free to turn about the bond and about one axis
// across it alone: omega^2 are the eigenvalues of diag(c_T, c_B + ...) against that part of its inertia.
TEST(Modes, OfATopHaveThatPartOfItsInertiaThatIsFree) {
  testing::Specimen s = testing::straight_rod(2);
  const ParticleId end{1};
  const Quatd q = rotation_of({0.4, 0.7, -1.1}), axes = rotation_of({-0.2, 0.5, 0.3});
  const auto modes = [&](HeldDofs held) {
    return modes_of(s, 2, {fixed({ParticleId{0}}, testing::clamped), fixed({end}, held)});
  };
  const HeldDofs x_only{true, true, true, false, true, true}, y_only{true, true, true, true, false, true};
  const HeldDofs both{true, true, true, false, false, true};
  const double c_T = modes(x_only).at(0).omega2 * 0.064, k = modes(y_only).at(0).omega2 * 0.064;
  const Vec3d moments{0.1, 0.2, 0.25}, x{1, 0, 0}, y{0, 1, 0};
  make_top(s.model, end, {moments, conjugate(q) * axes});
  s.state.q[end] = q;
  s.state.bonds = {};
  testing::bond(s, 0, 1, testing::papers_bond());
  const Vec3d I_x = angular_momentum(moments, axes, x), I_y = angular_momentum(moments, axes, y);
  EXPECT_NEAR(modes(x_only).at(0).omega2, c_T / I_x.x, 1e-12);
  EXPECT_NEAR(modes(y_only).at(0).omega2, k / I_y.y, 1e-12);
  const auto found = modes(both);
  ASSERT_EQ(found.size(), 2u);
  const double det = I_x.x * I_y.y - sq(I_x.y);
  EXPECT_NEAR(found[0].omega2 * found[1].omega2, c_T * k / det, 1e-12);
  EXPECT_NEAR(found[0].omega2 + found[1].omega2, (c_T * I_y.y + k * I_x.x) / det, 1e-12);
}

// Turned and moved away the body is no longer exactly balanced in the arithmetic.
TEST(Modes, OfAFreeBodyDoNotDependOnWhereItIs) {
  testing::Specimen s = block(4, 3, 2);
  const std::vector<NaturalMode> before = modes_of(s, 4);
  const Quatd turn = rotation_of({0.3, -1.1, 0.7});
  for (const ParticleId p : s.state.r.ids()) {
    s.state.r[p] = rotate(turn, s.state.r[p]) + Vec3d{100, -50, 30};
    s.state.q[p] = turn * s.state.q[p];
  }
  const std::vector<NaturalMode> after = modes_of(s, 4);
  ASSERT_EQ(after.size(), before.size());
  // positions are rounded to 1e-14 of a bond, that is its direction, and its force by 1e-14 c_A; squares of
  // frequencies are 1e-3 and more of the largest
  for (std::size_t k = 0; k < after.size(); ++k) {
    EXPECT_EQ(after[k].rigid, before[k].rigid) << k;
    EXPECT_NEAR(after[k].omega, before[k].omega, 1e-10 * before.back().omega) << k;
  }
}

// The paper's rod, pinned: numbers of model.md, by independent code.
TEST(Modes, OfThePinnedRodAreThoseOfTheReference) {
  const std::vector<NaturalMode> modes =
      modes_of(testing::straight_rod(10), 4,
               {fixed({ParticleId{0}, ParticleId{9}}, {true, true, true, true, false, false})});
  ASSERT_EQ(modes.size(), 4u);
  for (const std::size_t k : {0u, 1u}) {  // round: in two planes
    EXPECT_NEAR(modes[k].omega / 6.06345642e-3, 1.0, 1e-8);
    EXPECT_NEAR(modes[k + 2].omega / 2.3913493243e-2, 1.0, 1e-8);
    EXPECT_FALSE(modes[k].rigid);
  }
}

/// How far the frequency nearest to this one is off it, relative.
double off(const std::vector<NaturalMode>& modes, double omega) {
  double nearest = 1.0;
  for (const NaturalMode& m : modes) nearest = std::min(nearest, std::abs(m.omega / omega - 1.0));
  return nearest;
}

// D1: all modes of chains of 32 bonds, whose wave q is that of the table's ring of 64; axial and torsional
// between clamped ends, bending between pinned ones that share half their inertia with the mirror image of
// the chain. omega_max = 2 and the slowest is 4.8e-4: eigenvalues are rounded to some 1e-15 of 4, that is to
// 1e-8 of the smallest, and frequencies to half of it.
TEST(Modes, OfAChainFollowTheDispersionRelations) {
  testing::Specimen chain = testing::straight_rod(33);
  const std::vector<ParticleId> ends{ParticleId{0}, ParticleId{32}};
  const auto clamped = modes_of(chain, 31 * 6, {fixed(ends, testing::clamped)});
  for (const ParticleId end : ends) chain.model.inertia[end] /= 2;
  const auto pinned = modes_of(chain, 31 * 6 + 4, {fixed(ends, {true, true, true, true, false, false})});
  int checked = 0;
  for (const auto& row :
       validation_case("D1")
           .at("expected")
           .at("paper rod parameters (m=a=cA=1, cB=.0025, cD=.03, cT=1/480, Theta=.064), ring of 64"))
    for (const int q : {1, 2, 4, 8, 16}) {
      if (row.at("k") != "2pi*" + std::to_string(q) + "/64") continue;
      const auto tolerance = [](double omega) { return 1e-12 + 4e-15 / (omega * omega); };
      for (const char* kind : {"omega_axial", "omega_torsion"})
        EXPECT_LT(off(clamped, number(row.at(kind))), tolerance(number(row.at(kind)))) << kind << " " << q;
      for (const char* kind : {"omega_flex_acoustic", "omega_flex_optical"})
        EXPECT_LT(off(pinned, number(row.at(kind))), tolerance(number(row.at(kind)))) << kind << " " << q;
      ++checked;
    }
  EXPECT_EQ(checked, 5);
}

// D7: each mode twice, turned by a quarter of its wave. The largest eigenvalue is 4 c_A / m = 4 EA N^2 / (2
// pi)^2, and that of omega is rounded to some eps of it.
TEST(Modes, OfARingInItsPlaneAreTheExactDiscreteOnes) {
  for (const std::size_t N : {24u, 48u, 96u}) {
    testing::Specimen ring = testing::ring(N, 1e6);
    const double a = 2 * std::sin(M_PI / static_cast<double>(N)), m = 2 * M_PI / static_cast<double>(N);
    ring.model.mass.assign(N, m);
    ring.model.inertia.assign(N, 0.1 * m * a * a);
    std::vector<Support> plane{fixed(ring.model.groups[0].particles, testing::in_plane)};
    const std::vector<NaturalMode> modes = modes_of(ring, 6, plane);
    ASSERT_EQ(modes.size(), 9u);
    const double largest = 4 * 1e6 / (a * m);
    for (std::size_t k = 0; k < 9; ++k) {
      EXPECT_EQ(modes[k].rigid, k < 3);
      if (k < 3) continue;
      const double omega =
          number(validation_case("D7").at("expected").at("discrete_N").at(std::to_string(N))[(k - 3) / 2]);
      EXPECT_NEAR(modes[k].omega / omega, 1.0, 1e-11 + 1e-15 * largest / (omega * omega)) << N << " " << k;
    }
  }
}

/// Lowest frequency of a triangular sheet with n bonds a side, its edge held in z, over 4 pi^2/h^2
/// sqrt(D/mu): a simply supported plate in the shape of a polygon swings as the membrane does, and that of
/// the equilateral triangle has the wave number 2 pi / h (Lame). mu: mass per area.
double plate_ratio(std::size_t n) {
  const double height = std::sqrt(3.0) / 2;
  std::vector<Vec3d> r;
  std::vector<ParticleId> all, edge;
  for (std::size_t row = 0; row <= n; ++row)
    for (std::size_t k = 0; k + row <= n; ++k) {
      all.emplace_back(r.size());
      if (row == 0 || k == 0 || k + row == n) edge.emplace_back(r.size());
      r.push_back(
          {static_cast<double>(k) + 0.5 * static_cast<double>(row), height * static_cast<double>(row), 0});
    }
  testing::Specimen s = testing::particles_at(r, 0.4, 1e-4);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 0.002};
  recipe.n_2 = Vec3d{0, 0, 1};
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (norm(r[j] - r[i]) < 1.1) testing::bond(s, i, j, recipe);
  const HeldDofs flat{true, true, false, false, false, true}, on_edge{true, true, true, false, false, true};
  const double omega = modes_of(s, 1, {fixed(all, flat), fixed(edge, on_edge)}).at(0).omega;
  const double D = std::sqrt(3.0) / 4 * (3 * 0.0025 + 0.002), mu = 1 / height;  // L1
  return omega / (4 * M_PI * M_PI / sq(height * static_cast<double>(n)) * std::sqrt(D / mu));
}

// P1. Bonds along the edge have no plate on their other side and stiffen it by an amount in proportion to
// 1/n; shear makes it softer in proportion to 1/n^2. Both are taken out of three sheets;
// what is left was measured: 1.4e-4.
TEST(Modes, OfATriangularPlateConvergeToThoseOfTheContinuum) {
  const double coarse = plate_ratio(12), middle = plate_ratio(24), fine = plate_ratio(48);
  EXPECT_NEAR(middle, 1.0, 0.01);
  EXPECT_NEAR((8 * fine - 6 * middle + coarse) / 3, 1.0, 2e-4);
}

/// omega^2 of the slowest mode of a cantilever under a load of this share of its critical force.
double omega2_under(double share, std::vector<NaturalMode>* modes = nullptr) {
  const testing::Specimen column = testing::rod50(20);
  const double P =
      validation_case("K2").at("expected").at("buckling_cantilever (EI=L=1,EA=4e4)").at("discrete").at("20");
  const auto found =
      modes_of(column, 4, {fixed({ParticleId{0}}, testing::clamped)}, {pushed(20, {-share * P, 0, 0})});
  if (modes) *modes = found;
  return found.at(0).omega2;
}

// Nearly linear in the load all the way, and as good as linear near the end: its curvature is some 0.01 of
// its slope per critical load, 1e-8 over 0.001 of that; P is good to 1e-10.
TEST(Modes, OfAColumnSlowDownToItsCriticalLoad) {
  const double unloaded = omega2_under(0.0), half = omega2_under(0.5), before = omega2_under(0.998),
               last = omega2_under(0.999);
  EXPECT_NEAR(half / unloaded, 0.5, 0.02);
  EXPECT_NEAR(0.999 + 0.001 * last / (before - last), 1.0, 1e-6);
}

TEST(Modes, OfABodyBeyondItsCriticalLoadAreUnstable) {
  std::vector<NaturalMode> modes;
  const double omega2 = omega2_under(1.01, &modes);
  EXPECT_LT(omega2, 0.0);
  for (const std::size_t k : {0u, 1u}) {
    EXPECT_LT(modes[k].omega2, 0.0);
    EXPECT_EQ(modes[k].omega, 0.0);
    EXPECT_FALSE(modes[k].rigid);
  }
  EXPECT_GT(modes[2].omega2, 0.0);
}

// A rod of 5 bonds that hangs from a point, turned so that no axis is along it, bonds stretched by what hangs
// below them. It swings about two axes as a compound pendulum, and spins freely about its own; stiff as it is
// it bends by g m L^2 / c_B = 1e-6 of the swing.
TEST(Modes, OfABodyThatHangsAreSwingsAndOneRigidSpin) {
  const double g = 1e-9, Theta = 0.064;
  const Quatd turn = rotation_of({0.3, -1.1, 0.7});
  const Vec3d down = rotate(turn, Vec3d{1, 0, 0});
  testing::Specimen s = testing::straight_rod(6);
  double along = 0.0, moment = 0.0, inertia = 0.0;
  for (const ParticleId p : s.state.r.ids()) {
    if (p.value > 0) along += 1.0 + g * static_cast<double>(6 - p.value);  // c_A = m = 1
    s.state.r[p] = along * down;
    s.state.q[p] = turn;
    moment += along;
    inertia += along * along + Theta;
  }
  StaticStage stage =
      testing::static_stage(StageKind::modes, {fixed({ParticleId{0}}, testing::translations)});
  stage.gravity = g * down;
  stage.count = 3;
  const auto modes = run_static_stage(s.model, stage, s.state, {}).result.modes;
  ASSERT_EQ(modes.size(), 4u);
  EXPECT_TRUE(modes[0].rigid);
  const ParticleId end{5};
  EXPECT_LT(norm(modes[0].shape.translation[end]), 1e-6);
  EXPECT_NEAR(std::abs(dot(modes[0].shape.rotation[end], down)), 1.0, 1e-6);
  for (const std::size_t k : {1u, 2u}) {
    EXPECT_FALSE(modes[k].rigid);
    EXPECT_NEAR(modes[k].omega2 / (g * moment / inertia), 1.0, 1e-5);
  }
  EXPECT_GT(modes[3].omega2, 1e3 * modes[2].omega2);
}

TEST(Modes, OfSeveralPartsHaveTheRigidMotionsOfEach) {
  testing::Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {5, 1, 0}, {9, 9, 9}});
  testing::bond(s, 0, 1, testing::papers_bond());
  testing::bond(s, 2, 3, testing::papers_bond());
  const auto modes = modes_of(s, 100);
  ASSERT_EQ(modes.size(), 30u);
  EXPECT_EQ(std::count_if(modes.begin(), modes.end(), [](const NaturalMode& m) { return m.rigid; }), 18);
  // two-body frequencies of statics.json, each part has them all; the shear mode comes in two planes
  EXPECT_NEAR(modes[29].omega, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(modes[28].omega, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(modes[27].omega, 0.5425633603552676, 1e-12);
}

TEST(Modes, AreNotThoseOfABodyThatSupportsWouldMove) {
  EXPECT_THROW(modes_of(testing::straight_rod(3), 1, {fixed({ParticleId{0}}, testing::clamped, {1, 0, 0})}),
               NoEquilibrium);
}

// A mass at which K / m overflows: no eigenvalue can be found, and the user is told which stage it was.
TEST(Modes, ThatCannotBeFoundAreAFailureOfTheirStage) {
  testing::Specimen rod = testing::straight_rod(4);
  for (double& m : rod.model.mass) m = 1e-315;
  try {
    run_static_stage(rod.model,
                     testing::static_stage(StageKind::modes, {fixed({ParticleId{0}}, testing::clamped)}),
                     rod.state, {});
    FAIL();
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("stage \"test\": modes:"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace vbond::modes_test
