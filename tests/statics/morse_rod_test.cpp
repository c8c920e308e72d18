// Validation case NL2: a pulled rod of eight Morse bonds, its elongation and the largest force it carries.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "material_cases.hpp"
#include "walks.hpp"

namespace vbond {
namespace {

using testing::fixed;
using testing::pushed;

testing::Specimen morse_rod() {
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 0.002};
  recipe.rules.stretch.form = StretchForm::morse;
  recipe.rules.stretch.alpha = 5.0;
  return testing::straight_rod(9, recipe);
}

/// All but translation along x is held; a force of the load factor pulls the end.
StaticStage pulled(StageKind kind, const testing::Specimen& s, double force) {
  return testing::static_stage(kind,
                               {fixed(s.model.groups[0].particles, {false, true, true, true, true, true}),
                                fixed({ParticleId{0}}, testing::clamped)},
                               {pushed(8, {force, 0, 0})});
}

TEST(MorseRod, HasTheElongationAndTheLargestForceOfTheReference) {
  const nlohmann::json nl2 = testing::material_case("NL2")["expected"];
  const testing::Specimen s = morse_rod();
  for (const auto& row : nl2["rows"]) {
    const StaticOutcome rest =
        run_static_stage(s.model, pulled(StageKind::equilibrium, s, row["N"]), s.state, {});
    EXPECT_NEAR(rest.state.r[ParticleId{8}].x - 8.0, row["uniform_elongation"], 1e-9);
  }
  StaticStage stage = pulled(StageKind::path, s, 1.0);
  stage.path.first_step = 0.005;
  stage.path.below = 0.02;
  const StaticOutcome path = run_static_stage(s.model, stage, s.state, {});
  double largest = 0.0;
  for (const SpecialPoint& p : path.result.special_points)
    if (p.kind == PointKind::limit_point) largest = p.load_factor;
  EXPECT_NEAR(largest, nl2["max_force"], 1e-9);
}

}  // namespace
}  // namespace vbond
