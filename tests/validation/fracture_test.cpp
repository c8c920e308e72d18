// Fracture at rest against exact lists of breaks: bundles, cantilevers, chains torn off each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fracture_bodies.hpp"
#include "validation/static_bodies.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond {
namespace {

using testing::breakable;
using testing::broken_bonds;
using testing::bundle;
using testing::clamp;
using testing::drawn_bundle;
using testing::expect_books_close;
using testing::fixed;
using testing::fracture;
using testing::in_plane;
using testing::material_case;
using testing::pulled_bundle;
using testing::pushed;
using testing::Specimen;
using testing::static_stage;
using testing::unbreakable;
using testing::validation_case;
using testing::walk;
using testing::Walked;

std::vector<double> numbers(const nlohmann::json& j) {
  return j.get<std::vector<double>>();
}

// ---- the bundle of Daniels: FB1, F4 ------------------------------------------------------------------

// The utilisation at a break is 1 to 1e-10.
TEST(FibreBundle, DrawnOutBreaksAsListed) {
  const auto e = material_case("FB1")["expected"];
  constexpr double most = 2.0;
  const Walked w = walk(bundle(numbers(e["thresholds"])), drawn_bundle(most));
  const FractureResult& f = fracture(w);
  ASSERT_EQ(f.breaks.size(), 20u);
  double released = 0.0;
  for (std::size_t k = 0; k < 20; ++k) {
    const auto& row = e["displacement_control"][k];
    const BrokenBond& b = f.breaks[k];
    released += b.released;
    EXPECT_EQ(b.use.bond.value, k);
    EXPECT_EQ(b.avalanche, static_cast<int>(k) + 1);
    EXPECT_NEAR(most * b.use.load_factor, row["displacement"], 2e-10);
    EXPECT_NEAR(b.load, row["force_before"], 2e-9);
    EXPECT_NEAR(b.load_after.value(), row["force_after"], 2e-9);
    EXPECT_NEAR(released, row["released_total"], 1e-9);
    EXPECT_NEAR(b.section.N, e["thresholds"][k], 2e-10);
  }
  EXPECT_NEAR(f.peak_load, 11.368656385048194, 1e-8);
  EXPECT_NEAR(f.books.released, e["total_released"], 1e-8);
  EXPECT_EQ(w.result.ended, "parted");
  expect_books_close(f);
}

TEST(FibreBundle, UnderLoadGoesInAvalanches) {
  const auto e = material_case("FB1")["expected"];
  constexpr double most = 20.0;
  const Walked w = walk(bundle(numbers(e["thresholds"])), pulled_bundle(most));
  const FractureResult& f = fracture(w);
  const auto& avalanches = e["load_control_avalanches"];
  ASSERT_EQ(f.avalanches, static_cast<int>(avalanches.size()));
  std::size_t next = 0;
  for (std::size_t k = 0; k < avalanches.size(); ++k)
    for (int b = 0; b < avalanches[k]["bonds"].get<int>(); ++b, ++next) {
      ASSERT_LT(next, f.breaks.size());
      EXPECT_EQ(f.breaks[next].use.bond.value, next);
      EXPECT_EQ(f.breaks[next].avalanche, static_cast<int>(k) + 1);
      EXPECT_NEAR(most * f.breaks[next].load, avalanches[k]["force"], 2e-9);
    }
  EXPECT_EQ(f.breaks.size(), next);
  EXPECT_EQ(f.largest_avalanche, 16);
  EXPECT_EQ(w.result.ended, "parted");
  EXPECT_FALSE(f.breaks.back().load_after.has_value());
  expect_books_close(f);
}

// With the load lowered until one bond alone is at its strength the force goes through the list of the drawn
// bundle.
TEST(FibreBundle, UnderLoadThatIsLoweredGoesThroughTheListOfTheDrawnOne) {
  const auto e = material_case("FB1")["expected"];
  constexpr double most = 20.0;
  StaticStage stage = pulled_bundle(most);
  stage.fracture.control = FractureControl::crack;
  const Walked w = walk(bundle(numbers(e["thresholds"])), stage);
  const FractureResult& f = fracture(w);
  ASSERT_EQ(f.breaks.size(), 20u);
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_EQ(f.breaks[k].use.bond.value, k);
    EXPECT_NEAR(most * f.breaks[k].load, e["displacement_control"][k]["force_before"], 2e-9);
  }
  EXPECT_EQ(f.avalanches, 5);
  expect_books_close(f);
}

TEST(FibreBundle, OfTenCarriesItsMostWithFourBroken) {
  const auto e = validation_case("F4")["expected"];
  std::vector<double> strengths;
  for (int k = 1; k <= 10; ++k) strengths.push_back(0.1 * k);
  const FractureResult f = fracture(walk(bundle(strengths), drawn_bundle(1.5)));
  EXPECT_NEAR(f.peak_load, e["max_total_force"], 1e-9);
  const std::size_t k = e["at_k_broken"];
  EXPECT_NEAR(f.breaks.at(k).load, f.peak_load, 1e-9);
  EXPECT_LT(f.breaks.at(k - 1).load, f.peak_load - 0.1);
}

TEST(FibreBundle, EqualBondsBreakOneAfterTheOtherByNumber) {
  const Walked w = walk(bundle({1.0, 1.0, 1.0}), pulled_bundle(5.0));
  EXPECT_EQ(broken_bonds(fracture(w)), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(fracture(w).avalanches, 1);
  EXPECT_NEAR(5.0 * fracture(w).peak_load, 3.0, 1e-9);
}

// ---- limits ------------------------------------------------------------------------------------------

TEST(FractureStage, EndsAtItsLimits) {
  const auto ends = [](auto change) {
    StaticStage stage = drawn_bundle(2.0);
    change(stage.fracture);
    return walk(bundle({0.5, 1.0, 1.5}), stage);
  };
  const Walked breaks = ends([](FractureSettings& f) { f.most_breaks = 2; });
  EXPECT_EQ(breaks.result.ended, "breaks");
  EXPECT_EQ(fracture(breaks).breaks.size(), 2u);
  // the peak is 2, before the second break; 1 is left after it
  const Walked drop = ends([](FractureSettings& f) { f.load_drop = 0.4; });
  EXPECT_EQ(drop.result.ended, "load drop");
  EXPECT_EQ(fracture(drop).breaks.size(), 2u);
  const Walked factor = ends([](FractureSettings& f) { f.end = 0.3; });
  EXPECT_EQ(factor.result.ended, "load factor");
  EXPECT_EQ(fracture(factor).breaks.size(), 1u);
  EXPECT_EQ(factor.result.load_factor, 0.3);
  EXPECT_EQ(factor.seen.back().kind, PointKind::end);
}

// Two bars side by side, drawn by one support: equal, so that both are at their strength together. The other
// does not feel the break of the first, and breaks in the same avalanche.
TEST(FractureStage, BreaksMirrorImagesTogether) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {0, 3, 0}, {1, 3, 0}}, 0.1);
  testing::bond(s, 0, 1, breakable({1.0, 0.1, 0.01, 0.01}, 0.1));
  testing::bond(s, 2, 3, breakable({1.0, 0.1, 0.01, 0.01}, 0.1));
  const StaticStage stage =
      static_stage(StageKind::fracture,
                   {fixed({ParticleId{0}, ParticleId{2}}, testing::clamped),
                    fixed({ParticleId{1}, ParticleId{3}}, {true, true, true, false, true, true}, {1, 0, 0})});
  const Walked w = walk(s, stage);
  EXPECT_EQ(broken_bonds(fracture(w)), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(fracture(w).avalanches, 1);
  EXPECT_EQ(fracture(w).released_parts, 0);  // supports hold their places
  EXPECT_EQ(w.result.free_turns, 2);         // each is free to twist then
  EXPECT_EQ(w.result.ended, "parted");
  EXPECT_NEAR(fracture(w).breaks[0].load, 0.2, 1e-9);
}

// Two bars drawn by supports of their own: that the first has parted is not the end.
TEST(FractureStage, GoesOnAsLongAsAnySupportCarries) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {0, 3, 0}, {1, 3, 0}}, 0.1);
  testing::bond(s, 0, 1, breakable({1.0, 0.1, 0.01, 0.01}, 0.1));
  testing::bond(s, 2, 3, breakable({1.0, 0.1, 0.01, 0.01}, 0.3));
  constexpr HeldDofs but_twist{true, true, true, false, true, true};
  const Walked w =
      walk(s, static_stage(StageKind::fracture, {fixed({ParticleId{0}, ParticleId{2}}, testing::clamped),
                                                 fixed({ParticleId{1}}, but_twist, {1, 0, 0}),
                                                 fixed({ParticleId{3}}, but_twist, {1, 0, 0})}));
  EXPECT_EQ(broken_bonds(fracture(w)), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(w.result.ended, "parted");
  EXPECT_NEAR(fracture(w).breaks[1].use.load_factor, 0.3, 1e-9);
}

// A truss of two bars that snaps through before it breaks: no stable balance is found beyond the limit point
// of its path, which is met from below to 1e-7 of the load factor.
TEST(FractureStage, SaysWhereStabilityIsLost) {
  Specimen s = testing::particles_at({{-1, 0, 0}, {0, 0.1, 0}, {1, 0, 0}}, 0.01);
  for (const std::size_t end : {0u, 2u}) testing::bond(s, 1, end, breakable({1.0, 1e-5, 1e-5, 1e-5}, 1.0));
  StaticStage stage =
      static_stage(StageKind::path,
                   {fixed({ParticleId{0}, ParticleId{1}, ParticleId{2}}, in_plane),
                    fixed({ParticleId{0}, ParticleId{2}}, {true, true, false, false, false, false})},
                   {pushed(1, {0, -1e-2, 0})});
  stage.path.first_step = 1e-3;
  stage.path.above = 0.05;
  const Walked path = walk(s, stage);
  ASSERT_FALSE(path.result.special_points.empty());
  ASSERT_EQ(path.result.special_points[0].kind, PointKind::limit_point);
  const double limit = path.result.special_points[0].load_factor;
  stage.kind = StageKind::fracture;
  const Walked w = walk(s, stage);
  EXPECT_EQ(w.result.ended, "lost stability");
  EXPECT_NE(fracture(w).reason, "");
  EXPECT_TRUE(fracture(w).breaks.empty());
  EXPECT_NEAR(w.result.load_factor, limit, 1e-6);
  EXPECT_LE(w.result.load_factor, limit);
}

// Bonds do not break in other static stages: that one should have is said.
TEST(FractureStage, EquilibriumBeyondStrengthSaysSo) {
  StaticStage stage = drawn_bundle(1.2);
  stage.kind = StageKind::equilibrium;
  std::string told;
  StaticHooks hooks;
  hooks.tell = [&told](const std::string& text) { told += text + '\n'; };
  const Specimen s = bundle({2.0, 0.8});
  const StaticResult r = run_static_stage(s.model, stage, s.state, hooks).result;
  ASSERT_TRUE(r.most_used.has_value());
  EXPECT_EQ(r.most_used->bond, BondId{1});
  EXPECT_NEAR(r.most_used->utilisation, 1.5, 1e-12);
  EXPECT_NE(told.find("past its strength"), std::string::npos) << told;
  stage.supports[1].velocity = {0.7, 0, 0};
  told.clear();
  EXPECT_NEAR(run_static_stage(s.model, stage, s.state, hooks).result.most_used->utilisation, 0.875, 1e-12);
  EXPECT_EQ(told, "");
}

// ---- beams -------------------------------------------------------------------------------------------

// F2: P = M_c / L by the moment at the end of the bond, M_c / (L - a/2) by that at its middle. The load is so
// small that the rod stays straight to 1e-4.
TEST(Cantilever, BreaksAtItsClampUnderTheExactLoad) {
  constexpr double M_c = 1e-3;
  const Section section{4e4 / 4e4, 1 / 4e4, 2 / 4e4, 0.02};
  for (const auto& row : validation_case("F2")["expected"]["rows"]) {
    const std::size_t n = row["nb"];
    for (const bool end : {true, false}) {
      BondRecipe recipe = testing::rod50_bond();
      recipe.law = &bond_law<WithRules<VModel>::Law>;
      const double limit = M_c * section.r / section.J;
      recipe.rules.strength =
          end ? fibre_strength(section, limit, unbreakable) : stress_strength(section, limit, unbreakable);
      std::vector<Vec3d> r;
      for (std::size_t k = 0; k <= n; ++k)
        r.push_back({static_cast<double>(k) / static_cast<double>(n), 0, 0});
      Specimen s = testing::particles_at(r, 0.1 / static_cast<double>(n));
      for (std::size_t k = 0; k < n; ++k) testing::bond(s, k, k + 1, recipe);
      const double expected =
          row[end ? "P_break_end_moment" : "P_break_centre_moment"].get<double>() / 100.0;  // of M_c / L
      const FractureResult f =
          fracture(walk(s, static_stage(StageKind::fracture, {clamp(0)}, {pushed(n, {0, 2 * M_c, 0})})));
      ASSERT_EQ(f.breaks.size(), 1u);
      EXPECT_EQ(f.breaks[0].use.bond.value, 0u);
      EXPECT_NEAR(2.0 * f.breaks[0].load / expected, 1.0, 1e-3) << n << " bonds";
    }
  }
}

// F3: a chain torn off axial bonds to the ground, one by one; the load is lowered as the crack grows. Linear
// as the reference is: displacements are 1e-4 of those it has.
TEST(DoubleCantilever, TornOffTheGroundNeedsTheExactLoads) {
  constexpr std::size_t n = 241;
  constexpr double scale = 1e-4, most = 2.0;
  std::vector<Vec3d> r;
  for (const double y : {0.0, -1.0})
    for (std::size_t k = 0; k < n; ++k) r.push_back({static_cast<double>(k), y, 0});
  Specimen s = testing::particles_at(r, 0.1);
  BondRecipe beam;
  beam.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1e4, 0.2}, {1.0, 1e-2, 2e-2}, 0};
  for (std::size_t k = 0; k + 1 < n; ++k) testing::bond(s, k, k + 1, beam);
  for (std::size_t k = 5; k < n; ++k)
    testing::bond(s, k, n + k, breakable({1.0, 1e-12, 1e-12, 1e-12}, scale));
  std::vector<ParticleId> chain, ground;
  for (std::size_t k = 0; k < n; ++k) chain.emplace_back(k), ground.emplace_back(n + k);
  StaticStage stage = static_stage(StageKind::fracture,
                                   {fixed(chain, in_plane), fixed(ground, testing::clamped),
                                    fixed({ParticleId{n - 1}}, {true, false, false, false, false, false})},
                                   {pushed(0, {0, most * scale, 0})});
  stage.fracture.control = FractureControl::crack;
  stage.fracture.most_breaks = 36;
  const FractureResult f = fracture(walk(s, stage));
  ASSERT_EQ(f.breaks.size(), 36u);
  for (std::size_t k = 0; k < 36; ++k) EXPECT_EQ(f.breaks[k].use.i, ParticleId{5 + k});
  for (const auto& row : validation_case("F3")["expected"]["rows"]) {
    const std::size_t c = row["c"];
    EXPECT_NEAR(most * f.breaks[c - 5].load / row["P_discrete"].get<double>(), 1.0, 1e-3) << "crack of " << c;
  }
  EXPECT_EQ(f.avalanches, 1);  // under a load that stays it would run on
}

// DB1: two chains joined by breakable bonds, their ends drawn apart.
TEST(DoubleCantilever, OpensAsListed) {
  const auto c = material_case("DB1");
  constexpr std::size_t n = 30, c0 = 8;
  constexpr double most = 0.3;
  std::vector<Vec3d> r;
  for (const double y : {0.0, 1.0})
    for (std::size_t k = 0; k <= n; ++k) r.push_back({static_cast<double>(k), y, 0});
  Specimen s = testing::particles_at(r, 0.3);
  BondRecipe arm;
  arm.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1e4, 0.2}, {1.0, 1e-2, 2e-2}, 0};
  for (const std::size_t first : {std::size_t{0}, n + 1})
    for (std::size_t k = 0; k < n; ++k) testing::bond(s, first + k, first + k + 1, arm);
  BondRecipe joint = breakable({1.0, 0.5, 0.05, 0.05}, 0.02);
  joint.attachment = Attachment::given;
  joint.R_i = joint.R_j = 0.3;
  for (std::size_t k = c0; k < n; ++k) testing::bond(s, k, n + 1 + k, joint);
  constexpr HeldDofs along_y{false, true, false, false, false, false};
  StaticStage stage =
      static_stage(StageKind::fracture, {fixed(testing::everybody(s), in_plane),
                                         fixed({ParticleId{n}, ParticleId{2 * n + 1}}, testing::clamped),
                                         fixed({ParticleId{n + 1}}, along_y, {0, most / 2, 0}),
                                         fixed({ParticleId{0}}, along_y, {0, -most / 2, 0})});
  stage.fracture.most_breaks = 4;
  const Walked w = walk(s, stage);
  const FractureResult& f = fracture(w);
  ASSERT_EQ(f.breaks.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& e = c["expected"]["events"][k];
    const BrokenBond& b = f.breaks[k];
    const auto same = [&](double value, const char* key) {
      EXPECT_NEAR(value / e[key].get<double>(), 1.0, 1e-6) << key << " of break " << k + 1;
    };
    EXPECT_EQ(b.use.i, ParticleId{e["bond"].get<std::size_t>()});
    same(most * b.use.load_factor, "opening");
    same(b.load, "P_before");
    same(b.load_after.value(), "P_after");
    same(b.released, "released");
    same(b.stored, "U_after");
    same(b.stored + b.released, "U_before");
    same(b.work, "work_total");
    EXPECT_EQ(b.avalanche, static_cast<int>(k) + 1);
  }
  expect_books_close(f);
}

}  // namespace
}  // namespace vbond
