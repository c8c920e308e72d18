// Arches, rings and helices.
#include <fmt/format.h>

#include <algorithm>

#include "drawing.hpp"

namespace vbond::campaign {
namespace {

/// Forces on an arch of N bonds, down; what they are in words.
std::string load_arch(Dice& dice, BodyPlan& plan, std::size_t N) {
  const std::size_t crown = N / 2;
  const double p = dice(0.0, 1.0);
  if (p < 0.5) {
    load(plan, {crown}, {0, -1, 0});
    return "load on the crown";
  }
  if (p < 0.65) {
    const std::size_t off = std::min(crown - 1, dice.count(1, 3));
    load(plan, {crown - off}, {0, -1, 0});
    return fmt::format("load {} off the crown", off);
  }
  if (p < 0.85) {
    Particles inner;
    for (std::size_t k = 1; k < N; ++k) inner.push_back(k);
    load(plan, inner, {0, -1.0 / static_cast<double>(N), 0});
    return "load on all";
  }
  const std::size_t quarter = std::max<std::size_t>(1, N / 4);
  load(plan, {quarter, N - quarter}, {0, -0.5, 0});
  return "loads at the quarters";
}

/// The crown is moved down by the support, and free to go aside.
std::string move_crown(BodyPlan& plan, std::size_t N, double way) {
  hold(plan, {N / 2}, {false, true, false, false, false, false}, {0, -way, 0});
  return "crown moved";
}

std::size_t even_or_odd(Dice& dice, std::size_t N) {
  return dice.chance(0.85) ? N + N % 2 : N;
}

}  // namespace

BodyPlan arch(Dice& dice) {
  BodyPlan plan;
  plan.kind = "arch";
  const std::size_t N = even_or_odd(dice, dice.log_count(8, 80));
  const Rod rod = random_rod(dice, 30, 1e7);
  const double degrees = dice(30, 270), half = degrees / 360 * M_PI;
  for (std::size_t k = 0; k <= N; ++k) {
    const double angle = half * (2 * static_cast<double>(k) / static_cast<double>(N) - 1);
    plan.r.push_back({std::sin(angle), std::cos(angle), 0});
  }
  plan.radius = 0.1 * half / static_cast<double>(N);
  plan.sets = {chain_of(plan, everybody(plan), rod)};
  plan.sets[0].n_2 = Vec3d{0, 0, 1};
  const int feet = dice.whole(0, 4);  // 0, 1: hinged; 2, 3: clamped; 4: one of each
  const bool in_space = feet == 2 || (feet == 3 && dice.chance(0.3));
  if (!in_space) keep_in_plane(plan);
  const HeldDofs clamp = in_space ? testing::clamped : clamp_in_plane;
  hold(plan, {0}, feet >= 2 ? clamp : hinge_in_plane);
  hold(plan, {N}, feet == 2 || feet == 3 ? clamp : hinge_in_plane);
  const bool moved = dice.chance(0.2);
  const std::string how = moved ? move_crown(plan, N, 1.0) : load_arch(dice, plan, N);
  plan.turning = moved ? Turning::by_right_angles : in_space ? Turning::any : Turning::about_z;
  plan.what = fmt::format("{:.4g} degrees, {}{}, {}, {} bonds, EA R^2/EI = {:.3g}, {}", degrees,
                          feet < 2    ? "hinged"
                          : feet == 4 ? "clamped and hinged"
                                      : "clamped",
                          in_space ? " in space" : "", how, N, rod.EA, words(rod));
  return plan;
}

BodyPlan shallow_arch(Dice& dice) {
  BodyPlan plan;
  plan.kind = "shallow arch";
  const std::size_t N = even_or_odd(dice, dice.log_count(8, 60));
  const Rod rod = random_rod(dice, 1e3, 1e7);
  const double thicknesses = dice(2.0, 16.0), rise = std::min(0.15, thicknesses / std::sqrt(rod.EA));
  for (std::size_t k = 0; k <= N; ++k) {
    const double along = static_cast<double>(k) / static_cast<double>(N);
    plan.r.push_back({along - 0.5, rise * std::sin(M_PI * along), 0});
  }
  plan.r.front().y = plan.r.back().y = 0.0;
  plan.radius = 0.1 / static_cast<double>(N);
  plan.sets = {chain_of(plan, everybody(plan), rod)};
  plan.sets[0].n_2 = Vec3d{0, 0, 1};
  keep_in_plane(plan);
  const bool clamped = dice.chance(0.3);
  hold(plan, {0, N}, clamped ? clamp_in_plane : hinge_in_plane);
  const bool moved = dice.chance(0.15);
  const std::string how = moved ? move_crown(plan, N, rise) : load_arch(dice, plan, N);
  plan.turning = moved ? Turning::by_right_angles : Turning::about_z;
  plan.what = fmt::format("rise {:.3g} sqrt(EI/EA), {}, {}, {} bonds, EA L^2/EI = {:.3g}, {}", thicknesses,
                          clamped ? "clamped" : "hinged", how, N, rod.EA, words(rod));
  return plan;
}

BodyPlan ring(Dice& dice) {
  BodyPlan plan;
  plan.kind = "ring";
  const std::size_t N = 4 * dice.count(3, 16);
  const Rod rod = random_rod(dice, 100, 1e6);
  for (std::size_t k = 0; k < N; ++k) {
    const double phi = 2 * M_PI * static_cast<double>(k) / static_cast<double>(N);
    plan.r.push_back({std::sin(phi), -std::cos(phi), 0});
  }
  plan.radius = 0.6 / static_cast<double>(N);
  plan.sets = {chain_of(plan, everybody(plan), rod)};
  plan.sets[0].pairs.push_back({N - 1, 0});
  plan.sets[0].n_2 = Vec3d{0, 0, 1};
  const std::size_t top = N / 2;
  const bool in_space = dice.chance(0.35);
  if (!in_space) keep_in_plane(plan);
  hold(plan, {0}, in_space ? testing::clamped : clamp_in_plane);
  const int how = dice.whole(0, 3);  // 0: pulled, 1: pushed, 2: dead pressure, 3: top moved
  const HeldDofs guided{true, how == 3, in_space, in_space, in_space, true};
  if (how != 2) hold(plan, {top}, guided, how == 3 ? Vec3d{0, -1, 0} : Vec3d{});
  if (how < 2) load(plan, {top}, {0, how == 0 ? 1.0 : -1.0, 0});
  if (how == 2)
    for (std::size_t k = 1; k < N; ++k) load(plan, {k}, (-2 * M_PI / static_cast<double>(N)) * plan.r[k]);
  constexpr const char* ways[] = {"pulled", "pushed", "dead pressure", "top moved"};
  plan.what = fmt::format("{}{}, {} bonds, EA R^2/EI = {:.3g}, {}", ways[how], in_space ? ", in space" : "",
                          N, rod.EA, words(rod));
  if (how == 2) plan.turning = in_space ? Turning::any : Turning::about_z;
  return plan;
}

BodyPlan helix(Dice& dice) {
  BodyPlan plan;
  plan.kind = "helix";
  const std::size_t per_turn = dice.count(8, 16);
  const double turns = dice(0.5, 4.0), pitch = dice(0.3, 3.0);
  const auto N = static_cast<std::size_t>(std::lround(turns * static_cast<double>(per_turn)));
  const Rod rod = random_rod(dice, 300, 1e6);
  for (std::size_t k = 0; k <= N; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(per_turn), phi = 2 * M_PI * t;
    plan.r.push_back({std::cos(phi), std::sin(phi), pitch * t});
  }
  plan.sets = {chain_of(plan, everybody(plan), rod)};
  hold(plan, {0}, testing::clamped);
  const bool moved = dice.chance(0.4), guided = moved || dice.chance(0.5);
  if (moved) hold(plan, {N}, testing::clamped, {0, 0, -1});
  if (guided && !moved) hold(plan, {N}, {true, true, false, true, true, true});
  if (!moved) load(plan, {N}, {0, 0, -1});
  plan.turning = guided && !moved ? Turning::by_right_angles : Turning::any;
  plan.what = fmt::format("{:.3g} turns, pitch {:.3g} R, {}, {} bonds, EA R^2/EI = {:.3g}, {}", turns, pitch,
                          moved    ? "top moved"
                          : guided ? "top guided"
                                   : "top free",
                          N, rod.EA, words(rod));
  return plan;
}

}  // namespace vbond::campaign
