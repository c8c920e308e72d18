#include "vbond/packing/pack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "vbond/packing/floaters.hpp"
#include "vbond/packing/grains.hpp"
#include "vbond/packing/sequential.hpp"
#include "vbond/packing/soft_spheres.hpp"

namespace vbond::packing {
namespace {

void scale(std::vector<double>& values, double factor) {
  for (double& x : values) x *= factor;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Grains lock before they have their sizes; when they are about as large as this density takes they fit.
struct Locked {
  std::size_t grains;
  double density;
};

class Packer {
 public:
  /// patience: steps of one search for balance at the sizes asked for, after which grains are taken to lock.
  explicit Packer(const Request& q, std::int64_t patience = 100'000)
      : q_(q), patience_(patience), volume_(volume_deeper_than(q.vessel, 0.0)), random_(q.seed) {
    if (!(volume_ > 0.0)) throw Refused("the vessel has no volume", "grains need room", "correct its walls");
    room_ = largest_radius(q.vessel);
    for (const Kind& k : q.kinds)
      if (k.sizes.largest() > room_ * (1.0 + 1e-9))
        throw Refused(fmt::format("grains of kind \"{}\" have radii up to {:.6g}", k.name, k.sizes.largest()),
                      "the vessel has no room for a grain that large",
                      fmt::format("the largest sphere in it has a radius of about {:.4g}", room_));
  }

  Packing run() {
    Packing p = std::visit([this](const auto& until) { return until_reached(until); }, q_.until);
    p.sizes_off = grains_.sizes_off;
    settle_floaters(q_, p);
    p.is = measure(q_.vessel, volume_, p.r, p.radius, touching_);
    return p;
  }

 private:
  /// Puts the grains in, smaller than they are.
  SoftSpheres put_in() {
    constexpr double density_at_first = 0.25;
    constexpr std::size_t most_draws = 200'000;
    const double density = volume_of(grains_.radius) / volume_;
    double factor = std::min(0.9, std::cbrt(density_at_first / density));
    for (; factor > 0.2; factor *= 0.8) {
      std::vector<double> small = grains_.radius;
      scale(small, factor);
      std::vector<Vec3d> r = add_sequentially(q_.vessel, small, random_, most_draws);
      if (r.size() == small.size()) return {q_.vessel, volume_, std::move(r), grains_.radius, q_.threads};
    }
    throw Refused(fmt::format("{} grains", grains_.radius.size()),
                  "not even grains a quarter as large find places in the vessel",
                  "take fewer or smaller grains");
  }

  double density(const SoftSpheres& s) const {
    return volume_of(s.radii()) / volume_ * s.scale() * s.scale() * s.scale();
  }

  Packing result(const SoftSpheres& s, const Relaxed& end) const {
    Packing p;
    p.r = s.positions();
    p.radius = s.radii();
    scale(p.radius, s.scale());
    p.kind = grains_.kind;
    p.size_factor = s.scale() * asked_factor_;
    p.pressure = end.pressure * 2.0 * mean_of(p.radius);
    p.iterations = s.iterations();
    return p;
  }

  Packing until_reached(const ToPorosity& until) {
    const double of_grains = (1.0 - until.porosity) * volume_;
    grains_ = make_grains(q_, of_grains / mean_volume(q_));
    asked_factor_ = std::cbrt(of_grains / volume_of(grains_.radius));
    const double largest = grains_.radius.front() * asked_factor_;
    if (largest > room_ * (1.0 + 1e-9))
      throw Refused(
          fmt::format("porosity = {:.6g}", until.porosity),
          fmt::format("{} grains of this porosity have radii up to {:.6g}, and the vessel has no room for "
                      "a grain that large",
                      grains_.radius.size(), largest),
          fmt::format(
              "these grains fit with a porosity of {:.4g} or more, or take smaller grains",
              1.0 - volume_of(grains_.radius) * std::pow(room_ / grains_.radius.front(), 3) / volume_));
    scale(grains_.radius, asked_factor_);
    return at_size();
  }

  Packing until_reached(const ToNumber& until) {
    grains_ = make_grains(q_, static_cast<double>(until.grains));
    return at_size();
  }

  /// Sizes are those asked for. Throws Locked.
  Packing at_size() {
    // nothing at random is a tenth denser than where grains lock, overlaps apart, but for a few in their
    // places
    constexpr std::size_t few = 50;
    const double left = 1.0 - std::min(0.5, q_.overlap), dense = expected_density(grains_.radius) + 0.1;
    const double most = grains_.radius.size() < few ? 1.0 : std::min(1.0, dense / (left * left * left));
    if (volume_of(grains_.radius) >= most * volume_)  // needs no trial
      throw Locked{grains_.radius.size(), most};
    constexpr std::int64_t short_search = 1000;  // steps: far from where grains lock a few hundred do
    SoftSpheres s = put_in();
    s.set_scale(1.0);
    RelaxGoal goal{q_.overlap, 0.0, 0.0, 1e-2, std::min(patience_, short_search)};
    Relaxed x = s.relax(goal);
    const bool near = x.largest_overlap < 5.0 * q_.overlap;  // to where grains lock
    if (!x.enough && (!x.balanced || near)) x = relax_smaller(s);
    // there the rest of the way to balance takes much from overlaps
    goal.unbalanced = 1e-3, goal.iterations = patience_;
    if (!x.enough && near) x = s.relax(goal);
    if (x.enough) return result(s, x);
    const double too_deep = 1.0 - 0.9 * std::min(1.0, q_.overlap / x.largest_overlap);
    s.set_scale(1.0 - slope * too_deep * x.mean_overlap);
    constexpr double far = 0.005;  // from where they lock: the line leads to somewhat too small a density
    const double least = x.mean_overlap > far ? expected_density(grains_.radius) : 0.0;
    throw Locked{grains_.radius.size(), std::max(density(s), least)};
  }

  /// Grains that are smaller by most of the overlap that may be left, with the rest of it for their own: such
  /// overlaps need not be in balance. Where grains just fit, this is reached long before the balance at full
  /// size, and often where that would leave larger overlaps.
  Relaxed relax_smaller(SoftSpheres& s) const {
    constexpr double most = 0.9;
    const double ratio = grains_.radius.front() / grains_.radius.back();
    RelaxGoal goal{(1.0 - most) * q_.overlap, 0.0, 0.0, 1e-2, patience_};
    s.set_scale(1.0 - most * q_.overlap / (1.0 + ratio));
    s.relax(goal);
    s.set_scale(1.0);
    goal = {q_.overlap, 0.0, 0.0, 1e-2, 0};
    return s.relax(goal);  // as they stand
  }

  Packing until_reached(const UntilJammed& until) {
    grains_ =
        make_grains(q_, until.grains ? static_cast<double>(*until.grains) : 0.64 * volume_ / mean_volume(q_));
    double guess = expected_density(grains_.radius);
    if (!until.grains) grains_ = make_grains(q_, guess * volume_ / mean_volume(q_));
    if (grains_.radius.size() < 2)
      throw Refused("jammed = true for one grain", "grains lock where they press on each other",
                    fmt::format("take smaller grains or a larger vessel; or leave jammed out: the largest "
                                "sphere in the vessel has a radius of about {:.4g}",
                                room_));
    for (int round = 0;; ++round) {
      constexpr double near = 0.003;
      Packing p = lock(guess, until.overlap);
      if (until.grains || round == 3 || std::abs(p.size_factor - 1.0) < near) return p;
      guess = volume_of(p.radius) / volume_;
      const double wanted = guess * volume_ / mean_volume(q_);
      if (std::round(wanted) == static_cast<double>(grains_.radius.size())) return p;
      grains_ = make_grains(q_, wanted);
    }
  }

  /// Lets them grow to beyond where they lock, and shrink until they just touch, or overlap by no more than
  /// they may, held by less and less pressure. What overlaps need not be as well in balance.
  Packing lock(double guess, std::optional<double> overlap) {
    constexpr double beyond = 0.011, at_last = 7e-7, least_change = 0.3, roughly = 1e-2;
    SoftSpheres s = put_in();
    RelaxGoal goal{0.0, 1e-5, 0.0, roughly, 1'000'000};
    Relaxed x;
    constexpr int most_tries = 10;
    for (int tries = 1; !x.balanced && tries <= most_tries; ++tries) {
      s.set_scale(std::cbrt((guess + tries * beyond) * volume_ / volume_of(grains_.radius)));
      x = s.relax(goal);
    }
    goal.mean_overlap = 0.0;
    while (x.balanced) {
      if (overlap ? x.largest_overlap <= *overlap : x.mean_overlap < 1.5 * at_last) {
        if (!overlap) touching_ = at_last * 2.0 * s.scale() * mean_of(grains_.radius);
        return result(s, x);
      }
      const double wanted = overlap ? 0.8 * *overlap / x.largest_overlap : at_last / x.mean_overlap;
      const double change = std::max(least_change, wanted);
      goal.growth = change * x.growth;
      if (!overlap) goal.unbalanced = change * x.mean_overlap < 1.5 * at_last ? 3e-4 : 1e-3;
      s.set_scale(s.scale() * (1.0 - slope * (1.0 - change) * x.mean_overlap));
      x = s.relax(goal);
    }
    throw Refused(fmt::format("{} grains do not lock", grains_.radius.size()),
                  fmt::format("no size was found at which they just touch; expected was a density of {:.3f}, "
                              "and they were pressed up to {:.3f}",
                              guess, guess + most_tries * beyond),
                  "few grains, and vessels hardly wider than them, may not lock: take more grains, another "
                  "seed, or a porosity");
  }

  static constexpr double slope = 1.6;  // change of size over mean overlap near where grains lock: measured
  const Request& q_;
  std::int64_t patience_;
  double volume_, room_ = 0, asked_factor_ = 1;
  double touching_ = 0;  // grains with gaps up to this count as touching  [length]
  Random random_;
  Grains grains_;
};

}  // namespace

double expected_density(const std::vector<double>& radii) {
  const double n = static_cast<double>(radii.size());
  const double mean = mean_of(radii);
  double m2 = 0.0, m3 = 0.0;
  for (const double R : radii) m2 += sq(R - mean) / n, m3 += (R - mean) * sq(R - mean) / n;
  const double d2 = m2 / sq(mean), d = std::sqrt(d2);
  if (!(d > 0.0)) return 0.634 + 0.005;
  return std::min(0.8, 0.634 + 0.005 + 0.0658 * d + 0.0857 * m3 / (m2 * std::sqrt(m2)) * d2);
}

namespace {

/// What is asked for, with as many grains as have somewhat less than this density: each time by more, as
/// walls may cost a small vessel a fifth.
void loosen(Request& q, const Locked& locked, int tries) {
  const double density = locked.density * (1.0 - 0.002 - 0.003 * tries * (1.0 + tries / 6.0));
  if (auto* porosity = std::get_if<ToPorosity>(&q.until)) {
    porosity->porosity = std::max(porosity->porosity, std::ceil(1e4 * (1.0 - density)) * 1e-4);
  } else if (auto* number = std::get_if<ToNumber>(&q.until)) {
    const double volume = volume_deeper_than(q.vessel, 0.0);
    const double fit = std::floor(density * volume / mean_volume(q));
    number->grains =
        static_cast<std::size_t>(std::clamp(fit, 1.0, static_cast<double>(number->grains) - 1.0));
  }
}

std::string in_words(const Request& q) {
  if (const auto* porosity = std::get_if<ToPorosity>(&q.until))
    return fmt::format("porosity = {:.6g}", porosity->porosity);
  return fmt::format("particles = {}", std::get<ToNumber>(q.until).grains);
}

/// Packs what is nearest to the request, to see that it can be had. Throws Refused with it.
[[noreturn]] void refuse(const Request& request, Locked locked) {
  const std::string rule =
      fmt::format("{} grains of these sizes lock before that, with overlaps above {:.3g} of a radius",
                  locked.grains, request.overlap);
  constexpr std::size_t quickly = 20'000;  // grains
  const bool is_quick = locked.grains <= quickly;
  Request nearest = request;
  for (int tries = 0; tries < 30; ++tries) {
    const bool one =
        std::holds_alternative<ToNumber>(nearest.until) && std::get<ToNumber>(nearest.until).grains == 1;
    if (one) break;
    loosen(nearest, locked, is_quick ? tries : 0);
    const std::string way_out =
        fmt::format("{} can be had ({}), or let grains overlap more", in_words(nearest),
                    is_quick ? "tried with this seed" : "about; it was not tried");
    try {
      constexpr std::int64_t patience = 20'000;
      if (is_quick) Packer(nearest, patience).run();
    } catch (const Locked& again) {
      locked.density = std::min(locked.density, again.density);
      continue;
    } catch (const Refused&) {  // too few for their shares
      break;
    }
    throw Refused(in_words(request), rule, way_out);
  }
  throw Refused(in_words(request), rule, "take smaller grains, a larger vessel, or let grains overlap more");
}

}  // namespace

Packing pack(const Request& request) {
  if (request.kinds.empty()) throw Refused("no kind of grains", "there is nothing to pack", "give one");
  try {
    return Packer(request).run();
  } catch (const Locked& locked) {
    refuse(request, locked);
  }
}

}  // namespace vbond::packing
