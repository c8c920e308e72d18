// Ribbons, lattices and domes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "drawing.hpp"

namespace vbond::campaign {
namespace {

/// Bonds between all particles at most `reach` apart.
void join_near(BodyPlan& plan, BondSet set, double reach) {
  for (std::size_t i = 0; i < plan.r.size(); ++i)
    for (std::size_t j = i + 1; j < plan.r.size(); ++j)
      if (norm(plan.r[j] - plan.r[i]) < reach) set.pairs.push_back({i, j});
  plan.sets.push_back(std::move(set));
}

/// Rows of a triangular or square sheet in the x-y plane, spacing 1.
void add_rows(BodyPlan& plan, std::size_t columns, std::size_t rows, bool triangular) {
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t k = 0; k < columns; ++k)
      plan.r.push_back({static_cast<double>(k) + (triangular && row % 2 == 1 ? 0.5 : 0.0),
                        static_cast<double>(row) * (triangular ? std::sqrt(0.75) : 1.0), 0});
}

/// Corners and sides of a honeycomb of sides 1, cells in rows.
void add_honeycomb(BodyPlan& plan, std::size_t columns, std::size_t rows) {
  std::map<std::pair<long, long>, bool> seen;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t k = 0; k < columns; ++k)
      for (int corner = 0; corner < 6; ++corner) {
        const double x = std::sqrt(3.0) * (static_cast<double>(k) + (row % 2 == 1 ? 0.5 : 0.0));
        const double phi = M_PI / 6 + corner * M_PI / 3;
        const Vec3d r{x + std::cos(phi), 1.5 * static_cast<double>(row) + std::sin(phi), 0};
        if (seen.emplace(std::pair{std::lround(100 * r.x), std::lround(100 * r.y)}, true).second)
          plan.r.push_back(r);
      }
}

/// Particles within 0.1 of the lowest or the highest y.
Particles edge_along_y(const BodyPlan& plan, bool top) {
  const auto lower = [](const Vec3d& a, const Vec3d& b) { return a.y < b.y; };
  const auto [low, high] = std::minmax_element(plan.r.begin(), plan.r.end(), lower);
  const double y = top ? high->y : low->y;
  Particles edge;
  for (std::size_t k = 0; k < plan.r.size(); ++k)
    if (std::abs(plan.r[k].y - y) < 0.1) edge.push_back(k);
  return edge;
}

}  // namespace

BodyPlan ribbon(Dice& dice) {
  BodyPlan plan;
  plan.kind = "ribbon";
  const std::size_t rows = dice.count(2, 5), columns = dice.count(10, rows > 3 ? 40 : 70) + 1;
  add_rows(plan, columns, rows, true);
  plan.radius = 0.3;
  BondSet set{dice.chance(0.35) ? &bond_law<Evm> : &bond_law<VModel>,
              {1.0, dice.ratio(0.03, 0.5), dice.ratio(1e-4, 0.05), dice.ratio(1e-4, 0.03)},
              Vec3d{0, 0, 1},
              {}};
  join_near(plan, set, 1.1);
  Particles root, end;
  for (std::size_t row = 0; row < rows; ++row)
    root.push_back(row * columns), end.push_back((row + 1) * columns - 1);
  hold(plan, root, testing::clamped);
  const int how = dice.whole(0, 4);  // 0 to 2: tip aside, 3: pressed by force, 4: end moved
  if (how <= 2) load(plan, {end[dice.count(0, rows - 1)]}, {0, dice.chance(0.5) ? 1.0 : -1.0, 0});
  if (how == 3) load(plan, end, {-1.0 / static_cast<double>(rows), 0, 0});
  if (how == 4) hold(plan, end, testing::clamped, {-1, 0, 0});
  plan.turning = Turning::any;
  plan.what = fmt::format(
      "{} rows of {} bonds, {}, c_D = {:.3g}, c_B = {:.3g}, c_T = {:.3g}, {}", rows, columns - 1,
      how <= 2   ? "tip aside"
      : how == 3 ? "pressed"
                 : "end moved",
      set.stiffness.c_D, set.stiffness.c_B, set.stiffness.c_T, set.law == &bond_law<Evm> ? "EVM" : "V-model");
  return plan;
}

BodyPlan lattice(Dice& dice) {
  BodyPlan plan;
  const int form = dice.whole(0, 2);
  constexpr const char* forms[] = {"square lattice", "triangular lattice", "honeycomb"};
  plan.kind = forms[form];
  const Rod rod = random_rod(dice, 20, 1e4);
  if (form == 2)
    add_honeycomb(plan, dice.count(2, 6), dice.count(2, 6));
  else
    add_rows(plan, dice.count(3, 8), dice.count(3, 10), form == 1);
  BondSet set{rod.law, rod.stiffness(1.0), Vec3d{0, 0, 1}, {}};
  join_near(plan, set, 1.1);
  const bool in_space = dice.chance(0.15), moved = dice.chance(0.5);
  const Particles bottom = edge_along_y(plan, false), top = edge_along_y(plan, true);
  if (!in_space) keep_in_plane(plan);
  hold(plan, bottom, in_space ? testing::clamped : clamp_in_plane);
  HeldDofs guide = in_space ? testing::clamped : clamp_in_plane;
  guide[1] = moved;
  hold(plan, top, guide, moved ? Vec3d{0, -1, 0} : Vec3d{});
  if (!moved) load(plan, top, {0, -1, 0});
  plan.turning = moved ? (in_space ? Turning::any : Turning::about_z) : Turning::by_right_angles;
  plan.what =
      fmt::format("{} particles, {}{}, EA a^2/EI = {:.3g}, {}", plan.r.size(),
                  moved ? "top moved" : "top loaded", in_space ? ", in space" : "", rod.EA, words(rod));
  return plan;
}

/// Rings of bars on a cap, six bars from the apex.
BodyPlan dome(Dice& dice) {
  BodyPlan plan;
  plan.kind = "dome";
  const int rings = dice.whole(2, 5);
  const Rod rod = random_rod(dice, 30, 1e4);
  const double rise = rings * dice(0.08, 0.5);
  Particles rim, inside;
  for (int i = -rings; i <= rings; ++i)
    for (int j = -rings; j <= rings; ++j) {
      const int ring = std::max({std::abs(i), std::abs(j), std::abs(i + j)});
      if (ring > rings) continue;
      const double x = i + 0.5 * j, y = std::sqrt(0.75) * j;
      const double part = static_cast<double>(ring) / rings;
      (ring == rings ? rim : inside).push_back(plan.r.size());
      plan.r.push_back({x, y, rise * (1 - part * part)});
    }
  BondSet set{rod.law, rod.stiffness(1.0), Vec3d{0, 0, 1}, {}};
  for (std::size_t p = 0; p < plan.r.size(); ++p)
    for (std::size_t q = p + 1; q < plan.r.size(); ++q)
      if (std::hypot(plan.r[q].x - plan.r[p].x, plan.r[q].y - plan.r[p].y) < 1.1) set.pairs.push_back({p, q});
  plan.sets.push_back(std::move(set));
  const bool clamped = dice.chance(0.5), on_apex = dice.chance(0.5);
  hold(plan, rim, clamped ? testing::clamped : testing::translations);
  const auto apex =
      static_cast<std::size_t>(std::max_element(plan.r.begin(), plan.r.end(),
                                                [](const Vec3d& a, const Vec3d& b) { return a.z < b.z; }) -
                               plan.r.begin());
  load(plan, on_apex ? Particles{apex} : inside, {0, 0, -1});
  plan.turning = Turning::any;
  plan.what = fmt::format("{} rings, rise {:.3g}, rim {}, load on {}, EA a^2/EI = {:.3g}, {}", rings, rise,
                          clamped ? "clamped" : "hinged", on_apex ? "the apex" : "all", rod.EA, words(rod));
  return plan;
}

}  // namespace vbond::campaign
