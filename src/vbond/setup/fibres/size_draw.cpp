#include "vbond/setup/fibres/size_draw.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace vbond {
namespace {

/// The part of Gauss's distribution below z.
double gauss_below(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

constexpr double far_out = 9.0;  // beyond it the part is below 1e-18

/// z below which the part p is, of what lies between two bounds.
double gauss_quantile(double u, double z_min, double z_max) {
  // the tails are taken from the side on which they are small, so that no digits are lost
  if (z_min > 0.0) return -gauss_quantile(1.0 - u, -z_max, -z_min);
  double low = std::max(z_min, -far_out), high = std::min(z_max, far_out);
  const double p = std::lerp(gauss_below(low), gauss_below(high), u);
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (gauss_below(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double quantile(const UniformSizes& s, double least, double u) {
  return std::lerp(std::max(s.min, least), s.max, u);
}
double quantile(const NormalSizes& s, double least, double u) {
  const auto z = [&s](double size) { return (size - s.mean) / s.deviation; };
  return s.mean + s.deviation * gauss_quantile(u, z(s.min.value_or(least)), z(s.max.value_or(INFINITY)));
}
double quantile(const LognormalSizes& s, double least, double u) {
  const auto z = [&s](double size) { return std::log(size / s.median) / s.deviation; };
  return s.median *
         std::exp(s.deviation * gauss_quantile(u, z(s.min.value_or(least)), z(s.max.value_or(INFINITY))));
}
double quantile(const SizeTable& s, double, double u) {
  std::vector<std::pair<double, double>> classes;  // size, share by number
  for (std::size_t k = 0; k < s.values.size(); ++k)
    classes.emplace_back(s.values[k], s.by == ShareOf::number ? s.shares[k] : s.shares[k] / s.values[k]);
  std::sort(classes.begin(), classes.end());
  double all = 0.0;
  for (const auto& [size, share] : classes) all += share;
  double below = 0.0;
  for (const auto& [size, share] : classes)
    if (below += share; share > 0.0 && u * all < below) return size;
  const auto last =
      std::find_if(classes.rbegin(), classes.rend(), [](const auto& c) { return c.second > 0.0; });
  return last->first;
}

}  // namespace

SizeDraw::SizeDraw(const SizeSpec& spec, double least) : spec_(spec), least_(least) {}

double SizeDraw::quantile(double u) const {
  return std::visit([&](const auto& form) { return vbond::quantile(form, least_, u); }, spec_.form);
}

double SizeDraw::mean() const {
  constexpr int parts = 20000;
  double sum = 0.0;
  for (int k = 0; k < parts; ++k) sum += quantile((k + 0.5) / parts);
  return sum / parts;
}

bool SizeDraw::is_empty() const {
  const auto beyond = [this](const auto& form) {
    if constexpr (requires { form.deviation; }) {
      const double low = form.min.value_or(least_), high = form.max.value_or(INFINITY);
      double z_low = 0.0, z_high = 0.0;
      if constexpr (requires { form.mean; })
        z_low = (low - form.mean) / form.deviation, z_high = (high - form.mean) / form.deviation;
      else
        z_low = std::log(low / form.median) / form.deviation,
        z_high = std::log(high / form.median) / form.deviation;
      return !(low < high) || z_low > far_out - 1.0 || z_high < 1.0 - far_out;
    } else {
      return false;
    }
  };
  return std::visit(beyond, spec_.form);
}

std::vector<double> SizeDraw::draw(std::size_t n, Random& random) const {
  std::vector<double> sizes(n);
  for (std::size_t k = 0; k < n; ++k)
    sizes[k] = quantile((static_cast<double>(k) + random.uniform()) / static_cast<double>(n));
  for (std::size_t k = n; k > 1; --k)
    std::swap(sizes[k - 1], sizes[static_cast<std::size_t>(random.uniform() * static_cast<double>(k))]);
  return sizes;
}

}  // namespace vbond
