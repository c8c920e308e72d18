// Stiffnesses of bonds from elastic constants of a packing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "campaigns/dice.hpp"
#include "packed.hpp"
#include "vbond/statics/calibrate_cell.hpp"

namespace vbond::calibrate_cell_test {
namespace {

using namespace testing;

/// c_A = 1, c_D = 1, c_B = c_T = c_D a^2/12, as the reference has it where its q and s are 1.
Specimen of_reference(bool evm = false) {
  Specimen s = packed(packing_of_equals(), true, evm, false);
  for (Bond& b : s.state.bonds)
    b.coefficients = b.law->from_stiffness({1.0, 1.0, sq(b.a) / 12, sq(b.a) / 12}, b.a, b.coefficients);
  return s;
}

// Another program's answers for the packing HG1, by bracketing.
TEST(CalibrateCell, FindsTheStiffnessesOfAnotherProgram) {
  struct {
    double E, nu, q, s;
  } const answers[] = {{1.0, 0.25, 0.055580711557936445, 1.0282763091626834},
                       {2.5, 0.1, 0.5658612085484297, 1.5412649593060552},
                       {7e10, 0.02, 0.9408708815146486, 35656291580.41414}};
  for (const bool evm : {false, true})
    for (const auto& [E, nu, q, s] : answers) {
      const Specimen body = of_reference(evm);
      const CalibratedCell c = calibrate_cell(body.model, body.state, {E, nu}, BendingFollows::shear);
      EXPECT_NEAR(c.factors.normal, s, 1e-10 * s);
      EXPECT_NEAR(c.factors.shear / c.factors.normal, q, 1e-10 * q);
      EXPECT_LE(c.iterations, 8);
      const IsotropicConstants is = ElasticConstants(c.found.C).hill();
      EXPECT_NEAR(is.E(), E, 1e-10 * E);
      EXPECT_NEAR(is.nu(), nu, 1e-10);
    }
}

// The limit of hinged bars, by the other program; at a ratio of 1e-6 it is met to 3e-6.
TEST(CalibrateCell, RefusesWhatTheseBondsCannotDo) {
  const Specimen s = of_reference();
  for (const double nu : {0.35, 0.28}) try {
      calibrate_cell(s.model, s.state, {1.0, nu}, BendingFollows::shear);
      FAIL() << nu;
    } catch (const OutOfReach& e) {
      EXPECT_NEAR(e.nu, 0.27565124420068465, 1e-5);
      const State nearest = with_factors(s.state, e.nearest, BendingFollows::shear);
      EXPECT_NEAR(ElasticConstants(homogenise(s.model, nearest).C).hill().E(), 1.0, 1e-9);
    }
  try {  // at the other end, where shear is 1e4 times as stiff
    calibrate_cell(s.model, s.state, {1.0, -0.99999}, BendingFollows::shear);
    FAIL();
  } catch (const OutOfReach& e) {
    EXPECT_LT(e.nu, -0.6134664205455312) << "that at a ratio of 10, by the other program";
    EXPECT_GT(e.nu, -0.99999);
  }
  EXPECT_THROW(calibrate_cell(s.model, s.state, {1.0, 0.5}, BendingFollows::shear), std::invalid_argument);
  EXPECT_THROW(calibrate_cell(s.model, s.state, {0.0, 0.2}, BendingFollows::shear), std::invalid_argument);
}

/// As many random cases as VBOND_CAMPAIGN says.
unsigned campaign_of(unsigned otherwise) {
  const char* given = std::getenv("VBOND_CAMPAIGN");
  return given != nullptr ? static_cast<unsigned>(std::atoi(given)) : otherwise;
}

// Twenty targets each on three packings, two of them with stiffnesses that differ from bond to bond. Newton's
// method doubles its digits, so that few bodies are homogenised.
TEST(CalibrateCell, ReachesTargetsInFewSteps) {
  Specimen sizes = packed(packing_of_sizes(), true, false, false);
  for (Bond& b : sizes.state.bonds)
    b.coefficients =
        b.law->from_stiffness({b.a, 0.4 * b.a, sq(b.a) * b.a / 20, sq(b.a) * b.a / 40}, b.a, b.coefficients);
  Dice dice(42);
  Specimen random = of_reference(true);
  for (Bond& b : random.state.bonds)
    b.coefficients =
        b.law->from_stiffness({dice.ratio(0.3, 3), dice.ratio(0.3, 3), 0.1, 0.1}, b.a, b.coefficients);
  for (const Specimen& s : {of_reference(), sizes, random})
    for (int k = 0; k < 20; ++k) {
      const ElasticTarget target{dice.ratio(1e-3, 1e12), dice(-0.3, 0.22)};
      const CalibratedCell c = calibrate_cell(s.model, s.state, target, BendingFollows::shear);
      const IsotropicConstants is = ElasticConstants(c.found.C).hill();
      EXPECT_NEAR(is.E(), target.E, 1e-8 * target.E);
      EXPECT_NEAR(is.nu(), target.nu, 1e-8);
      EXPECT_LE(c.iterations, 8) << "E " << target.E << ", nu " << target.nu;
    }
}

// Random bodies and targets of any Poisson's ratio. Those between the ratios of the body at the ends of what
// is looked at are hit, as all ratios between are passed on the way; others may lie beyond all.
TEST(CalibrateCell, HitsOrRefusesRandomTargets) {
  unsigned hit = 0, refused = 0;
  for (unsigned seed = 1; seed <= campaign_of(10); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed);
    Specimen s =
        packed(dice.chance(0.5) ? packing_of_equals() : packing_of_sizes(), true, dice.chance(0.5), false);
    for (Bond& b : s.state.bonds) {
      b.coefficients = b.law->from_stiffness(
          {dice.ratio(0.5, 2), dice.ratio(0.1, 1), dice.ratio(0.01, 0.3), dice.ratio(0.01, 0.3)}, b.a,
          b.coefficients);
      if (dice.chance(0.05)) b.broken = true;
    }
    const BendingFollows bending =
        dice.one_of({BendingFollows::area, BendingFollows::shear, BendingFollows::normal});
    const auto nu_at = [&](double ratio) {
      return ElasticConstants(homogenise(s.model, with_factors(s.state, {1.0, ratio}, bending)).C)
          .hill()
          .nu();
    };
    const double soft = nu_at(1e-6), stiff = nu_at(1e4);
    const ElasticTarget target{dice.ratio(1e-3, 1e12), dice(-0.8, 0.45)};
    const bool between = target.nu > std::min(soft, stiff) + 1e-9 && target.nu < std::max(soft, stiff) - 1e-9;
    try {
      const IsotropicConstants is =
          ElasticConstants(calibrate_cell(s.model, s.state, target, bending).found.C).hill();
      EXPECT_NEAR(is.E(), target.E, 1e-9 * target.E);
      EXPECT_NEAR(is.nu(), target.nu, 1e-9);
      ++hit;
    } catch (const OutOfReach& e) {
      EXPECT_FALSE(between) << target.nu << " lies between " << soft << " and " << stiff;
      // none of the ratios tried by themselves comes nearer than what is called the nearest
      for (const double ratio : {1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4})
        EXPECT_GE(std::abs(nu_at(ratio) - target.nu), std::abs(e.nu - target.nu) - 1e-9) << ratio;
      ++refused;
    }
  }
  RecordProperty("hit", static_cast<int>(hit));
  RecordProperty("refused", static_cast<int>(refused));
  EXPECT_GT(hit, 0u);
  EXPECT_GT(refused, 0u);
}

// Random bodies, made with known factors: the constants that these give are asked for, and the factors found.
TEST(CalibrateCell, FindsFactorsThatARandomBodyWasMadeWith) {
  const unsigned count = campaign_of(6);
  unsigned wrong = 0, most = 0;
  for (unsigned seed = 1; seed <= count; ++seed) {
    Dice dice(seed);
    const bool equals = dice.chance(0.5);
    Specimen s = packed(equals ? packing_of_equals() : packing_of_sizes(), true, dice.chance(0.5), false);
    for (Bond& b : s.state.bonds) {  // of each size, some of them missing
      const double c = dice.ratio(0.5, 2), d = dice.ratio(0.1, 1);
      b.coefficients =
          b.law->from_stiffness({c, d, dice.ratio(0.01, 0.3), dice.ratio(0.01, 0.3)}, b.a, b.coefficients);
      if (dice.chance(0.05)) b.broken = true;
    }
    const BendingFollows bending =
        dice.one_of({BendingFollows::area, BendingFollows::shear, BendingFollows::normal});
    const StiffnessFactors made{dice.ratio(0.03, 30), dice.ratio(0.03, 30)};
    const IsotropicConstants is =
        ElasticConstants(homogenise(s.model, with_factors(s.state, made, bending)).C).hill();
    const CalibratedCell c = calibrate_cell(s.model, s.state, {is.E(), is.nu()}, bending);
    // nu says little of the ratio where it is near its limits
    const IsotropicConstants back = ElasticConstants(c.found.C).hill();
    const bool same =
        std::abs(back.E() / is.E() - 1) < 1e-9 && std::abs(back.nu() - is.nu()) < 1e-9 &&
        std::abs(std::log(c.factors.shear / c.factors.normal / (made.shear / made.normal))) < 1e-4;
    if (!same) {
      ++wrong;
      ADD_FAILURE() << "seed " << seed << ": made with " << made.normal << " " << made.shear << ", found "
                    << c.factors.normal << " " << c.factors.shear;
    }
    most = std::max(most, static_cast<unsigned>(c.iterations));
  }
  RecordProperty("bodies", static_cast<int>(most));
  EXPECT_EQ(wrong, 0u);
  EXPECT_LE(most, 20u);
}

}  // namespace
}  // namespace vbond::calibrate_cell_test
