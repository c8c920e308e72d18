#include "vbond/model/rules.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>
#include <type_traits>

namespace vbond {

const BondRules& kept(const BondRules& rules) {
  static std::mutex mutex;
  static std::deque<BondRules> all;  // a deque: its elements stay where they are
  if (rules == no_rules) return no_rules;
  const std::lock_guard lock(mutex);
  const auto at = std::find(all.begin(), all.end(), rules);
  return at != all.end() ? *at : all.emplace_back(rules);
}

namespace {

/// Calls f with every number of the rules, in the order of files.
template <class Rules, class F>
void visit(Rules& r, F f) {
  auto& [stretch, strength, damped, yield, creep, softening, rubbing] = r;
  f(stretch.form), f(stretch.k3), f(stretch.k4), f(stretch.compression), f(stretch.largest), f(stretch.alpha);
  f(strength.criterion);
  f(strength.axial), f(strength.shear), f(strength.bending), f(strength.torsion), f(strength.friction);
  f(strength.compression), f(strength.compression_bending), f(strength.signed_axial);
  f(strength.tension_limit), f(strength.shear_limit), f(strength.compression_limit);
  f(strength.own_section);
  f(damped);
  for (auto* limits : {&yield.limit, &yield.isotropic, &yield.kinematic})
    f(limits->axial), f(limits->shear), f(limits->bending), f(limits->torsion);
  f(yield.compression);
  f(creep.rate), f(creep.exponent);
  f(softening.force), f(softening.length);
  f(stretch.table.count);
  for (std::size_t k = 0; k < StretchTable::most; ++k)
    f(stretch.table.D[k]), f(stretch.table.U[k]), f(stretch.table.curvature[k]);
  f(rubbing.friction), f(rubbing.reach);  // files of earlier versions end before them
}

}  // namespace

RuleNumbers numbers_of(const BondRules& rules) {
  RuleNumbers numbers{};
  std::size_t at = 0;
  visit(rules, [&](const auto& x) { numbers[at++] = static_cast<double>(x); });
  return numbers;
}

std::optional<BondRules> rules_of(const RuleNumbers& numbers) {
  BondRules rules;
  std::size_t at = 0;
  bool good = true;
  const auto whole = [&](double x, double most) {
    good = good && x >= 0.0 && x <= most && x == std::floor(x);
    return good ? x : 0.0;
  };
  visit(rules, [&]<class T>(T& x) {
    const double number = numbers[at++];
    if constexpr (std::is_same_v<T, double>)
      x = number;
    else if constexpr (std::is_same_v<T, StretchForm>)
      x = static_cast<T>(whole(number, static_cast<double>(StretchForm::table)));
    else if constexpr (std::is_same_v<T, Criterion>)
      x = static_cast<T>(whole(number, static_cast<double>(Criterion::elongation)));
    else
      x = static_cast<T>(whole(number, std::is_same_v<T, bool> ? 1.0 : StretchTable::most));
  });
  if (rules.stretch.form == StretchForm::table && rules.stretch.table.count < 3) return std::nullopt;
  return good ? std::optional(rules) : std::nullopt;
}

}  // namespace vbond
