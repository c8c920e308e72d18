// Rings and arches under pressure: RG1 of the references, computed in 40 to 60 digits by programs of their
// own.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#include "bodies.hpp"
#include "vbond/core/error.hpp"
#include "vbond/terms/pressure/pressed.hpp"

namespace vbond::pressed_rings {
namespace {

using testing::Specimen;

constexpr std::size_t N = 48;

/// EI = R = 1, EA = 4e4, bonds of the length of the chord.
BondRecipe slender(double a, const BondLaw* law) {
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = BondStiffness<double>{4e4 / a, 12.0 / (a * a * a), 1.0 / a, 1.0 / 1.2 / a};
  recipe.n_2 = Vec3d{0, 0, 1};
  return recipe;
}

/// Particles on the unit circle, `count` steps of `step` from an angle on; closed: back to the first.
Specimen arc(double from, double step, std::size_t count, bool closed, const BondLaw* law) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < count + (closed ? 0 : 1); ++k) {
    const double t = from + step * static_cast<double>(k);
    r.push_back({std::cos(t), std::sin(t), 0});
  }
  Specimen s = testing::particles_at(r, 0.0);
  for (std::size_t k = 0; k < count; ++k)
    testing::bond(s, k, (k + 1) % r.size(), slender(2.0 * std::sin(0.5 * step), law));
  return s;
}
Specimen ring(const BondLaw* law = &bond_law<VModel>) {
  return arc(0.0, 2.0 * M_PI / N, N, true, law);
}

Pressure outside(const Specimen& s, PressureKind kind) {
  Pressure p;
  p.group = "ring", p.pressure = 1.0, p.kind = kind, p.across = {0, 0, 1};
  for (const Bond& b : s.state.bonds) p.facets.push_back({b.i, b.j, b.i});
  return p;
}

StaticStage plane_stage(const Specimen& s, StageKind kind, std::vector<Support> supports, PressureKind load) {
  std::vector<ParticleId> all;
  for (const ParticleId p : s.state.r.ids()) all.push_back(p);
  StaticStage stage = testing::static_stage(kind, std::move(supports));
  stage.supports.push_back(testing::fixed(all, testing::in_plane));
  stage.pressures = {outside(s, load)};
  stage.newton.tolerance = 1e-12;
  return stage;
}

constexpr HeldDofs in_x{true}, in_y{false, true}, in_x_y{true, true};
constexpr HeldDofs x_turn{true, false, false, false, false, true},
    y_turn{false, true, false, false, false, true};

Support at(std::initializer_list<std::size_t> particles, const HeldDofs& held) {
  std::vector<ParticleId> of;
  for (const std::size_t p : particles) of.push_back(ParticleId{p});
  return testing::fixed(std::move(of), held);
}

std::vector<double> critical(const Specimen& s, StaticStage stage, int count, double search_to) {
  stage.count = count;
  stage.search_to = search_to;
  stage.frames_per_mode = 0;
  std::vector<double> found;
  for (const CriticalLoad& c : run_static_stage(s.model, stage, s.state, {}).result.critical_loads)
    found.push_back(c.load_factor);
  return found;
}

// All modes of a ring are double; its rigid motions are held so that nothing else is.
TEST(RingUnderPressure, FollowerBucklesAtTheExactPressures) {
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>}) {
    const Specimen s = ring(law);
    const auto found = critical(
        s, plane_stage(s, StageKind::buckling, {at({0}, in_x_y), at({N / 2}, in_y)}, PressureKind::follower),
        4, 9.0);
    ASSERT_EQ(found.size(), 4U);
    for (const std::size_t k : {0, 1}) EXPECT_NEAR(found[k] / 3.0240133297232831, 1.0, 1e-8);
    for (const std::size_t k : {2, 3}) EXPECT_NEAR(found[k] / 8.123715777272444, 1.0, 1e-8);
  }
}

// The rigid turn is unstable under dead forces, and is held where mode 2 does not move.
TEST(RingUnderPressure, DeadBucklesAtTheExactPressure) {
  const Specimen s = ring();
  const std::vector<Support> held{at({0, N / 2}, in_y), at({N / 4, 3 * N / 4}, in_x)};
  const auto found = critical(s, plane_stage(s, StageKind::buckling, held, PressureKind::dead), 1, 5.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0] / 4.0376981859130191, 1.0, 1e-8);
}

TEST(RingUnderPressure, DeadBucklesEarlierWithOtherSupports) {
  const Specimen s = ring();
  const std::vector<Support> held{at({0}, y_turn), at({N / 4, 3 * N / 4}, in_x)};
  const auto found = critical(s, plane_stage(s, StageKind::buckling, held, PressureKind::dead), 1, 5.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0] / 3.980442951900781, 1.0, 1e-8);
}

TEST(RingUnderPressure, CentralBucklesAtTheExactPressure) {
  const Specimen s = ring();
  const std::vector<Support> held{at({0, N / 2}, in_y), at({N / 4, 3 * N / 4}, in_x)};
  const auto found = critical(s, plane_stage(s, StageKind::buckling, held, PressureKind::central), 1, 5.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0] / 4.5391888063429427, 1.0, 1e-8);
}

Specimen quarter(const BondLaw* law = &bond_law<VModel>) {
  return arc(0.0, 2.0 * M_PI / N, N / 4, false, law);
}
std::vector<Support> ends_of_quarter() {
  return {at({0}, y_turn), at({N / 4}, x_turn)};
}

// At the ends of the quarter half a bond presses, and not along the radius: of central forces what points
// along it counts, and is half of what the whole ring has there.
TEST(RingUnderPressure, QuarterBucklesAsTheRing) {
  const Specimen s = quarter();
  for (const auto& [kind, exact] : {std::pair{PressureKind::follower, 3.0240133297232831},
                                    {PressureKind::dead, 4.0376981859130191},
                                    {PressureKind::central, 4.5391888063429427}}) {
    const auto found = critical(s, plane_stage(s, StageKind::buckling, ends_of_quarter(), kind), 1, 6.0);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0] / exact, 1.0, 1e-8);
  }
}

TEST(RingUnderPressure, PostBuckledShapesAreExact) {
  struct Point {
    const BondLaw* law;
    double p, x_0, y_end, energy;
  };
  for (const Point& exact :
       {Point{&bond_law<VModel>, 3.2, 1.2070222891498725, 0.7269818165923135, 0.2110921584603829},
        Point{&bond_law<VModel>, 4.0, 1.3467094585023867, 0.34563942267050285, 1.036495867415383},
        Point{&bond_law<Evm>, 3.2, 1.2148537915217765, 0.7129618043283673, 0.23072324124154603},
        Point{&bond_law<Evm>, 4.0, 1.3536407743824226, 0.3125683108931311, 1.1202424352468132}}) {
    const Specimen s = quarter(exact.law);
    StaticStage stage = plane_stage(s, StageKind::path, ends_of_quarter(), PressureKind::follower);
    stage.path.first_step = 0.5;
    stage.path.above = exact.p;
    bool met = false;
    for (const double sense : {1.0, -1.0}) {
      stage.path.branch = BranchSwitch{1, 1, sense};
      const StaticOutcome found = run_static_stage(s.model, stage, s.state, {});
      if (found.state.r[ParticleId{0}].x < 1.0) continue;  // the branch with the y axis longer
      met = true;
      EXPECT_EQ(found.result.unstable, 0);
      EXPECT_NEAR(found.state.r[ParticleId{0}].x / exact.x_0, 1.0, 1e-8);
      EXPECT_NEAR(found.state.r[ParticleId{N / 4}].y / exact.y_end, 1.0, 1e-8);
      double U = 0.0;
      for (const BondId k : found.state.bonds.ids()) {
        const BondEnergy<double> now = bond_energy(found.state, k), rest = bond_energy(s.state, k);
        U += now.U_L + now.U_B + now.U_T - rest.U_L - rest.U_B - rest.U_T;
      }
      EXPECT_NEAR(U / exact.energy, 1.0, 1e-8);
    }
    EXPECT_TRUE(met);
  }
}

TEST(RingUnderPressure, ArchBucklesAtTheExactPressure) {
  struct Point {
    const BondLaw* law;
    PressureKind kind;
    double p;
  };
  using enum PressureKind;
  for (const Point& exact :
       {Point{&bond_law<VModel>, follower, 3.013597032821375},
        Point{&bond_law<Evm>, follower, 3.013597032568955}, Point{&bond_law<VModel>, dead, 3.290704950672298},
        Point{&bond_law<Evm>, dead, 3.290704950302102}}) {
    const double h = 1.5707963267949;
    const Specimen s = arc(0.5 * M_PI - h, 2.0 * h / 32.0, 32, false, exact.law);
    const auto found =
        critical(s, plane_stage(s, StageKind::buckling, {at({0, 32}, in_x_y)}, exact.kind), 1, 5.0);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0] / exact.p, 1.0, 1e-8);
  }
}

// A clamped strip with a free end under a follower has no energy: its flutter is not found by buckling.
TEST(RingUnderPressure, FreeEndsAreRefusedByName) {
  const Specimen s = quarter();
  const StaticStage stage = plane_stage(
      s, StageKind::buckling, {at({0}, {true, true, true, true, true, true})}, PressureKind::follower);
  try {
    run_static_stage(s.model, stage, s.state, {});
    FAIL() << "no refusal";
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("free edge at particle 12"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace vbond::pressed_rings
