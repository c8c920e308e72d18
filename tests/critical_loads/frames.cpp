// Frames and trusses of rods.
#include <fmt/format.h>

#include "drawing.hpp"

namespace vbond::campaign {
namespace {

/// Particles along the straight lines between these corners, N bonds each, chained.
BodyPlan polyline(const std::vector<Vec3d>& corners, std::size_t N, const Rod& rod) {
  BodyPlan plan;
  for (std::size_t c = 0; c + 1 < corners.size(); ++c)
    for (std::size_t k = c == 0 ? 0 : 1; k <= N; ++k)
      plan.r.push_back(corners[c] +
                       static_cast<double>(k) / static_cast<double>(N) * (corners[c + 1] - corners[c]));
  plan.radius = 0.1 / static_cast<double>(N);
  for (std::size_t c = 0; c + 1 < corners.size(); ++c) {
    Particles leg;
    for (std::size_t k = 0; k <= N; ++k) leg.push_back(c * N + k);
    plan.sets.push_back(chain_of(plan, leg, rod));
  }
  return plan;
}

}  // namespace

BodyPlan portal(Dice& dice) {
  const std::size_t N = dice.log_count(4, 20);
  const Rod rod = random_rod(dice, 500, 1e7);
  const double width = dice(0.5, 2.0);
  BodyPlan plan = polyline({{0, 0, 0}, {0, 1, 0}, {width, 1, 0}, {width, 0, 0}}, N, rod);
  plan.kind = "portal";
  for (BondSet& s : plan.sets) s.n_2 = Vec3d{0, 0, 1};
  keep_in_plane(plan);
  const bool clamped = dice.chance(0.5);
  hold(plan, {0, 3 * N}, clamped ? clamp_in_plane : hinge_in_plane);
  const double aside = dice.chance(0.3) ? dice.ratio(1e-4, 0.1) : 0.0;
  const bool beam = dice.chance(0.25);
  if (beam)
    load(plan, {N + N / 2}, {aside, -1, 0});
  else
    load(plan, {N, 2 * N}, {aside, -1, 0});
  plan.turning = Turning::about_z;
  plan.what = fmt::format(
      "width {:.3g}, feet {}, load on the {}, aside {:.3g}, {} bonds a leg, EA L^2/EI = {:.3g}, {}", width,
      clamped ? "clamped" : "hinged", beam ? "beam" : "corners", aside, N, rod.EA, words(rod));
  return plan;
}

BodyPlan lees_frame(Dice& dice) {
  const std::size_t N = dice.log_count(5, 30);
  const Rod rod = random_rod(dice, 500, 1e6);
  const double beam = dice(0.5, 1.5);
  BodyPlan plan = polyline({{0, 0, 0}, {0, 1, 0}, {beam, 1, 0}}, N, rod);
  plan.kind = "Lee's frame";
  for (BondSet& s : plan.sets) s.n_2 = Vec3d{0, 0, 1};
  keep_in_plane(plan);
  hold(plan, {0, 2 * N}, hinge_in_plane);
  const std::size_t at = N + dice.count(0, N / 2);
  load(plan, {at}, {0, -1, 0});
  plan.turning = Turning::about_z;
  plan.what = fmt::format("beam {:.3g}, load {} of {} bonds from the corner, EA L^2/EI = {:.3g}, {}", beam,
                          at - N, N, rod.EA, words(rod));
  return plan;
}

/// A knee clamped at one end, loaded in its plane: it leaves it sideways.
BodyPlan bent_cantilever(Dice& dice) {
  const std::size_t N = dice.log_count(4, 20);
  Rod rod = random_rod(dice, 500, 1e5);
  rod.GJ = dice.ratio(0.05, 1.0);
  const double angle = dice(0.3, 2.6);
  BodyPlan plan = polyline({{0, 0, 0}, {1, 0, 0}, {1 + std::cos(angle), std::sin(angle), 0}}, N, rod);
  plan.kind = "bent cantilever";
  for (BondSet& s : plan.sets) s.n_2 = Vec3d{0, 0, 1};
  hold(plan, {0}, testing::clamped);
  const double way = dice(0, 2 * M_PI);
  load(plan, {2 * N}, {std::cos(way), std::sin(way), 0});
  plan.turning = Turning::any;
  plan.what = fmt::format(
      "knee of {:.3g} rad, load along {:.3g} rad, {} bonds a leg, GJ/EI = {:.3g}, EA L^2/EI = "
      "{:.3g}, {}",
      angle, way, N, rod.GJ, rod.EA, words(rod));
  return plan;
}

/// N bonds from particle 0 to a foot; the particle there.
std::size_t add_bar(BodyPlan& plan, const Vec3d& foot, std::size_t N, const Rod& rod) {
  Particles bar{0};
  for (std::size_t k = 1; k <= N; ++k) {
    bar.push_back(plan.r.size());
    plan.r.push_back(plan.r[0] + static_cast<double>(k) / static_cast<double>(N) * (foot - plan.r[0]));
  }
  plan.sets.push_back(chain_of(plan, bar, rod));
  plan.sets.back().n_2 = Vec3d{0, 0, 1};
  return bar.back();
}

/// Two bars and their apex, or a fan of several.
BodyPlan plane_truss(Dice& dice) {
  BodyPlan plan;
  plan.kind = "plane truss";
  const std::size_t N = dice.count(1, 8);
  const Rod rod = random_rod(dice, 300, 1e6);
  const double slope = dice(0.05, 1.2);
  Particles feet;
  plan.r.push_back({0, std::sin(slope), 0});
  const int bars = dice.chance(0.7) ? 2 : 3;
  for (int b = 0; b < bars; ++b) {
    const Vec3d foot{b == 0 ? -std::cos(slope) : b == 1 ? std::cos(slope) : 0.4 * std::cos(slope), 0, 0};
    feet.push_back(add_bar(plan, foot, N, rod));
  }
  plan.radius = 0.1 / static_cast<double>(N);
  keep_in_plane(plan);
  const bool clamped = dice.chance(0.4), moved = dice.chance(0.2);
  hold(plan, feet, clamped ? clamp_in_plane : hinge_in_plane);
  if (moved)
    hold(plan, {0}, {false, true, false, false, false, false}, {0, -std::sin(slope), 0});
  else
    load(plan, {0}, {0, -1, 0});
  plan.turning = moved ? Turning::by_right_angles : Turning::about_z;
  plan.what = fmt::format("{} bars, slope {:.3g} rad, {}, {}, {} bonds a bar, EA L^2/EI = {:.3g}, {}", bars,
                          slope, clamped ? "clamped" : "hinged", moved ? "apex moved" : "apex loaded", N,
                          rod.EA, words(rod));
  return plan;
}

/// Bars in space from one apex to feet on a circle.
BodyPlan star(Dice& dice) {
  BodyPlan plan;
  plan.kind = "star of bars";
  const std::size_t N = dice.count(1, 8);
  const int bars = dice.whole(3, 7);
  const Rod rod = random_rod(dice, 300, 1e6);
  const double slope = dice(0.05, 1.0), first = dice.chance(0.5) ? 0.0 : dice(0, 1);
  Particles feet;
  plan.r.push_back({0, 0, std::sin(slope)});
  for (int b = 0; b < bars; ++b) {
    const double phi = first + 2 * M_PI * b / bars;
    const Vec3d foot{std::cos(slope) * std::cos(phi), std::cos(slope) * std::sin(phi), 0};
    feet.push_back(add_bar(plan, foot, N, rod));
  }
  plan.radius = 0.1 / static_cast<double>(N);
  const bool clamped = dice.chance(0.5);
  hold(plan, feet, clamped ? testing::clamped : testing::translations);
  load(plan, {0}, {0, 0, -1});
  plan.turning = Turning::any;
  plan.what = fmt::format("{} bars, slope {:.3g} rad, feet {}, {} bonds a bar, EA L^2/EI = {:.3g}, {}", bars,
                          slope, clamped ? "clamped" : "hinged", N, rod.EA, words(rod));
  return plan;
}

}  // namespace vbond::campaign
