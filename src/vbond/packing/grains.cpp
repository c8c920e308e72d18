#include "vbond/packing/grains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace vbond::packing {
namespace {

constexpr double most_grains = 5e7;

/// What part of the number of grains each kind has.
std::vector<double> shares_of_number(const Request& q) {
  std::vector<double> share;
  for (const Kind& k : q.kinds) {
    const double each = q.share_by == ShareBy::number   ? 1.0
                        : q.share_by == ShareBy::volume ? k.sizes.mean_volume()
                                                        : k.sizes.mean_volume() * k.density;
    share.push_back(k.share / each);
  }
  const double all = std::accumulate(share.begin(), share.end(), 0.0);
  for (double& s : share) s /= all;
  return share;
}

}  // namespace

double mean_volume(const Request& q) {
  const std::vector<double> share = shares_of_number(q);
  double mean = 0.0;
  for (std::size_t k = 0; k < share.size(); ++k) mean += share[k] * q.kinds[k].sizes.mean_volume();
  return mean;
}

Grains make_grains(const Request& q, double wanted) {
  if (!(wanted < most_grains))
    throw Refused(fmt::format("{:.3g} grains", wanted),
                  fmt::format("a packing has {:.0g} at most", most_grains),
                  "take larger grains or a smaller vessel");
  const auto n = static_cast<std::size_t>(std::max(1.0, std::round(wanted)));
  const std::vector<double> share = shares_of_number(q);
  std::vector<std::size_t> count, order(share.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::size_t all = 0;
  for (const double s : share)
    count.push_back(static_cast<std::size_t>(s * static_cast<double>(n))), all += count.back();
  const auto rest = [&](std::size_t k) {
    return share[k] * static_cast<double>(n) - static_cast<double>(count[k]);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rest(a) > rest(b); });
  for (std::size_t k = 0; all < n; ++k, ++all) ++count[order[k % order.size()]];
  Grains grains;
  std::vector<std::pair<double, std::size_t>> sorted;
  for (std::size_t k = 0; k < count.size(); ++k) {
    if (count[k] == 0)
      throw Refused(fmt::format("none of {} grains is of kind \"{}\"", n, q.kinds[k].name),
                    fmt::format("its share of the number is {:.3g}", share[k]),
                    fmt::format("take {:.0f} grains at least: a larger vessel, or smaller grains",
                                std::ceil(1.0 / share[k])));
    const std::vector<double> radii = q.kinds[k].sizes.radii(count[k]);
    grains.sizes_off = std::max(grains.sizes_off, q.kinds[k].sizes.distance(radii));
    for (const double R : radii) sorted.emplace_back(R, k);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [R, k] : sorted) grains.radius.push_back(R), grains.kind.push_back(k);
  return grains;
}

}  // namespace vbond::packing
