#include "vbond/packing/sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "vbond/core/scalar.hpp"

namespace vbond::packing {
namespace {

double below(double z) {  // of the standard normal distribution
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}
double bell(double z) {
  return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}
double cube(double x) {
  return x * x * x;
}
double fourth(double x) {
  return sq(sq(x));
}

void require(bool holds, const char* rule) {
  if (!holds) throw std::invalid_argument(rule);
}

struct Ends {
  double least, largest;
};

Ends ends(const EqualSizes& s) {
  return {s.radius, s.radius};
}
Ends ends(const TableSizes& s) {
  require(s.points.size() >= 2, "a curve of sizes has two points at least");
  require(s.points.front().second == 0.0 && s.points.back().second == 1.0,
          "a curve of sizes begins with the share 0 and ends with 1");
  for (std::size_t k = 1; k < s.points.size(); ++k) {
    require(s.points[k - 1].first < s.points[k].first, "the radii of a curve of sizes grow");
    require(s.points[k - 1].second <= s.points[k].second, "the shares of a curve of sizes do not fall");
  }
  return {s.points.front().first, s.points.back().first};
}
Ends ends(const UniformSizes& s) {
  return {s.from, s.to};
}
template <class Bell>
Ends ends(const Bell& s) {
  require(s.deviation > 0.0,
          "the standard deviation of sizes is above 0; equal sizes have a kind of their own");
  return {s.from, s.to};
}

double number_of(const EqualSizes& s, double R) {
  return R < s.radius ? 0.0 : 1.0;
}
double number_of(const UniformSizes&, double R) {
  return R;
}
double number_of(const NormalSizes& s, double R) {
  return below((R - s.mean) / s.deviation);
}
double number_of(const LognormalSizes& s, double R) {
  return below(std::log(R / s.median) / s.deviation);
}

/// Sums over the parts of a curve: part(a, b, share) for each, the last one up to R.
template <class Part>
double sum_of_parts(const TableSizes& s, double R, Part part) {
  double sum = 0.0;
  for (std::size_t k = 1; k < s.points.size() && s.points[k - 1].first < R; ++k) {
    const auto& [a, at_a] = s.points[k - 1];
    const auto& [b, at_b] = s.points[k];
    const double end = std::min(b, R);
    sum += part(a, end, (at_b - at_a) / (b - a));
  }
  return sum;
}
double number_of(const TableSizes& s, double R) {
  return sum_of_parts(s, R, [&](double a, double b, double slope) {
    return slope * (s.by_mass ? 0.5 * (1.0 / sq(a) - 1.0 / sq(b)) : b - a);
  });
}

double cubes_of(const EqualSizes& s, double R) {
  return R < s.radius ? 0.0 : cube(s.radius);
}
double cubes_of(const UniformSizes&, double R) {
  return 0.25 * fourth(R);
}
double cubes_of(const NormalSizes& s, double R) {
  const double m = s.mean, d = s.deviation, z = (R - m) / d;
  return (cube(m) + 3.0 * m * sq(d)) * below(z) -
         bell(z) * (3.0 * sq(m) * d + 3.0 * m * sq(d) * z + cube(d) * (sq(z) + 2.0));
}
double cubes_of(const LognormalSizes& s, double R) {
  const double d = s.deviation, z = std::log(R / s.median) / d;
  return cube(s.median) * std::exp(4.5 * sq(d)) * below(z - 3.0 * d);
}
double cubes_of(const TableSizes& s, double R) {
  return sum_of_parts(s, R, [&](double a, double b, double slope) {
    return slope * (s.by_mass ? b - a : 0.25 * (fourth(b) - fourth(a)));
  });
}

}  // namespace

Sizes::Sizes(SizeLaw law) : law_(std::move(law)) {
  const Ends e = std::visit([](const auto& s) { return ends(s); }, law_);
  least_ = e.least, largest_ = e.largest;
  require(least_ > 0.0 && std::isfinite(largest_), "radii of grains are above 0 and finite");
  require(std::holds_alternative<EqualSizes>(law_) || least_ < largest_,
          "the largest radius of a distribution is above the least; equal sizes have a kind of their own");
  if (std::holds_alternative<EqualSizes>(law_)) {
    number_1_ = 1.0, cubes_1_ = cube(largest_);
    return;
  }
  number_0_ = number(least_), number_1_ = number(largest_);
  cubes_0_ = cubes(least_), cubes_1_ = cubes(largest_);
  require(number_1_ > number_0_ && cubes_1_ > cubes_0_, "no grain lies between the ends of the distribution");
}

double Sizes::number(double radius) const {
  return std::visit([radius](const auto& s) { return number_of(s, radius); }, law_);
}
double Sizes::cubes(double radius) const {
  return std::visit([radius](const auto& s) { return cubes_of(s, radius); }, law_);
}
double Sizes::number_below(double radius) const {
  return (number(std::clamp(radius, least_, largest_)) - number_0_) / (number_1_ - number_0_);
}
double Sizes::volume_below(double radius) const {
  return (cubes(std::clamp(radius, least_, largest_)) - cubes_0_) / (cubes_1_ - cubes_0_);
}
double Sizes::mean_volume() const {
  return 4.0 / 3.0 * std::numbers::pi * (cubes_1_ - cubes_0_) / (number_1_ - number_0_);
}
bool Sizes::is_by_mass() const {
  const auto* table = std::get_if<TableSizes>(&law_);
  return table && table->by_mass;
}

double Sizes::quantile(double share) const {
  double low = least_, high = largest_;
  for (double middle; (middle = 0.5 * (low + high)) > low && middle < high;)
    (number_below(middle) < share ? low : high) = middle;
  return high;
}

std::vector<double> Sizes::radii(std::size_t n) const {
  std::vector<double> radii(n, largest_);
  if (std::holds_alternative<EqualSizes>(law_)) return radii;
  const double mean_cube = (cubes_1_ - cubes_0_) / (number_1_ - number_0_), of_all = static_cast<double>(n);
  double before = 0.0, lower = least_;
  for (std::size_t k = 0; k < n; ++k) {
    const double upper = k + 1 == n ? largest_ : quantile(static_cast<double>(k + 1) / of_all);
    const double volume = volume_below(upper);
    // differences of shares near 1 lose digits: the mean of a part lies in it
    radii[k] = std::clamp(std::cbrt(of_all * (volume - before) * mean_cube), lower, upper);
    before = volume, lower = upper;
  }
  return radii;
}

double Sizes::distance(const std::vector<double>& radii) const {
  const bool by_mass = is_by_mass();
  double all = 0.0, sum = 0.0, largest = 0.0;
  for (const double R : radii) all += by_mass ? cube(R) : 1.0;
  for (std::size_t first = 0, last; first < radii.size(); first = last) {  // of those that are equal
    const double R = radii[first], before = sum / all;
    for (last = first; last < radii.size() && radii[last] == R; ++last) sum += by_mass ? cube(R) : 1.0;
    const bool equal = std::holds_alternative<EqualSizes>(law_);
    const double asked = by_mass ? volume_below(R) : number_below(R);
    const double asked_before = equal && R <= least_ ? 0.0 : asked;  // a step, in place of a slope
    largest = std::max({largest, std::abs(sum / all - asked), std::abs(before - asked_before)});
  }
  return largest;
}

}  // namespace vbond::packing
