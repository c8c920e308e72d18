#include "vbond/labtest/envelope.hpp"

#include <cmath>
#include <utility>

namespace vbond::labtest {
namespace {

/// y = at_zero + slope x.
struct Line {
  double slope = 0, at_zero = 0, r2 = 0;
};
std::optional<Line> line_through(const std::vector<std::pair<double, double>>& points) {
  const auto n = static_cast<double>(points.size());
  double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
  for (const auto& [x, y] : points) mx += x / n, my += y / n;
  for (const auto& [x, y] : points)
    xx += (x - mx) * (x - mx), xy += (x - mx) * (y - my), yy += (y - my) * (y - my);
  if (!(xx > 0.0)) return std::nullopt;
  const double slope = xy / xx;
  return Line{slope, my - slope * mx, yy > 0.0 ? xy * xy / (xx * yy) : 1.0};
}

}  // namespace

std::optional<MohrCoulomb> mohr_coulomb(const std::vector<PeakStresses>& peaks) {
  std::vector<std::pair<double, double>> points;
  for (const PeakStresses& p : peaks) points.push_back({p.s3, p.s1});
  const auto line = line_through(points);
  if (!line || !(line->slope >= 1.0) || !(line->at_zero > 0.0)) return std::nullopt;
  const double N = line->slope;
  return MohrCoulomb{N, line->at_zero, std::asin((N - 1.0) / (N + 1.0)), 0.5 * line->at_zero / std::sqrt(N),
                     line->r2};
}

std::optional<HoekBrown> hoek_brown(const std::vector<PeakStresses>& peaks) {
  std::vector<std::pair<double, double>> points;
  for (const PeakStresses& p : peaks) points.push_back({p.s3, (p.s1 - p.s3) * (p.s1 - p.s3)});
  const auto line = line_through(points);
  if (!line || !(line->slope > 0.0) || !(line->at_zero > 0.0)) return std::nullopt;
  const double s_ci = std::sqrt(line->at_zero);
  return HoekBrown{line->slope / s_ci, s_ci, line->r2};
}

}  // namespace vbond::labtest
