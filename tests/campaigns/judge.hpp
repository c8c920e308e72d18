#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "vbond/core/error.hpp"

/// Campaigns: many random cases, each made from its seed, judged one by one and counted.
///
/// VBOND_CAMPAIGN=N           so many cases
/// VBOND_CAMPAIGN_SEED=S      the case of this seed alone; with VBOND_CAMPAIGN the N cases from this seed on
namespace vbond::testing {

/// A word for what became of a case. "wrong", "missed" and "aborted" are failures of the test; others are
/// counted, and the test may limit them.
struct Verdict {
  std::string word = "right", why{};
};
inline Verdict wrong(std::string why) {
  return {"wrong", std::move(why)};
}

/// Counts of a campaign, and figures of all its cases.
class Tally {
 public:
  unsigned cases = 0;
  /// From the first seed on as many cases as by default: others need not show all that a test asks for.
  bool full = false;
  unsigned operator[](const std::string& word) const { return value(words_, word); }
  void add(const std::string& what, double n = 1.0) { sums_[what] += n; }
  /// The largest of all cases is kept.
  void most(const std::string& what, double x) {
    double& largest = largest_.try_emplace(what, x).first->second;
    if (x > largest || std::isnan(x)) largest = x;  // what is no number stays
  }
  /// The same, and a failure of the present case from the limit on.
  void below(const std::string& what, double x, double limit) {
    most(what, x);
    EXPECT_LT(x, limit) << what;
  }
  double sum(const std::string& what) const { return value(sums_, what); }
  /// NaN if there is none of that name: no limit holds then.
  double largest(const std::string& what) const {
    const auto at = largest_.find(what);
    return at == largest_.end() ? std::numeric_limits<double>::quiet_NaN() : at->second;
  }

  void count(const std::string& word) { ++words_[word]; }
  std::string summary() const {
    std::string text = std::to_string(cases) + " cases";
    const char* before = ": ";
    for (const auto& [word, n] : words_) text += before + std::to_string(n) + " " + word, before = ", ";
    for (const auto& [what, n] : sums_) text += "; " + what + " " + number("%.6g", n);
    for (const auto& [what, x] : largest_) text += "; largest " + what + " " + number("%.1e", x);
    return text;
  }

 private:
  template <class T>
  static T value(const std::map<std::string, T>& of, const std::string& name) {
    const auto at = of.find(name);
    return at == of.end() ? T{} : at->second;
  }
  static std::string number(const char* format, double x) {
    char text[40];
    std::snprintf(text, sizeof text, format, x);
    return text;
  }
  std::map<std::string, unsigned> words_;
  std::map<std::string, double> sums_, largest_;
};

/// A whole number of the environment from 1 on, or `otherwise`.
inline unsigned number_of_environment(const char* name, unsigned otherwise) {
  const char* const given = std::getenv(name);
  if (given == nullptr) return otherwise;
  char* end = nullptr;
  const long n = std::strtol(given, &end, 10);
  if (end == given || *end != '\0' || n < 1 || n > 1000000000)
    throw std::invalid_argument(std::string(name) + "=" + given + " is no number of cases and no seed");
  return static_cast<unsigned>(n);
}

/// Failed expectations of the present test so far.
inline int failed_so_far() {
  const ::testing::TestResult& result = *::testing::UnitTest::GetInstance()->current_test_info()->result();
  int failed = 0;
  for (int k = 0; k < result.total_part_count(); ++k) failed += result.GetTestPartResult(k).failed();
  return failed;
}

/// Judges `otherwise` cases, or those that the environment asks for: one(seed) or one(seed, tally), which
/// returns a Verdict, or nothing where it has expectations of its own. Every failure names its seed. A case
/// that throws NoEquilibrium is "given up", one that throws anything else "aborted". Prints one line at the
/// end, and one for each case that is neither right nor a failure and has a reason.
template <class One>
Tally campaign(const std::string& name, unsigned otherwise, One&& one) {
  const unsigned first = number_of_environment("VBOND_CAMPAIGN_SEED", 1);
  const bool alone = std::getenv("VBOND_CAMPAIGN_SEED") != nullptr;
  Tally tally;
  tally.cases = number_of_environment("VBOND_CAMPAIGN", alone ? 1 : otherwise);
  tally.full = !alone && tally.cases >= otherwise;
  const auto ask = [&](unsigned seed) {
    if constexpr (std::is_invocable_v<One, unsigned, Tally&>)
      return one(seed, tally);
    else
      return one(seed);
  };
  for (unsigned seed = first; seed < first + tally.cases; ++seed) {
    const std::string which = name + ", seed " + std::to_string(seed);
    const ::testing::ScopedTrace trace(__FILE__, __LINE__, which);
    const int failed_before = failed_so_far();
    Verdict v;
    try {
      if constexpr (std::is_void_v<decltype(ask(seed))>)
        ask(seed);
      else
        v = ask(seed);
    } catch (const NoEquilibrium& e) {
      v = {"given up", e.what()};
    } catch (const std::exception& e) {
      v = {"aborted", e.what()};
    }
    if (v.word == "wrong" || v.word == "missed" || v.word == "aborted")
      ADD_FAILURE() << v.word << ": " << v.why;
    else if (failed_so_far() != failed_before)
      v.word = "wrong";
    else if (v.word != "right" && !v.why.empty())
      std::printf("%s: %s: %s\n", which.c_str(), v.word.c_str(), v.why.c_str());
    tally.count(v.word);
  }
  std::printf("%s, from seed %u: %s\n", name.c_str(), first, tally.summary().c_str());
  return tally;
}

}  // namespace vbond::testing
