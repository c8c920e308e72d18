// Packings of spheres in a periodic cell: what came out, beside what literature has; time and memory.
// Usage: packings SIZES UNTIL [grains = 10000] [seeds = 10] [threads = 1] [overlap] [first seed = 1]
// SIZES: equal, uniform (radii within a quarter of the mean), lognormal (deviation of ln R: 0.3)
// UNTIL: jammed, or a porosity
// overlap: 1e-3; of jammed grains 0, which lets them just touch
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

#include "vbond/packing/pack.hpp"

namespace vbond::packing {
namespace {

SizeLaw sizes_of(const std::string& name) {
  if (name == "uniform") return UniformSizes{0.75, 1.25};
  if (name == "lognormal") return LognormalSizes{1.0, 0.3, std::exp(-0.9), std::exp(0.9)};
  if (name != "equal") throw std::invalid_argument("SIZES is equal, uniform or lognormal, not " + name);
  return EqualSizes{1.0};
}

/// Equal for equal bits of all places, in this order.
std::uint64_t mark_of(const std::vector<Vec3d>& r) {
  std::uint64_t mark = 14695981039346656037u;
  for (const Vec3d& x : r)
    for (const double value : {x.x, x.y, x.z}) {
      std::uint64_t bits;
      std::memcpy(&bits, &value, sizeof bits);
      mark = (mark ^ bits) * 1099511628211u;
    }
  return mark;
}

double megabytes() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_maxrss) / 1024.0;
}

struct Mean {
  double sum = 0, squares = 0;
  int n = 0;
  void add(double x) { sum += x, squares += x * x, ++n; }
  std::string text(int digits) const {
    const double mean = sum / n, spread = n > 1 ? std::sqrt((squares - n * mean * mean) / (n - 1)) : 0.0;
    return fmt::format("{:.{}f} +- {:.{}f}", mean, digits, spread, digits);
  }
};

int run(int count, char** words) {
  const auto word = [&](int k, const char* otherwise) {
    return std::string(k < count ? words[k] : otherwise);
  };
  const std::string sizes = word(1, "equal"), until = word(2, "jammed");
  const double grains = std::stod(word(3, "10000"));
  const int seeds = std::stoi(word(4, "10")), first_seed = std::stoi(word(7, "1"));
  Request q;
  q.kinds.push_back({"grain", Sizes(sizes_of(sizes))});
  const bool jammed = until == "jammed";
  const double porosity = jammed ? 0.36 : std::stod(until);
  const double edge = std::cbrt(grains * q.kinds[0].sizes.mean_volume() / (1.0 - porosity));
  q.vessel.edges = {Vec3d{edge, 0, 0}, Vec3d{0, edge, 0}, Vec3d{0, 0, edge}};
  q.vessel.periodic = {true, true, true};
  for (const Vec3d& e : q.vessel.edges) q.vessel.cell.push_back({e, {}, {}, {}});
  q.threads = std::stoi(word(5, "1"));
  const double overlap = std::stod(word(6, jammed ? "0" : "1e-3"));
  if (jammed)
    q.until =
        UntilJammed{static_cast<std::size_t>(grains), overlap > 0.0 ? std::optional(overlap) : std::nullopt};
  else
    q.until = ToPorosity{porosity}, q.overlap = overlap;
  Mean density, off, contacts_off, rattlers, seconds, iterations;
  for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
    q.seed = static_cast<std::uint64_t>(seed);
    const auto start = std::chrono::steady_clock::now();
    Packing p;
    try {
      p = pack(q);
    } catch (const Refused& e) {
      fmt::print("refused: {}; {}; {}; {:.1f} s\n", e.what(), e.rule, e.way_out,
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      continue;
    }
    seconds.add(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    const auto n = static_cast<double>(p.r.size()), free = static_cast<double>(p.is.rattlers);
    const double formula = expected_density(p.radius) - 0.005, is = 1.0 - p.is.porosity;
    const double isostatic = 6.0 - 6.0 / (n - free);
    density.add(is), off.add(is - formula), rattlers.add(100.0 * free / n);
    contacts_off.add(100.0 * (p.is.backbone_contacts / isostatic - 1.0));
    iterations.add(static_cast<double>(p.iterations));
    fmt::print(
        "seed {}: {} grains, density {:.5f} (formula {:.4f}), backbone contacts {:.4f} (6 - 6/N' = {:.4f}), "
        "rattlers {:.2f} %, overlap {:.1e}, pressure {:.1e}, {} iterations, {:.1f} s, {:.0f} MB, mark "
        "{:016x}\n",
        seed, p.r.size(), is, formula, p.is.backbone_contacts, isostatic, 100.0 * free / n,
        p.is.largest_overlap, p.pressure, p.iterations, seconds.sum / seconds.n, megabytes(), mark_of(p.r));
    std::fflush(stdout);
  }
  if (density.n > 0)
    fmt::print(
        "{} {}, {} of {:.0f} grains, mean +- spread of seeds: density {}, over the formula {}, contacts "
        "off by {} %, rattlers {} %, {} iterations, {} s\n",
        sizes, until, density.n, grains, density.text(5), off.text(5), contacts_off.text(3), rattlers.text(2),
        iterations.text(0), seconds.text(1));
  return 0;
}

}  // namespace
}  // namespace vbond::packing

int main(int count, char** words) {
  return vbond::packing::run(count, words);
}
