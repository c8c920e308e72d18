// Bonds that yield and soften, at rest: hinges, collapse loads, a softening bar; and the books.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "fracture_bodies.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

using testing::clamp;
using testing::clamped;
using testing::fixed;
using testing::fracture;
using testing::material_case;
using testing::pushed;
using testing::refusal;
using testing::Specimen;
using testing::static_stage;
using testing::walk;
using testing::Walked;

// Values of materials.json are those of small deflections: off by about M_y^2 once M_y has been made small.
constexpr double small = 1e-3;

/// A rod of N Bernoulli-Euler bonds, of length and EI 1, that yields in bending.
Specimen plastic_rod(std::size_t N, double M_y, double hardening, const BondLaw* law = &bond_law<VModel>) {
  const double a = 1.0 / static_cast<double>(N);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= N; ++k) r.push_back({a * static_cast<double>(k), 0, 0});
  Specimen s = testing::particles_at(r, 0.4 * a);
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = BondStiffness<double>{1e4 / a, 12.0 / (a * a * a), 1.0 / a, 1.0 / a};
  recipe.rules.yield.limit.bending = M_y;
  recipe.rules.yield.isotropic.bending = hardening;
  for (std::size_t k = 0; k < N; ++k) testing::bond(s, k, k + 1, recipe);
  return s;
}

/// The last point of a stage, for the next one.
Specimen at_the_end(const Specimen& s, const Walked& w) {
  return {s.model, w.last()};
}
Specimen unloaded(const Specimen& s, const Walked& w) {
  const Specimen from = at_the_end(s, w);
  return at_the_end(from, walk(from, static_stage(StageKind::equilibrium, {clamp(0)})));
}

// ---- PL3: a cantilever ---------------------------------------------------------------------------------

TEST(PlasticCantilever, HardensUnderItsLoadAndKeepsWhatItLearned) {
  const auto rows = material_case("PL3")["expected"]["hardening"];
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const auto& row : rows) {
      const double P = small * row["P"].get<double>();
      const Specimen rod = plastic_rod(20, small * 0.01, 0.05, law);
      StaticStage load = static_stage(StageKind::equilibrium, {clamp(0)}, {pushed(20, {0, P, 0})});
      load.steps = 4;
      const Walked w = walk(rod, load);
      EXPECT_NEAR(w.last().r[ParticleId{20}].y / small, row["deflection"],
                  1e-6 * row["deflection"].get<double>());
      const double work = row["plastic_work"], residual = row["residual"];
      EXPECT_NEAR(dissipated_by_flow(w.last()) / sq(small), work, 1e-6 * work);
      EXPECT_NEAR(unloaded(rod, w).state.r[ParticleId{20}].y / small, residual, 1e-6 * residual + 1e-12);
      const auto flowed = std::count_if(w.last().bond_history.begin(), w.last().bond_history.end(),
                                        [](const BondHistory& h) { return h[memory::bending] > 0.0; });
      EXPECT_EQ(flowed, row["bonds_yielded"].get<int>());
      EXPECT_NEAR(w.last().bond_history[BondId{0}][memory::bending] / small, row["root_plastic_angle"],
                  2e-6 * row["root_plastic_angle"].get<double>());
    }
}

// Pushed further than it carries, the tip keeps its force: M_y / (L - a/2).
TEST(PlasticCantilever, HasAHingeAtImposedDeflection) {
  const auto e = material_case("PL3")["expected"]["perfectly_plastic"];
  const Specimen rod = plastic_rod(20, small * 0.01, 0.0);
  StaticStage push = static_stage(
      StageKind::fracture, {clamp(0), fixed({ParticleId{20}}, {false, true, false, false, false, false},
                                            {0, small * e["imposed"].get<double>(), 0})});
  push.steps = 3;
  const Walked w = walk(rod, push);
  const FractureResult& f = fracture(w);
  EXPECT_EQ(w.result.ended, "load factor");
  EXPECT_NEAR(f.peak_load / small, e["P_collapse"], 1e-6 * e["P_collapse"].get<double>());
  EXPECT_NEAR(f.books.dissipated / sq(small), e["dissipated"], 1e-6 * e["dissipated"].get<double>());
  EXPECT_NEAR(unloaded(rod, w).state.r[ParticleId{20}].y / small, e["residual"],
              1e-6 * e["residual"].get<double>());
}

// Where deflections are large, so that the energy is known well enough: it is a small difference of numbers
// of the size of EI/a.
TEST(PlasticCantilever, ClosesItsBooks) {
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const double hardening : {0.0, 0.05}) {
      const Specimen rod = plastic_rod(8, 0.2, hardening, law);
      StaticStage push = static_stage(
          StageKind::fracture,
          {clamp(0), fixed({ParticleId{8}}, {false, true, false, false, false, false}, {0, 0.3, 0})});
      push.steps = 16;
      const FractureResult f = fracture(walk(rod, push));
      EXPECT_GT(f.books.dissipated, 0.1 * f.books.work);
      EXPECT_LT(std::abs(f.books.error()), 1e-9);
    }
}

// A load above the collapse load has no balance.
TEST(PlasticCantilever, CarriesNoMoreThanItsCollapseLoad) {
  const double P = material_case("PL3")["expected"]["perfectly_plastic"]["P_collapse"];
  for (const double part : {0.999, 1.001}) {
    const StaticStage load =
        static_stage(StageKind::equilibrium, {clamp(0)}, {pushed(20, {0, part * small * P, 0})});
    const std::string why = refusal(plastic_rod(20, small * 0.01, 0.0), load);
    EXPECT_EQ(why.empty(), part < 1.0) << why;
  }
}

// ---- PL4: collapse loads -------------------------------------------------------------------------------

TEST(PlasticBeam, CollapsesAtTheLoadsOfLimitAnalysis) {
  const double M_y = 1e-5;
  const auto rows = material_case("PL4")["expected"]["rows"];
  for (const BondLaw* law : {&bond_law<VModel>, &bond_law<Evm>})
    for (const auto& row : rows)
      for (const bool propped : {true, false}) {
        const std::size_t N = row["N"];
        const Specimen beam = plastic_rod(N, M_y, 0.0, law);
        StaticStage push = static_stage(
            StageKind::fracture,
            {fixed({ParticleId{N / 2}}, {false, true, false, false, false, false}, {0, 0.1 * M_y, 0}),
             clamp(0), fixed({ParticleId{N}}, {false, true, true, !propped, !propped, !propped})});
        push.steps = 4;
        const FractureResult f = fracture(walk(beam, push));
        const double expected = row[propped ? "propped_mid_load" : "clamped_clamped_mid_load"];
        EXPECT_NEAR(f.peak_load / M_y, expected, 1e-6 * expected) << N << (propped ? " propped" : " clamped");
        EXPECT_GT(f.books.dissipated, 0.1 * f.books.work);
      }
}

// ---- axial cycles: PL1 ---------------------------------------------------------------------------------

// Stage by stage, each from the memory of the last: the plastic work is that of the closed form.
TEST(PlasticBar, FollowsAxialCyclesStageByStage) {
  for (const std::string id : {"PL1a", "PL1b", "PL1c"}) {
    const auto c = material_case(id);
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
    recipe.rules.yield.limit.axial = recipe.rules.yield.compression = c["setup"]["N_y"];
    recipe.rules.yield.isotropic.axial = c["setup"]["H_iso"];
    recipe.rules.yield.kinematic.axial = c["setup"]["H_kin"];
    constexpr std::size_t n = 1;
    Specimen bar = testing::straight_rod(n + 1, recipe);
    double u = 0.0, dissipated = 0.0;
    for (const auto& row : c["expected"]["rows"]) {
      const double du = row["u"].get<double>() - u;
      u += du;
      const Walked w = walk(
          bar, static_stage(StageKind::fracture,
                            {clamp(0),
                             fixed({ParticleId{n}}, {true, true, true, false, true, true}, {n * du, 0, 0})}));
      bar = at_the_end(bar, w);
      double u_p = 0.0, alpha = 0.0;  // without hardening the bonds may share it in any way
      for (const BondHistory& h : bar.state.bond_history)
        u_p += h[memory::stretch], alpha += h[memory::axial];
      EXPECT_NEAR(u_p / n, row["u_p"], 1e-10);
      EXPECT_NEAR(alpha / n, row["alpha"], 1e-10);
      dissipated += fracture(w).books.dissipated;
      const double stored = row["back_stress_energy"], work = row["plastic_work"];
      EXPECT_NEAR(dissipated, n * (work - stored), 1e-10 * work);
      EXPECT_LT(std::abs(fracture(w).books.error()), 1e-9);
    }
  }
}

// ---- SO1: a softening bar ------------------------------------------------------------------------------

Specimen softening_bar(std::size_t n) {
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  recipe.rules.softening = {0.02, 0.2};
  Specimen s = testing::straight_rod(n + 1, recipe);
  Bond& weak = s.state.bonds[BondId{1}];
  for (std::size_t k = 0; k < weak.law->fields.size(); ++k)
    if (weak.law->fields[k].name == "weakness") weak.coefficients.set(k, 1e-6);
  return s;
}
StaticStage drawn(std::size_t n, double elongation) {
  StaticStage stage =
      static_stage(StageKind::fracture, {clamp(0), fixed({ParticleId{n}}, clamped, {elongation, 0, 0})});
  stage.steps = 10;
  return stage;
}

TEST(SofteningBar, FailsInOneBondAlongTheExactCurve) {
  const auto e = material_case("SO1")["expected"]["n4"];
  const Specimen bar = softening_bar(4);
  for (const auto& point : e["points"]) {
    const double N = point["N"], total = point["total"];
    if (N == 0.0) continue;  // parted, below
    const Walked w = walk(bar, drawn(4, total));
    const State& s = w.last();
    EXPECT_NEAR(axial_force(s.bonds[BondId{3}], {}, between(s, ParticleId{3}, ParticleId{4}),
                            s.q[ParticleId{3}], s.q[ParticleId{4}]),
                N, 2e-6 * 0.02);  // one bond is 1e-6 weaker
    EXPECT_NEAR(norm(s.r[ParticleId{2}] - s.r[ParticleId{1}]) - 1.0, point["damaged_bond"], 2e-6);
    EXPECT_LT(std::abs(fracture(w).books.error()), 1e-9);
  }
  const Walked w = walk(bar, drawn(4, 0.3));
  const FractureResult& f = fracture(w);
  EXPECT_EQ(w.result.ended, "parted");
  ASSERT_EQ(f.breaks.size(), 1u);
  EXPECT_EQ(f.breaks[0].use.bond, BondId{1});
  EXPECT_NEAR(0.3 * f.breaks[0].use.load_factor, 0.2, 1e-6);
  EXPECT_NEAR(f.peak_load, 0.02, 2e-6 * 0.02);
  EXPECT_NEAR(f.books.dissipated, e["energy_total"], 1e-9);
  EXPECT_LT(f.books.released, 1e-7 * f.books.work);  // what little force is left at 1 - 1e-8 of its damage
  EXPECT_LT(std::abs(f.books.error()), 1e-9);
}

// A long bar snaps back: drawn out it loses its balance at the peak, and the stage says so.
TEST(SofteningBar, ThatSnapsBackLosesItsStabilityAtItsPeak) {
  const Walked w = walk(softening_bar(20), drawn(20, 0.5));
  EXPECT_EQ(w.result.ended, "lost stability");
  EXPECT_NEAR(0.5 * w.result.load_factor, 0.4, 2e-6);
  EXPECT_NEAR(fracture(w).peak_load, 0.02, 1e-6);
}

TEST(SofteningBar, UnloadsTowardsTheOriginAndGoesOnFromWhereItWas) {
  Specimen bar = softening_bar(4);
  const Walked out = walk(bar, drawn(4, 0.11));
  bar = at_the_end(bar, out);
  const Walked back = walk(bar, drawn(4, -0.11));
  EXPECT_EQ(fracture(back).books.dissipated, 0.0);
  EXPECT_LT(std::abs(fracture(back).books.stored), 1e-12);
  bar = at_the_end(bar, back);
  StaticStage further = drawn(4, 0.14);
  further.steps = 14;  // one of them ends where it was
  const Walked again = walk(bar, further);
  EXPECT_NEAR(fracture(again).peak_load, 0.015, 1e-7);
  EXPECT_NEAR(
      fracture(out).books.dissipated + fracture(again).books.dissipated + fracture(again).books.stored,
      0.002 - 0.5 * 0.01 * (0.2 - 0.14), 1e-7);
}

// ---- what statics does not take ------------------------------------------------------------------------

TEST(FlowAtRest, IsRefusedWhereItHasNoMeaning) {
  Specimen rod = plastic_rod(4, 1e-3, 0.0);
  const StaticStage path = static_stage(StageKind::path, {clamp(0)}, {pushed(4, {0, 1e-6, 0})});
  EXPECT_NE(refusal(rod, path).find("bond 0 (particles 0, 1) yields or softens"), std::string::npos);
}

}  // namespace
}  // namespace vbond
