// An elastic law of a program's own, of which the library makes laws with rules and with flow: in motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "hardening_law.hpp"
#include "inelastic_laws.hpp"
#include "rods.hpp"
#include "vbond/dynamics/law_with_loops.hpp"
#include "vbond/physics/with_flow.hpp"

namespace vbond::own_law_test {
namespace {

using testing::Specimen;

constexpr double per_s2 = 100.0;
const BondLaw hardening_law = law_with_loops<testing::Hardening>();

BondRecipe recipe_with(const BondRules& rules, const BondLaw& law, double hardening = 0.0) {
  BondRecipe recipe;
  recipe.law = &law;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  recipe.given = {0, 0, 0, 0, hardening};
  recipe.rules = rules;
  return recipe;
}

struct Named {
  std::string name;
  BondRules rules;
  BondDamping damping;
};
/// One of each thing that rules can say.
std::vector<Named> all_rules() {
  const BondDamping damping{DampingBy::ratio, {0.05, 0.05, 0.05, 0.05}};
  BondRules breaks, yields, creeps, softens;
  breaks.strength = linear_strength(0.03, 0.003, 4e-4, 2e-4);
  yields.yield.limit = {0.01, 1e-3, 2e-4, 1e-4};
  yields.yield.compression = 0.012;
  yields.yield.isotropic = yields.yield.kinematic = {0.05, 1e-3, 1e-4, 1e-4};
  creeps.creep = {50.0, 3};
  softens.softening = {0.02, 0.5};
  return {{"damps", {}, damping},
          {"breaks", breaks, damping},
          {"yields", yields, {}},
          {"creeps", creeps, {}},
          {"softens", softens, {}}};
}

/// A chain of these bonds between attachments, moved and turning at random.
Specimen lively_chain(const Named& what, const BondLaw& law, double hardening, double speed) {
  BondRecipe recipe = recipe_with(what.rules, law, hardening);
  recipe.damping = what.damping;
  recipe.attachment = Attachment::given, recipe.R_i = 0.1, recipe.R_j = 0.2;
  return testing::lively_chain(recipe, speed);
}

// Without hardening the law is the EVM. What flows is worked out otherwise, where a tension may be no
// straight line: to 1e-10 of the loads in each of 600 steps, which a chain of eight in motion magnifies by
// less than ten.
TEST(OwnLaw, WithRulesMovesAsThatOfTheLibrary) {
  for (const Named& what : all_rules()) {
    Specimen own = lively_chain(what, hardening_law, 0.0, 0.05),
             evm = lively_chain(what, bond_law<Evm>, 0.0, 0.05);
    Simulation run(own.model, testing::plain_stage(0.05, 30.0), own.state),
        other(evm.model, testing::plain_stage(0.05, 30.0), evm.state);
    run.run(), other.run();
    const double far = what.rules.flow() ? 1e-9 : 0.0;
    for (const ParticleId p : own.state.r.ids()) {
      EXPECT_LE(norm(run.state().r[p] - other.state().r[p]), far) << what.name;
      EXPECT_LE(norm(run.state().omega[p] - other.state().omega[p]), far) << what.name;
    }
    EXPECT_NEAR(run.books().dissipated, other.books().dissipated, 1e-3 * far) << what.name;
    EXPECT_EQ(run.books().released, other.books().released) << what.name;
    EXPECT_GT(run.books().dissipated, 0.0) << what.name;
    EXPECT_EQ(run.books().released > 0.0, what.name == "breaks") << what.name;
  }
}

// And with it the books close to second order in the step.
TEST(OwnLaw, ClosesItsBooksToSecondOrder) {
  for (const Named& what : all_rules()) {
    if (what.name == "breaks") continue;  // a break is of first order in time
    double error[2]{}, lost[2]{};
    for (const int fine : {0, 1}) {
      const Specimen s = lively_chain(what, hardening_law, per_s2, 0.05);
      Simulation run(s.model, testing::plain_stage(fine ? 0.02 : 0.04, 1e9), s.state);
      while (run.clock().time() < 30.0) {
        run.step();
        error[fine] = std::max(
            error[fine], std::abs(run.energies().total() + run.books().dissipated - run.books().at_start));
      }
      lost[fine] = run.books().dissipated;
    }
    // as flow_test.cpp has it of the library's laws
    const double start = 8 * 0.05 * 0.05;
    EXPECT_GT(lost[0], 0.02 * start) << what.name;
    EXPECT_NEAR(lost[0], lost[1], 0.03 * lost[0]) << what.name;
    EXPECT_LT(error[1], 3e-4 * start) << what.name;
    EXPECT_GT(error[0] / error[1], 3.0) << what.name;
  }
}

// Pulled by one particle's own motion, it breaks at its own tension: B1 u (1 + u^2/s^2).
TEST(OwnLaw, BreaksAtItsOwnTension) {
  BondRules rules;
  rules.strength = linear_strength(0.0625, 1.0, 1.0, 1.0);  // u = 0.05 if 1/s^2 = 100
  for (const double hardening : {0.0, per_s2}) {
    Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
    testing::bond(s, 0, 1, recipe_with(rules, hardening_law, hardening));
    Stage stage = testing::plain_stage(1e-3, 0.1);
    stage.supports = {testing::held({ParticleId{0}}, testing::clamped),
                      testing::held({ParticleId{1}}, testing::clamped, {1, 0, 0})};
    Simulation run(s.model, stage, s.state);
    while (!run.state().bonds[BondId{0}].broken && run.clock().time() < 0.1) run.step();
    EXPECT_NEAR(run.clock().time(), hardening > 0.0 ? 0.05 : 0.0625, 1e-3 + 1e-9);
  }
}

TEST(OwnLaw, HasItsOwnFactorOfStrength) {
  BondRecipe recipe = recipe_with({}, hardening_law, per_s2);
  recipe.rules.strength = linear_strength(1.0, 1.0, 1.0, 1.0);
  recipe.weibull = {5.0, 0.0, 0.0, 3};
  recipe.damping = {DampingBy::coefficients, {0.1, 0.2, 0.3, 0.4}};
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  testing::bond(s, 0, 1, recipe);
  recipe.law = &bond_law<Evm>;
  testing::bond(s, 0, 1, recipe);
  const Bond &own = s.state.bonds[BondId{0}], &evm = s.state.bonds[BondId{1}];
  EXPECT_EQ(own.law->name, "hardening-with-rules");
  EXPECT_EQ(own.law->fields.back().name, "weakness");
  EXPECT_EQ(own.coefficients[4], per_s2);
  EXPECT_EQ(strength_factor(own), strength_factor(evm));
  EXPECT_NE(strength_factor(own), 1.0);
  const BondStiffness<double> g = own.law->damping(own);
  EXPECT_EQ(g.c_A, 0.1);
  EXPECT_EQ(g.c_T, 0.4);
}

TEST(OwnLaw, IsFoundByItsNameWithRulesAndWithFlow) {
  const BondLaw* const own[] = {&hardening_law};
  BondRules flows;
  flows.creep.rate = 1.0;
  EXPECT_EQ(find_law("hardening-with-rules"), nullptr);
  EXPECT_EQ(find_law("hardening-with-rules", own), with_rules(hardening_law, {}));
  EXPECT_EQ(find_law("hardening-with-flow", own), with_rules(hardening_law, flows));
  EXPECT_EQ(find_law("v-model-with-flow"), with_rules(bond_law<VModel>, flows));
}

/// The EVM with five numbers more than it needs: nine coefficients.
template <Scalar T>
struct Wide : Evm<T> {
  T p, q, r, s, t;
  static constexpr std::string_view name = "wide";
  static constexpr auto fields() {
    constexpr auto evm = Evm<T>::fields();
    using Field = LawField<Wide>;
    std::array<Field, 9> all{};
    for (std::size_t k = 0; k < 4; ++k) all[k] = {evm[k].at, evm[k].info};
    constexpr LawFieldInfo more{"more", {0, 0}, "of a test", LawInput::given};
    all[4] = {&Wide::p, more}, all[5] = {&Wide::q, more}, all[6] = {&Wide::r, more},
    all[7] = {&Wide::s, more}, all[8] = {&Wide::t, more};
    return all;
  }
  static constexpr Wide from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    return {Evm<T>::from(c, a, R_i, R_j), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0)};
  }
};

TEST(OwnLaw, OfNineCoefficientsHasNoRoomForThoseOfRules) {
  const BondLaw wide = law_with_loops<Wide>();
  EXPECT_EQ(wide.fields.size(), 9u);
  EXPECT_EQ(wide.with_rules, nullptr);
  EXPECT_EQ(wide.with_flow, nullptr);
}

// A softening that the tension does not reach, and one of a form of stretching, are no states of a run.
TEST(OwnLaw, IsRefusedWhereItsSofteningCannotBegin) {
  const auto refusal = [](const BondRules& rules) {
    Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
    testing::bond(s, 0, 1, recipe_with(rules, hardening_law));
    try {
      Simulation(s.model, testing::plain_stage(0.1, 1.0), s.state);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  BondRules rules;
  rules.softening = {0.1, 0.2};
  EXPECT_EQ(refusal(rules), "none");
  rules.stretch.form = StretchForm::two_slopes;
  EXPECT_NE(refusal(rules).find("bonds[0] softens or creeps, and has a form of stretching of its own"),
            std::string::npos);
  rules.stretch.form = StretchForm::harmonic;
  rules.softening = {0.1, 0.09};
  EXPECT_NE(refusal(rules).find("bonds[0] softens from a force that it does not reach"), std::string::npos);
}

TEST(OwnLaw, ThatDampsByItselfIsRefusedWithRules) {
  BondRecipe recipe = testing::papers_bond(&testing::damped_law);
  recipe.damping = {DampingBy::time, {0.1, 0.1, 0.1, 0.1}};
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  try {
    testing::bond(s, 0, 1, recipe);
    ADD_FAILURE() << "it is made";
  } catch (const std::invalid_argument& e) {
    EXPECT_EQ(std::string(e.what()),
              "make_bond: law \"damped\" damps, breaks or remembers by itself, or has more than eight "
              "coefficients: it takes no rules, damping or weibull of a recipe");
  }
}

}  // namespace
}  // namespace vbond::own_law_test
