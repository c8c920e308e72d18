// The runner of campaigns: what it counts, what it fails, and what it says of a bad case.
#include "campaigns/judge.hpp"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

namespace vbond::campaign_test {
namespace {

using testing::Tally;
using testing::Verdict;

/// A variable of the environment, as long as this lives.
class Given {
 public:
  Given(const char* name, const char* value) : name_(name) {
    if (const char* const was = std::getenv(name)) was_ = was;
    value != nullptr ? setenv(name, value, 1) : unsetenv(name);
  }
  ~Given() { was_ ? setenv(name_, was_->c_str(), 1) : unsetenv(name_); }
  Given(const Given&) = delete;
  Given& operator=(const Given&) = delete;

 private:
  const char* name_;
  std::optional<std::string> was_;
};

Verdict odd_one(unsigned seed, Tally& all) {
  all.add("seeds", seed);
  all.most("seed", seed);
  switch (seed) {
    case 3: return testing::wrong("by 0.5");
    case 4: return {"missed", "the second"};
    case 5: throw std::runtime_error("out of range");
    case 6: throw NoEquilibrium("at load factor 0.5");
    case 7: return {"undecided"};
    default: return {};
  }
}

/// A campaign of eight such cases by default, its failures kept from this test.
struct OddOnes {
  ::testing::TestPartResultArray failures;
  Tally tally;
  OddOnes() {
    const ::testing::ScopedFakeTestPartResultReporter aside(
        ::testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &failures);
    tally = testing::campaign("odd ones", 8, odd_one);
  }
  std::string failure(int k) const { return failures.GetTestPartResult(k).message(); }
};

TEST(CampaignJudge, CountsAllCasesAndNamesTheSeedOfEachBadOne) {
  const Given all("VBOND_CAMPAIGN", nullptr), from("VBOND_CAMPAIGN_SEED", nullptr);
  const OddOnes run;
  EXPECT_EQ(run.tally.summary(),
            "8 cases: 1 aborted, 1 given up, 1 missed, 3 right, 1 undecided, 1 wrong; seeds 36; largest seed "
            "8.0e+00");
  EXPECT_TRUE(run.tally.full);
  ASSERT_EQ(run.failures.size(), 3);
  const char* const expected[] = {"wrong: by 0.5", "missed: the second", "aborted: out of range"};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NE(run.failure(k).find(expected[k]), std::string::npos) << run.failure(k);
    EXPECT_NE(run.failure(k).find("odd ones, seed " + std::to_string(k + 3)), std::string::npos)
        << run.failure(k);
  }
}

TEST(CampaignJudge, ExpectationsOfACaseNameItsSeed) {
  const Given all("VBOND_CAMPAIGN", "3"), from("VBOND_CAMPAIGN_SEED", nullptr);
  EXPECT_NONFATAL_FAILURE(testing::campaign("expecting", 8, [](unsigned seed) { EXPECT_NE(seed, 2u); }),
                          "expecting, seed 2");
}

TEST(CampaignJudge, TakesNumberAndFirstSeedFromTheEnvironment) {
  const Given from("VBOND_CAMPAIGN_SEED", "7");
  {
    const Given all("VBOND_CAMPAIGN", nullptr);
    const OddOnes alone;
    EXPECT_EQ(alone.tally.cases, 1u);
    EXPECT_EQ(alone.tally["undecided"], 1u);
    EXPECT_FALSE(alone.tally.full);
  }
  const Given all("VBOND_CAMPAIGN", "20");
  const OddOnes more;
  EXPECT_EQ(more.tally.sum("seeds"), 20 * 7 + 190);
  EXPECT_FALSE(more.tally.full);
  for (const char* bad : {"", "0", "-3", "many", "5x"}) {
    const Given none("VBOND_CAMPAIGN", bad);
    EXPECT_THROW(OddOnes(), std::invalid_argument) << bad;
  }
}

TEST(CampaignJudge, WhatIsNoNumberStaysTheLargest) {
  Tally tally;
  for (const double x : {1.0, std::numeric_limits<double>::quiet_NaN(), 2.0}) tally.most("x", x);
  EXPECT_TRUE(std::isnan(tally.largest("x")));
}

}  // namespace
}  // namespace vbond::campaign_test
