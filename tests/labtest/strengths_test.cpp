#include "vbond/labtest/search_strengths.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"

namespace vbond::labtest {
namespace {

using testing::Dice;
using testing::Tally;
using testing::Verdict;
using testing::wrong;

/// A made-up material by similarity: T = t^p f(s), C = t^p g(s); p = 1 but where strains are large.
struct Made {
  std::function<double(double)> f, g;
  double p = 1.0;
  std::function<bool(const StrengthFactors&)> fails = [](const StrengthFactors&) { return false; };
  mutable int tests = 0;

  Strengths strengths(const StrengthFactors& k) const {
    const double t = std::pow(k.tension, p), s = k.shear / k.tension;
    return {t * f(s), t * g(s)};
  }
  /// Only what is asked for is tested.
  StrengthTests asked(const Strengths& which) const {
    return [this, which](const StrengthFactors& k, const Strengths&) {
      ++tests;
      StrengthsFound found;
      if (fails(k)) {
        found.why = "no peak";
        return found;
      }
      const Strengths all = strengths(k);
      if (which.tensile) found.strengths.tensile = all.tensile;
      if (which.compressive) found.strengths.compressive = all.compressive;
      return found;
    };
  }
};

StrengthSearch search(const Made& made, const StrengthGoal& goal) {
  return search_strengths(goal, made.asked(goal.asked));
}

/// Tension breaks by whichever limit is less, compression by shear until tension between grains does.
Made saturating(double T = 20.0, double C = 140.0) {
  return {.f = [T](double s) { return T * std::min(1.0, 2.0 * s); },
          .g = [C](double s) { return C * s * 2.0 / (1.0 + s); }};
}

// Its ratio is 7 from s = 1 on times 2s/(1 + s): from 7/2 2/(1 + s) at s < 1/2 to 14.
TEST(StrengthSearch, FindsBothStrengthsOfASaturatingMaterial) {
  const Made made = saturating();
  for (const double ratio : {5.0, 6.99, 7.0, 9.0, 13.0})
    for (const double T : {0.01, 20.0, 3e5}) {
      const StrengthGoal goal{{T, ratio * T}, 0.01};
      const StrengthSearch found = search(made, goal);
      ASSERT_EQ(found.end, StrengthSearchEnd::reached) << ratio << ' ' << T;
      const Strengths true_ones = made.strengths(found.all[*found.nearest].factors);
      EXPECT_NEAR(*true_ones.tensile / T, 1.0, 0.01);
      EXPECT_NEAR(*true_ones.compressive / (ratio * T), 1.0, 0.01);
      // four doublings at most to the bracket, each with two trials; the rest is bisection to 2 %: 0.7/2^6
      EXPECT_LE(found.all.size(), 16u) << ratio << ' ' << T;
    }
}

TEST(StrengthSearch, OfOneStrengthHasOneFactorAndTwoTests) {
  const Made made = saturating();
  for (const StrengthGoal& goal : {StrengthGoal{{9.3, {}}, 0.01}, StrengthGoal{{{}, 9.3}, 0.01}}) {
    const StrengthSearch found = search(made, goal);
    ASSERT_EQ(found.end, StrengthSearchEnd::reached);
    const StrengthEvaluation& e = found.all[*found.nearest];
    EXPECT_EQ(found.all.size(), 2u);
    EXPECT_EQ(e.factors.tension, e.factors.shear);
    EXPECT_TRUE(meets(goal, e.found.strengths));
    EXPECT_FALSE(found.ratios);
  }
}

TEST(StrengthSearch, WhatTheCaseHasAlreadyIsOneTest) {
  const StrengthSearch found = search(saturating(), {{20.1, 139.0}, 0.01});
  EXPECT_EQ(found.end, StrengthSearchEnd::reached);
  EXPECT_EQ(found.all.size(), 1u);
}

TEST(StrengthSearch, RefusesARatioBeyondReachWithTheNearest) {
  const StrengthSearch found = search(saturating(), {{10.0, 200.0}, 0.01});
  EXPECT_EQ(found.end, StrengthSearchEnd::out_of_reach);
  ASSERT_TRUE(found.ratios && found.nearest);
  EXPECT_GT(found.ratios->second, 13.7);  // 14 s/(1 + s) at s = 64
  EXPECT_LT(found.ratios->second, 14.0);
  EXPECT_EQ(*found.all[*found.nearest].ratio(), found.ratios->second);
  EXPECT_LT(found.ratios->first, 7.0) << "the other direction was not looked at";
  EXPECT_LE(found.all.size(), 13u);
}

TEST(StrengthSearch, LooksTheOtherWayIfTheRatioFalls) {  // with more shear strength
  const Made made{.f = [](double) { return 20.0; }, .g = [](double s) { return 140.0 / std::sqrt(s); }};
  const StrengthGoal goal{{20.0, 300.0}, 0.01};
  const StrengthSearch found = search(made, goal);
  ASSERT_EQ(found.end, StrengthSearchEnd::reached);
  EXPECT_LT(found.all[*found.nearest].factors.shear, found.all[*found.nearest].factors.tension);
}

TEST(StrengthSearch, TellsAJumpOverTheRatio) {
  const Made made{.f = [](double) { return 20.0; }, .g = [](double s) { return s < 1.7 ? 140.0 : 220.0; }};
  const StrengthSearch found = search(made, {{20.0, 180.0}, 0.01});
  EXPECT_EQ(found.end, StrengthSearchEnd::jumps);
  ASSERT_TRUE(found.jump);
  const auto& [low, high] = *found.jump;
  const double s_low = low.factors.shear / low.factors.tension,
               s_high = high.factors.shear / high.factors.tension;
  EXPECT_LT(s_low, 1.7);
  EXPECT_GE(s_high, 1.7);
  EXPECT_LT(s_high / s_low - 1.0, 0.001 + 1e-12);  // a tenth of the tolerance
  EXPECT_DOUBLE_EQ(*low.ratio(), 7.0);
  EXPECT_DOUBLE_EQ(*high.ratio(), 11.0);
}

TEST(StrengthSearch, TestsWithoutStrengthEndADirection) {
  Made made = saturating();
  made.fails = [](const StrengthFactors& k) { return k.shear / k.tension > 3.0; };
  // at s = 3 the ratio is 10.5: what lies before it is found, although s = 4 has no strength
  EXPECT_EQ(search(made, {{20.0, 200.0}, 0.01}).end, StrengthSearchEnd::reached);
  const StrengthSearch found = search(made, {{20.0, 240.0}, 0.01});
  EXPECT_EQ(found.end, StrengthSearchEnd::no_strength);
  ASSERT_TRUE(found.nearest);
  EXPECT_TRUE(found.all[*found.nearest].ratio());
  made.fails = [](const StrengthFactors&) { return true; };
  const StrengthSearch none = search(made, {{20.0, 140.0}, 0.01});
  EXPECT_EQ(none.end, StrengthSearchEnd::no_strength);
  EXPECT_EQ(none.all.size(), 1u);
  EXPECT_FALSE(none.nearest);
}

TEST(StrengthSearch, FollowsStrengthsThatDoNotQuiteScale) {
  for (const double p : {0.6, 0.9, 1.3}) {
    Made made = saturating();
    made.p = p;
    EXPECT_EQ(search(made, {{9.0, 100.0}, 0.01}).end, StrengthSearchEnd::reached) << p;
    EXPECT_EQ(search(made, {{9.0, {}}, 0.01}).end, StrengthSearchEnd::reached) << p;
  }
  Made made = saturating();
  made.p = 0.0;  // not at all
  EXPECT_EQ(search(made, {{9.0, {}}, 0.01}).end, StrengthSearchEnd::no_scaling);
}

TEST(StrengthSearch, EndsAfterSoManyTests) {
  int k = 0;
  const StrengthSearch found =
      search_strengths({{20.0, 140.0}, 1e-9}, [&k](const StrengthFactors& t, const Strengths&) {
        return StrengthsFound{{20.0 * t.tension, 140.0 * t.tension * (1.0 + 1e-7 * (++k % 7 - 3))}, ""};
      });
  EXPECT_NE(found.end, StrengthSearchEnd::reached);
  EXPECT_LE(found.all.size(), most_strength_tests);
}

TEST(StrengthSearch, RefusesWhatIsNoStrength) {
  const auto tests = saturating().asked({});
  for (const StrengthGoal& goal : {StrengthGoal{{}, 0.01}, StrengthGoal{{-1.0, {}}, 0.01},
                                   StrengthGoal{{1.0, 0.0}, 0.01}, StrengthGoal{{1.0, {}}, 0.0}})
    EXPECT_THROW(search_strengths(goal, tests), std::invalid_argument);
}

// ---- made-up materials ------------------------------------------------------------------------------------

/// A number from -1 to 1 that hangs on s alone: bonds that break one by one.
double scatter(double s, double seed) {
  const double x = std::sin(std::round(std::log(s) * 50.0) * 12.9898 + seed) * 43758.5453;
  return 2.0 * (x - std::floor(x)) - 1.0;
}

struct Random {
  Made made;
  double noise = 0;
  bool monotone = true, has_failures = false;
};

Random random_material(Dice& dice) {
  Random m;
  const double T = dice.ratio(1e-6, 1e9), r = dice.ratio(1.5, 20), a = dice.ratio(0.1, 4),
               b = dice.ratio(0.2, 20), low = dice(0.1, 1);
  m.noise = dice.chance(0.4) ? 0.0 : dice.ratio(1e-3, 0.03);
  const double noise = m.noise, seed = dice(0, 100);
  const double hump = dice.chance(0.2) ? dice(-0.6, 0.6) : 0.0;
  m.monotone = hump == 0.0;
  m.made.f = [=](double s) { return T * (s / (s + a)) * (1.0 + noise * scatter(s, seed)); };
  m.made.g = [=](double s) {
    const double turn = 1.0 + hump * std::exp(-std::pow(std::log(s / 2.0), 2));
    return r * turn * (low + (1.0 - low) * s / (s + b)) * T * (s / (s + a)) *
           (1.0 + noise * scatter(s, seed + 1.0));
  };
  if (dice.chance(0.2)) m.made.p = dice(0.8, 1.1);
  if (dice.chance(0.15)) {
    const double bound = dice.ratio(2, 100);
    m.has_failures = true;
    m.made.fails = [=](const StrengthFactors& k) { return k.shear / k.tension > bound; };
  }
  return m;
}

// Never is a result reported that the material does not have; and without noise, failures and humps, a ratio
// that is well within 1/64 to 64 of factors is found.
Verdict judge(unsigned seed, Tally& tally) {
  Dice dice(seed);
  const Random m = random_material(dice);
  const auto ratio_at = [&](double s) { return m.made.g(s) / m.made.f(s); };
  const double s_wanted = dice.ratio(1.0 / 200, 200);
  const double least = ratio_at(1.0 / 64), most = ratio_at(64);
  const double ratio = dice.chance(0.25) ? dice.ratio(0.3 * least, 3 * most) : ratio_at(s_wanted);
  const double T = m.made.f(1.0) * dice.ratio(0.05, 20);
  const StrengthGoal goal{{T, ratio * T}, dice.one_of({0.003, 0.01, 0.03})};
  const StrengthSearch found = search(m.made, goal);
  tally.most("evaluations", static_cast<double>(found.all.size()));
  if (found.all.size() > most_strength_tests) return wrong("too many evaluations");
  if (static_cast<int>(found.all.size()) != m.made.tests) return wrong("evaluations that were not tested");
  if (found.end == StrengthSearchEnd::reached) {
    const StrengthFactors& k = found.all.at(*found.nearest).factors;
    const Strengths is = m.made.strengths(k);
    if (m.made.fails(k)) return wrong("factors without a strength");
    if (std::abs(*is.tensile / T - 1) > goal.within ||
        std::abs(*is.compressive / (ratio * T) - 1) > goal.within)
      return wrong("reported, but not met: " + std::to_string(*is.tensile / T) + " and " +
                   std::to_string(*is.compressive / (ratio * T)));
    return {"hit"};
  }
  if (found.nearest && !found.all[*found.nearest].ratio()) return wrong("the nearest has no ratio");
  // by the rule of two steps of less than 1 %, up to 2 % may lie beyond what was looked at, and some more
  const bool inside = ratio > 1.05 * least && ratio < 0.95 * most;
  if (inside && m.noise == 0.0 && m.monotone && !m.has_failures)
    return wrong("refused, but it can be had: " + std::to_string(ratio) + " of " + std::to_string(least) +
                 " to " + std::to_string(most));
  return {"refused"};
}

TEST(StrengthSearch, CampaignOfMadeUpMaterials) {
  const Tally tally = testing::campaign("strengths of made-up materials", 300, judge);
  if (tally.full) {
    EXPECT_GT(tally["hit"], tally.cases / 2);
    EXPECT_GT(tally["refused"], tally.cases / 10);
  }
}

}  // namespace
}  // namespace vbond::labtest
