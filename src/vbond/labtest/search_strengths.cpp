#include "vbond/labtest/search_strengths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include "vbond/core/crossing.hpp"

namespace vbond::labtest {
namespace {

/// Logarithms of strengths over the factor of tension, at one factor of shear over tension.
struct Scaled {
  double tensile = 0, compressive = 0, toughness = 0;
  double miss = 0;  ///< of their ratio over the one that is asked for; one strength alone: 0
};

bool has_all(const Strengths& asked, const Strengths& found) {
  return (!asked.tensile || found.tensile) && (!asked.compressive || found.compressive) &&
         (!asked.toughness || found.toughness);
}

class Search {
 public:
  Search(const StrengthGoal& goal, const StrengthTests& tests)
      : goal_(goal), tests_(tests), both_(goal.asked.tensile && goal.asked.compressive) {}

  StrengthSearch run() {
    found_.end = both_ ? of_ratio() : of_scale();
    if (hit_)
      found_.end = StrengthSearchEnd::reached;
    else if (spent())
      found_.end = StrengthSearchEnd::given_up;
    if (hit_)
      found_.nearest = found_.all.size() - 1;
    else
      choose_nearest();
    return std::move(found_);
  }

 private:
  /// Factors at x = ln s: both strengths are met as well as one factor for both can, by similarity.
  StrengthFactors factors_at(double x) const {
    if (points_.empty()) return {1.0, std::exp(x)};
    const auto above = points_.lower_bound(x);
    const auto& hi = above == points_.end() ? *std::prev(above) : *above;
    const auto& lo = above == points_.begin() ? *above : *std::prev(above);
    const double width = hi.first - lo.first;
    const double part = above == points_.end() || !(width > 0.0) ? 1.0 : (x - lo.first) / width;
    const auto at = [&](double Scaled::*of) {
      return lo.second.*of + part * (hi.second.*of - lo.second.*of);
    };
    double sum = 0.0;
    if (goal_.asked.tensile) sum += std::log(*goal_.asked.tensile) - at(&Scaled::tensile);
    if (goal_.asked.compressive) sum += std::log(*goal_.asked.compressive) - at(&Scaled::compressive);
    if (goal_.asked.toughness) sum += std::log(*goal_.asked.toughness) - at(&Scaled::toughness);
    const double t = std::exp(both_ ? 0.5 * sum : sum);
    return {t, t * std::exp(x)};
  }

  /// How far ln C/T is from what is asked for at x = ln s. Where a common factor can mend the rest it is set
  /// anew, and tested again, some times. 0 ends the search. Nothing if there is no strength.
  std::optional<double> look(double x, int tries) {
    std::optional<double> miss;
    for (int k = 0; k < tries; ++k) {
      if (spent()) return 0.0;
      const StrengthFactors factors = factors_at(x);
      found_.all.push_back({factors, tests_(factors, goal_.asked)});
      const StrengthEvaluation& e = found_.all.back();
      if (!has_all(goal_.asked, e.found.strengths)) return miss;
      tell_ratio(e);
      if (meets(goal_, e.found.strengths)) {
        hit_ = true;
        return 0.0;
      }
      points_[x] = scaled(e);
      miss = points_[x].miss;
      if (!scale_can_mend(*miss)) return miss;
    }
    return std::copysign(std::max(std::abs(*miss), 1e-15), *miss);  // 0 would end the search
  }

  Scaled scaled(const StrengthEvaluation& e) const {
    const Strengths& s = e.found.strengths;
    Scaled to;
    if (s.tensile) to.tensile = std::log(*s.tensile / e.factors.tension);
    if (s.compressive) to.compressive = std::log(*s.compressive / e.factors.tension);
    if (s.toughness) to.toughness = std::log(*s.toughness / e.factors.tension);
    if (both_) to.miss = std::log(*e.ratio() / (*goal_.asked.compressive / *goal_.asked.tensile));
    return to;
  }
  /// With the best common factor one strength is too large by half of it, the other too small.
  bool scale_can_mend(double miss) const { return std::abs(miss) <= 2.0 * std::log1p(goal_.within); }
  bool spent() const { return hit_ || found_.all.size() >= most_strength_tests; }

  void tell_ratio(const StrengthEvaluation& e) {
    if (!both_) return;
    const double r = *e.ratio();
    if (!found_.ratios) found_.ratios = {r, r};
    found_.ratios = {std::min(found_.ratios->first, r), std::max(found_.ratios->second, r)};
  }

  StrengthSearchEnd of_scale() {
    constexpr int tries = 12;  // two are enough by similarity
    look(0.0, tries);
    return has_all(goal_.asked, found_.all.back().found.strengths) ? StrengthSearchEnd::no_scaling
                                                                   : StrengthSearchEnd::no_strength;
  }

  StrengthSearchEnd of_ratio() {
    const std::optional<double> miss = look(0.0, tries_);
    if (!miss) return StrengthSearchEnd::no_strength;
    const double first = *miss < 0.0 ? 1.0 : -1.0;  // more strength in shear, as a rule, for a larger ratio
    bool ends_without_strength = false;
    for (const double direction : {first, -first})
      if (!spent() && !bracket(direction, *miss, ends_without_strength)) break;
    if (spent()) return StrengthSearchEnd::given_up;
    if (!bracket_)
      return ends_without_strength ? StrengthSearchEnd::no_strength : StrengthSearchEnd::out_of_reach;
    return cross();
  }

  /// Doubles or halves s until a ratio is on the other side. False: it is.
  bool bracket(double direction, double first, bool& ends_without_strength) {
    double x = 0.0, miss = first;
    int idle = 0;
    for (int k = 1; k <= most_doublings && idle < 2; ++k) {
      double next = direction * std::numbers::ln2 * k;
      std::optional<double> found = look(next, tries_);
      const bool ends = !found;
      if (ends) next = 0.5 * (x + next), found = look(next, tries_);
      if (spent()) return true;
      ends_without_strength = ends_without_strength || ends;
      if (!found) return true;
      if (std::signbit(*found) != std::signbit(first)) {
        bracket_ = {Sample{x, miss}, Sample{next, *found}};
        return false;
      }
      if (ends) return true;
      constexpr double little = 0.01;
      idle = std::abs(*found - miss) < little || std::abs(*found) > std::abs(miss) ? idle + 1 : 0;
      x = next, miss = *found;
    }
    return true;
  }

  /// Within the bracket, and within others that have come up on the way.
  StrengthSearchEnd cross() {
    // strengths grow about as s at most: within a tenth of the tolerance nothing but a jump is left
    const double narrow = 0.1 * std::log1p(goal_.within);
    const auto value = [this](double x) { return look(x, tries_); };
    for (int k = 0; k < 3 && bracket_ && !spent(); ++k) {
      const Sample before_lo = bracket_->first, before_hi = bracket_->second;
      const Crossed crossed =
          CrossingSearch<const decltype(value)>(0.0, narrow, value).between(before_lo, before_hi);
      if (spent()) break;
      tell_jump(crossed);
      bracket_ = another_bracket(narrow, before_lo, before_hi);
    }
    for (const auto& [x, point] : points_)
      if (scale_can_mend(point.miss)) return StrengthSearchEnd::no_scaling;
    return StrengthSearchEnd::jumps;
  }

  std::optional<std::pair<Sample, Sample>> another_bracket(double narrow, const Sample& lo,
                                                           const Sample& hi) const {
    for (auto p = points_.begin(); p != points_.end() && std::next(p) != points_.end(); ++p) {
      const auto q = std::next(p);
      const bool same = std::min(lo.s, hi.s) == p->first && std::max(lo.s, hi.s) == q->first;
      if (!same && q->first - p->first > narrow &&
          std::signbit(p->second.miss) != std::signbit(q->second.miss))
        return std::pair{Sample{p->first, p->second.miss}, Sample{q->first, q->second.miss}};
    }
    return std::nullopt;
  }

  void tell_jump(const Crossed& crossed) {
    const auto at = [this](double x) {  // the last one tested there
      const double s = std::exp(x);
      for (std::size_t k = found_.all.size(); k-- > 0;) {
        const StrengthEvaluation& e = found_.all[k];
        if (e.ratio() && std::abs(e.factors.shear / e.factors.tension / s - 1.0) < 1e-12) return e;
      }
      return found_.all.front();
    };
    const auto [low, high] = std::minmax(crossed.lo.s, crossed.hi.s);
    found_.jump = {at(low), at(high)};
  }

  /// Of two strengths the ratio is what limits of bonds can hardly change; of ratios that are much alike, the
  /// one whose strengths are nearer.
  void choose_nearest() {
    constexpr double by_size = 0.05;
    double least = 0.0;
    for (std::size_t k = 0; k < found_.all.size(); ++k) {
      const StrengthEvaluation& e = found_.all[k];
      const Strengths& s = e.found.strengths;
      if (!has_all(goal_.asked, s)) continue;
      const double off =
          both_ ? std::abs(scaled(e).miss) + by_size * std::abs(std::log(*s.tensile / *goal_.asked.tensile))
          : goal_.asked.tensile     ? std::log(*s.tensile / *goal_.asked.tensile)
          : goal_.asked.compressive ? std::log(*s.compressive / *goal_.asked.compressive)
                                    : std::log(*s.toughness / *goal_.asked.toughness);
      if (!found_.nearest || std::abs(off) < least) found_.nearest = k, least = std::abs(off);
    }
  }

  static constexpr int tries_ = 3;

  const StrengthGoal& goal_;
  const StrengthTests& tests_;
  bool both_;
  bool hit_ = false;
  std::map<double, Scaled> points_;  ///< by ln s
  std::optional<std::pair<Sample, Sample>> bracket_;
  StrengthSearch found_;
};

/// What has been found of the strengths, judged by the toughness as well.
StrengthSearch with_toughness(const StrengthGoal& goal, const StrengthTests& tests, StrengthSearch search) {
  if (search.end != StrengthSearchEnd::reached) return search;
  StrengthFactors factors = search.all[*search.nearest].factors;
  const auto reached = [&] {
    search.nearest = search.all.size();
    search.all.push_back({factors, tests(factors, goal.asked)});
    const Strengths& found = search.all.back().found.strengths;
    if (!has_all(goal.asked, found)) search.end = StrengthSearchEnd::no_strength, search.nearest.reset();
    return !search.nearest || meets(goal, found);
  };
  if (reached()) return search;
  // by similarity each would be met by common factors in an interval: is there one in all of them?
  double least = 0.0, most = std::numeric_limits<double>::infinity();
  const Strengths found = search.all.back().found.strengths;
  for (const auto of : {&Strengths::tensile, &Strengths::compressive, &Strengths::toughness})
    if (goal.asked.*of) {
      least = std::max(least, *(goal.asked.*of) * (1.0 - goal.within) / *(found.*of));
      most = std::min(most, *(goal.asked.*of) * (1.0 + goal.within) / *(found.*of));
    }
  search.end = StrengthSearchEnd::grains;
  if (least > most) return search;
  const double by = std::sqrt(least * most);
  factors = {by * factors.tension, by * factors.shear};
  if (reached())
    search.end = search.nearest ? StrengthSearchEnd::reached : StrengthSearchEnd::no_strength;
  else
    search.end = StrengthSearchEnd::no_scaling;
  return search;
}

}  // namespace

double larger_grains(const Strengths& asked, const Strengths& found) {
  const auto of = asked.tensile ? &Strengths::tensile : &Strengths::compressive;
  const double by = *asked.toughness / *(asked.*of) / (*found.toughness / *(found.*of));
  return by * by;
}

bool meets(const StrengthGoal& goal, const Strengths& found) {
  const auto meets_one = [&](const std::optional<double>& asked, const std::optional<double>& x) {
    return !asked || (x && std::abs(*x / *asked - 1.0) <= goal.within);
  };
  return meets_one(goal.asked.tensile, found.tensile) &&
         meets_one(goal.asked.compressive, found.compressive) &&
         meets_one(goal.asked.toughness, found.toughness);
}

StrengthSearch search_strengths(const StrengthGoal& goal, const StrengthTests& tests) {
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  const Strengths& asked = goal.asked;
  if ((!asked.tensile && !asked.compressive && !asked.toughness) || !positive(asked.tensile.value_or(1.0)) ||
      !positive(asked.compressive.value_or(1.0)) || !positive(asked.toughness.value_or(1.0)) ||
      !positive(goal.within))
    throw std::invalid_argument("strengths that are asked for, and the tolerance, must be positive");
  if (!asked.toughness || (!asked.tensile && !asked.compressive)) return Search(goal, tests).run();
  StrengthGoal strengths = goal;
  strengths.asked.toughness.reset();
  return with_toughness(goal, tests, Search(strengths, tests).run());
}

}  // namespace vbond::labtest
