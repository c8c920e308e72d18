#include "vbond/labtest/moduli.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace vbond::labtest {
namespace {

/// Slope of y over x by least squares. Nothing without two different x.
template <class X, class Y>
std::optional<double> slope(const std::vector<const Row*>& rows, X&& x, Y&& y) {
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (const Row* r : rows) mx += x(*r), my += y(*r);
  mx /= static_cast<double>(rows.size()), my /= static_cast<double>(rows.size());
  for (const Row* r : rows) xx += (x(*r) - mx) * (x(*r) - mx), xy += (x(*r) - mx) * (y(*r) - my);
  if (!(xx > 0.0)) return std::nullopt;
  return xy / xx;
}

/// Moduli and Poisson's ratios from these rows: of two rows their secant.
void find_moduli(const MadeTest& test, const std::vector<const Row*>& rows, TestResult& result) {
  const auto stress = [](const Row& r) { return r.at.stress; };
  result.modulus_by_ends = slope(
      rows, [](const Row& r) { return r.at.strain; }, stress);
  if (test.request.kind == Kind::brazilian) {
    result.modulus_by_ends.reset();
    return;
  }
  if (!test.gauge) {
    result.modulus = std::exchange(result.modulus_by_ends, std::nullopt);
    return;
  }
  const std::size_t columns = test.gauge->columns.size();
  if (std::any_of(rows.begin(), rows.end(), [&](const Row* r) { return r->gauge.size() < columns; })) {
    result.notes.push_back("the middle of the body has no strain: its particles lie in one plane");
    return;
  }
  const auto axial = [](const Row& r) { return r.gauge[0]; };
  result.modulus = slope(rows, axial, stress);
  if (columns < 3) return;
  const auto ratio = [&](std::size_t k) -> std::optional<double> {
    const auto s = slope(rows, axial, [k](const Row& r) { return r.gauge[k]; });
    if (!s) return s;
    return 0.0 - *s;  // never -0
  };
  result.nu_across = ratio(1), result.nu_third = ratio(2);
  if (result.nu_across && result.nu_third) result.nu = 0.5 * (*result.nu_across + *result.nu_third);
}

/// Tells where E and nu are those of a body that has cracked already.
bool tell_cracks_behind(const std::vector<Row>& rows, const Row& last, std::size_t peak, TestResult& result) {
  const double part = share_broken(rows, last, peak);
  if (part <= many_early) return false;
  const auto first =
      std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.broken > rows.front().broken; });
  result.notes.push_back(fmt::format(
      "E and nu are slopes of a body that cracks: {:.2g} of the breaks before the peak come before half of "
      "it; "
      "for elastic constants end the test before the first break (--strain {:.2g}), or test at rest",
      part, 0.9 * first->at.strain));
  return true;
}

/// Tells where the curve that E and nu are measured on is not straight.
void tell_bend(const std::vector<const Row*>& rows, double most, TestResult& result) {
  constexpr double much = 0.1;
  std::vector<const Row*> lower, upper;
  for (const Row* r : rows) (r->at.stress <= 0.3 * most ? lower : upper).push_back(r);
  if (lower.size() < 3 || upper.size() < 3) return;
  const auto slope_of = [](const std::vector<const Row*>& part) {
    return slope(
        part, [](const Row& r) { return r.at.strain; }, [](const Row& r) { return r.at.stress; });
  };
  const std::optional<double> first = slope_of(lower), second = slope_of(upper);
  if (!first || !second || std::abs(*second - *first) <= much * std::abs(*first)) return;
  result.notes.push_back(
      fmt::format("E and nu are slopes of a curve that bends: that of the ends goes from {:.4g} to {:.4g} "
                  "between a tenth "
                  "and half of the peak; for elastic constants give a smaller --strain, or test at rest",
                  *first, *second));
}

}  // namespace

void find_elastic(const MadeTest& test, const std::vector<Row>& rows, std::size_t peak, TestResult& result) {
  std::vector<const Row*> used;
  if (test.request.at_rest) {
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (rows[k].stage == 1 && (k == 0 || rows[k - 1].stage == 0)) used.push_back(&rows[k]);
    for (std::size_t k = rows.size(); k-- > 0;)
      if (rows[k].stage == 1) {
        used.push_back(&rows[k]);
        break;
      }
    result.stress_before = used.empty() ? 0.0 : used.front()->at.stress;
  } else {
    const double most = rows[peak].at.stress;
    for (std::size_t k = 0; k <= peak; ++k)
      if (rows[k].at.stress >= 0.1 * most && rows[k].at.stress <= 0.5 * most) used.push_back(&rows[k]);
    if (used.size() < 5) {
      result.notes.push_back(fmt::format(
          "only {} rows are between a tenth and half of the peak: no modulus; make the test slower "
          "with --rate, or end it sooner with --strain",
          used.size()));
      return;
    }
    if (!tell_cracks_behind(rows, *used.back(), peak, result)) tell_bend(used, most, result);
  }
  if (used.size() < 2) return result.notes.push_back("the run ended before the elastic stage: no modulus");
  find_moduli(test, used, result);
  if (!test.notch) return;
  result.toughness = Toughness{};
  if (const auto E =
          std::exchange(result.modulus, std::nullopt))  // of a whole beam: it says no more than this
    result.toughness->compliance = test.stress_per_force / (test.strain_per_way * *E);
}

}  // namespace vbond::labtest
