#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "packing/plain_packing.hpp"

/// Random requests, those that cannot be met among them: a packing must be what was asked for, judged pair by
/// pair, or be refused with something that can be had.
namespace vbond::packing::packing_campaign {
namespace {

using namespace packing::testing;
using vbond::testing::Dice;
using vbond::testing::Verdict;
using vbond::testing::wrong;

constexpr double pi = std::numbers::pi;

struct Plan {
  Request q;
  double volume = 0;  ///< by geometry
  const char* vessel = "";
  bool (*is_inside)(const Plan&, const Vec3d& r, double R) = nullptr;
  Vec3d size;
};

bool always(const Plan&, const Vec3d&, double) {
  return true;
}
bool in_box(const Plan& p, const Vec3d& r, double R) {
  return R <= std::min({r.x, r.y, r.z}) && R <= std::min({p.size.x - r.x, p.size.y - r.y, p.size.z - r.z});
}
bool in_cylinder(const Plan& p, const Vec3d& r, double R) {
  return R <= r.z && R <= p.size.z - r.z && std::hypot(r.x, r.y) + R <= p.size.x;
}
bool in_ball(const Plan& p, const Vec3d& r, double R) {
  return norm(r) + R <= p.size.x;
}
bool in_shell(const Plan& p, const Vec3d& r, double R) {
  return norm(r) + R <= p.size.x && norm(r) - R >= p.size.y;
}

void choose_vessel(Dice& dice, Plan& p) {
  const double s = dice(7, 11);
  switch (dice.below(6)) {
    case 0: p.vessel = "cube", p.q.vessel = cube(s), p.volume = s * s * s, p.is_inside = always; break;
    case 1: {
      const Vec3d a{s, 0, 0}, b{s * dice(-0.4, 0.4), s * dice(0.7, 1.3), 0},
          c{s * dice(-0.4, 0.4), s * dice(-0.4, 0.4), s * dice(0.7, 1.3)};
      p.vessel = "slanted cell", p.q.vessel = periodic_cell(a, b, c, dice.vector(5));
      p.volume = dot(a, cross(b, c)), p.is_inside = always;
      break;
    }
    case 2:
      p.size = {s, s * dice(0.5, 1.5), s * dice(0.5, 1.5)};
      p.vessel = "box", p.q.vessel = box(p.size), p.volume = p.size.x * p.size.y * p.size.z,
      p.is_inside = in_box;
      break;
    case 3:
      p.size = {0.5 * s, 0, s * dice(0.7, 2)};
      p.vessel = "cylinder", p.q.vessel = cylinder(p.size.x, p.size.z);
      p.volume = pi * p.size.x * p.size.x * p.size.z, p.is_inside = in_cylinder;
      break;
    case 4:
      p.size = {0.6 * s, 0, 0};
      p.vessel = "ball", p.q.vessel = hollow_ball(p.size.x);
      p.volume = 4.0 / 3.0 * pi * std::pow(p.size.x, 3), p.is_inside = in_ball;
      break;
    default:
      p.size = {0.7 * s, 0.2 * s, 0};
      p.vessel = "shell", p.q.vessel = hollow_ball(p.size.x);
      p.q.vessel.walls.push_back(ball({}, p.size.y, false));
      p.volume = 4.0 / 3.0 * pi * (std::pow(p.size.x, 3) - std::pow(p.size.y, 3)), p.is_inside = in_shell;
  }
}

SizeLaw some_sizes(Dice& dice, double scale) {
  switch (dice.below(5)) {
    case 0: return EqualSizes{scale};
    case 1: return UniformSizes{scale * dice(0.5, 0.9), scale * dice(1.0, 1.4)};
    case 2: return NormalSizes{scale, scale * dice(0.05, 0.25), 0.4 * scale, 1.6 * scale};
    case 3: return LognormalSizes{scale, dice(0.05, 0.3), 0.5 * scale, 2.0 * scale};
    default: {
      TableSizes t{{{scale * dice(0.4, 0.7), 0.0}}, dice.chance(0.5)};
      t.points.emplace_back(scale * dice(0.8, 1.0), dice(0.1, 0.9));
      t.points.emplace_back(scale * dice(1.1, 1.6), 1.0);
      return t;
    }
  }
}

Plan plan_of(unsigned seed) {
  Dice dice(seed);
  Plan p;
  choose_vessel(dice, p);
  p.q.seed = seed;
  const std::size_t kinds = dice.chance(0.25) ? 2 : 1;
  const double scale = dice.chance(0.06) ? dice(3, 8) : dice(0.6, 1.1);  // some have no room
  for (std::size_t k = 0; k < kinds; ++k)
    p.q.kinds.push_back({"abc" + std::to_string(k),
                         Sizes(some_sizes(dice, k == 0 ? scale : scale * dice(0.6, 1))), dice(0.3, 1),
                         dice(1, 3)});
  p.q.share_by = dice.one_of({ShareBy::number, ShareBy::volume, ShareBy::mass});
  p.q.overlap = dice.one_of({1e-3, 1e-3, 1e-2, 1e-4});
  const double what = dice(0, 1);
  if (what < 0.6)
    p.q.until = ToPorosity{dice.chance(0.75) ? dice(0.42, 0.8) : dice(0.0, 0.42)};
  else if (what < 0.9)
    p.q.until = ToNumber{dice.count(1, 260)};
  else
    p.q.until = dice.chance(0.5) ? UntilJammed{} : UntilJammed{{}, p.q.overlap};
  if (dice.chance(0.2)) p.q.floaters = dice.one_of({Floaters::remove, Floaters::grow}), p.q.neighbours = 3;
  return p;
}

/// A way out that names a porosity or a number is taken.
bool way_out_works(const Plan& p, const Refused& e, std::string& why) {
  const auto value = [&](const std::string& name) {
    const auto at = e.way_out.find(name + " = ");
    return at == std::string::npos ? -1.0 : std::stod(e.way_out.substr(at + name.size() + 3));
  };
  Request q = p.q;
  if (const double porosity = value("porosity"); porosity >= 0.0)
    q.until = ToPorosity{porosity};
  else if (const double number = value("particles"); number >= 0.0)
    q.until = ToNumber{static_cast<std::size_t>(number)};
  else
    return true;
  try {
    pack(q);
    return true;
  } catch (const Refused& again) {
    why = fmt::format("refused with \"{}\", and so is that: {}; {}", e.way_out, again.what(), again.rule);
    return false;
  }
}

Verdict judge(unsigned seed, vbond::testing::Tally& tally) {
  const Plan p = plan_of(seed);
  Packing is;
  try {
    is = pack(p.q);
  } catch (const Refused& e) {
    if (e.way_out.empty() || e.rule.empty()) return wrong("refused without a way out");
    std::string why;
    if (!way_out_works(p, e, why)) return wrong(why);
    return {"refused"};
  }
  const std::size_t n = is.r.size();
  if (n == 0 || is.radius.size() != n || is.kind.size() != n) return wrong("arrays of different length");
  tally.add("grains", static_cast<double>(n));
  tally.add(std::string("in a ") + p.vessel);
  const bool jammed = std::holds_alternative<UntilJammed>(p.q.until);
  const double overlap = deepest_overlap(p.q.vessel, is);
  tally.most("overlap over that allowed", overlap / p.q.overlap);
  if (!(overlap <= p.q.overlap * (1.0 + 1e-9)))
    return wrong(fmt::format("grains overlap by {:.3g}", overlap));
  if (std::abs(is.is.largest_overlap - overlap) > 1e-9) return wrong("another overlap is told");
  for (std::size_t i = 0; i < n; ++i) {
    if (!p.is_inside(p, is.r[i], is.radius[i] * (1.0 - 1.001 * p.q.overlap)))
      return wrong(fmt::format("grain {} is not in the vessel", i));
    const Sizes& s = p.q.kinds[is.kind[i]].sizes;
    const double asked = is.radius[i] / is.size_factor;
    if (asked < s.least() * (1 - 1e-9) || asked > s.largest() * (1 + 1e-9))
      return wrong("a grain has a size not asked for");
  }
  const double porosity = 1.0 - volume_of_grains(is) / p.volume;
  if (std::abs(porosity - is.is.porosity) > 2e-4) return wrong("another porosity is told");
  const bool changed = is.removed + is.grown > 0;
  if (const auto* to = std::get_if<ToPorosity>(&p.q.until);
      to && !changed && std::abs(porosity - to->porosity) > 1e-3)
    return wrong(fmt::format("porosity {} in place of {}", porosity, to->porosity));
  if (const auto* to = std::get_if<ToNumber>(&p.q.until);
      to && (n + is.removed != to->grains || is.size_factor != 1.0))
    return wrong("another number of grains, or sizes");
  if (jammed && n > 100 && (porosity < 0.2 || porosity > 0.55))
    return wrong(fmt::format("{} grains lock at a porosity of {}", n, porosity));
  if (p.q.floaters == Floaters::remove) {
    const std::vector<int> k = count_neighbours(p.q.vessel, is.r, is.radius, p.q.gap);
    if (*std::min_element(k.begin(), k.end()) < p.q.neighbours) return wrong("a floater is left");
  }
  return {jammed ? "locked" : "reached"};
}

TEST(PackingCampaign, EveryRequestIsMetOrRefusedWithAWayOut) {
  const auto tally = vbond::testing::campaign("packings", 12, judge);
  if (tally.full) {
    EXPECT_GT(tally["reached"], 3u);
  }
}

}  // namespace
}  // namespace vbond::packing::packing_campaign
