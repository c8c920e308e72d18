#include "vbond/fit/at_points.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/fit/curve.hpp"

namespace vbond::fit {
namespace {

constexpr double gap = std::numeric_limits<double>::quiet_NaN();

/// The rows that a point is compared with, for its curve and stage, and how each value moves them.
struct CurveOfRows {
  Curve curve;
  std::vector<Curve> rates;  ///< of the values; an empty one: not known
};

CurveOfRows curve_of(const Rows& rows, std::size_t column, const std::optional<std::size_t>& stage) {
  CurveOfRows of;
  Curve& c = of.curve;
  of.rates.resize(rows.slopes.size());
  for (std::size_t r = 0; r < rows.stage.size(); ++r) {
    if (stage ? rows.stage[r] != *stage : rows.only_of_stage[r] != 0) continue;
    const double x = rows.columns[0][r], y = rows.columns[column][r];
    if (c.x.empty() && !std::isfinite(x)) continue;
    c.x.push_back(std::isfinite(x) ? x : c.x.back());  // without a number the curve has a gap here
    c.y.push_back(std::isfinite(x) && std::isfinite(y) ? y : gap);
    for (std::size_t j = 0; j < rows.slopes.size(); ++j) {
      const auto& slopes = rows.slopes[j].columns;
      if (slopes.empty()) continue;
      of.rates[j].x.push_back(slopes[0][r]), of.rates[j].y.push_back(slopes[column][r]);
    }
  }
  return of;
}

}  // namespace

AtPoints at_points(const Rows& rows, const std::vector<Point>& points, const std::string& file,
                   const std::string& x) {
  AtPoints found;
  found.slopes.resize(rows.slopes.size());
  std::map<std::pair<std::size_t, std::optional<std::size_t>>, CurveOfRows> curves;
  for (const Point& p : points) {
    auto [at_curve, is_new] = curves.try_emplace({p.curve, p.stage});
    const CurveOfRows& of = at_curve->second;
    if (is_new) {
      at_curve->second = curve_of(rows, p.curve + 1, p.stage);
      if (const auto row = goes_back(of.curve))
        throw CaseError(
            Problem{{file, 0, 0},
                    fmt::format("{} goes back, from {} to {}", x, of.curve.x[*row - 1], of.curve.x[*row]),
                    "a curve has one value at each point of --x",
                    "compare with one stage (--stage, or a column stage in the data), or along time, step or "
                    "load_factor"});
    }
    const auto between = at(of.curve, p.x);
    found.y.push_back(between ? between->y : gap);
    found.off.push_back(between ? between->off : 0);
    for (std::size_t j = 0; j < rows.slopes.size(); ++j)
      if (!rows.slopes[j].columns.empty())
        found.slopes[j].push_back(of.rates[j].x.empty() ? gap : rate_at(of.curve, of.rates[j], p.x));
  }
  return found;
}

}  // namespace vbond::fit
