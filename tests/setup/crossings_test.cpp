// Crossings of fibres, bonded where their axes are nearest: against a search of all pairs by other formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "../campaigns/dice.hpp"
#include "../campaigns/judge.hpp"
#include "plain_fibres.hpp"
#include "vbond/setup/crossings.hpp"

namespace vbond::crossings_test {
namespace {

using plain_fibres::to_segment;
using vbond::testing::Dice;
using vbond::testing::Tally;

// ---- by brute force --------------------------------------------------------------------------------

using Place = std::tuple<std::size_t, int, int, int>;  // a particle and its image

struct Segment {
  Place ends[2];
  double R;
};
/// A segment and an image of another, near each other.
struct Candidate {
  Segment x, y;
  double s, t, gap;
  bool may_touch;
};

Place moved(const Place& p, int a, int b, int c) {
  return {std::get<0>(p), std::get<1>(p) + a, std::get<2>(p) + b, std::get<3>(p) + c};
}
Segment moved(Segment s, int a, int b, int c) {
  for (Place& p : s.ends) p = moved(p, a, b, c);
  return s;
}
bool meet(const Segment& x, const Segment& y) {
  return std::any_of(std::begin(x.ends), std::end(x.ends),
                     [&](const Place& p) { return p == y.ends[0] || p == y.ends[1]; });
}

struct Body {
  std::vector<Vec3d> r;
  std::array<Vec3d, 3> edges{};
  std::array<int, 3> far{};
  std::vector<Segment> segments;

  Vec3d at(const Place& p) const {
    const auto [k, a, b, c] = p;
    return r[k] + double(a) * edges[0] + double(b) * edges[1] + double(c) * edges[2];
  }
  bool bonded(const Place& p, const Place& q) const {
    for (const Segment& s : segments)
      for (const int e : {0, 1}) {
        if (std::get<0>(s.ends[e]) != std::get<0>(p)) continue;
        const auto shift = [&](std::size_t k) {
          return k == 0   ? std::get<1>(p) - std::get<1>(s.ends[e])
                 : k == 1 ? std::get<2>(p) - std::get<2>(s.ends[e])
                          : std::get<3>(p) - std::get<3>(s.ends[e]);
        };
        if (moved(s.ends[1 - e], shift(0), shift(1), shift(2)) == q) return true;
      }
    return false;
  }
  bool may_touch(const Segment& x, const Segment& y) const {
    for (const Place& p : x.ends)
      for (const Place& q : y.ends)
        if (p == q || bonded(p, q)) return false;
    return true;
  }
};

/// Where two segments are nearest, by thirds: the distance of a point of one to the other is convex.
void nearest(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, Candidate& to) {
  double low = 0.0, high = 1.0;
  for (int k = 0; k < 90; ++k) {
    const double s = low + (high - low) / 3.0, t = high - (high - low) / 3.0;
    (to_segment(a + s * (b - a), c, d) < to_segment(a + t * (b - a), c, d) ? high : low) =
        to_segment(a + s * (b - a), c, d) < to_segment(a + t * (b - a), c, d) ? t : s;
  }
  to.s = 0.5 * (low + high);
  const Vec3d p = a + to.s * (b - a);
  to.t = std::clamp(dot(p - c, d - c) / norm2(d - c), 0.0, 1.0);
  to.gap = norm(c + to.t * (d - c) - p) - to.x.R - to.y.R;
}

template <class Visit>
void for_images(const std::array<int, 3>& far, Visit visit) {
  for (int a = -far[0]; a <= far[0]; ++a)
    for (int b = -far[1]; b <= far[1]; ++b)
      for (int c = -far[2]; c <= far[2]; ++c) visit(a, b, c);
}

std::vector<Candidate> candidates(const Body& body, double gap) {
  std::vector<Candidate> all;
  for (std::size_t k = 0; k < body.segments.size(); ++k)
    for (std::size_t l = k; l < body.segments.size(); ++l)
      for_images(body.far, [&](int a, int b, int c) {
        if (k == l && !(std::tuple(a, b, c) > std::tuple(0, 0, 0))) return;
        const Segment &x = body.segments[k], y = moved(body.segments[l], a, b, c);
        Candidate near{x, y, 0, 0, 0, body.may_touch(x, y)};
        const Vec3d p = body.at(x.ends[0]), q = body.at(x.ends[1]), u = body.at(y.ends[0]),
                    v = body.at(y.ends[1]);
        if (norm(p + q - u - v) > norm(p - q) + norm(u - v) + 2.0 * (x.R + y.R + gap)) return;
        nearest(p, q, u, v, near);
        if (near.gap <= gap) all.push_back(near);
      });
  return all;
}

/// Whether two candidates are next to each other: both segments are the same or meet, after some shift.
bool next_to(const Body& body, const Candidate& c, const Candidate& d) {
  bool found = false;
  std::array<int, 3> wide = body.far;
  for (int& w : wide) w *= 2;
  for (const bool swapped : {false, true})
    for_images(wide, [&](int a, int b, int e) {
      const Segment x = moved(swapped ? d.y : d.x, a, b, e), y = moved(swapped ? d.x : d.y, a, b, e);
      found = found || (meet(c.x, x) && meet(c.y, y));
    });
  return found;
}

Body body_of(const Built& built) {
  Body body;
  body.r = built.state.r.values();
  for (const Bond& b : built.state.bonds)
    if (capsule_of(b) > 0.0)
      body.segments.push_back(
          {{{b.i.value, 0, 0, 0}, {b.j.value, image_of_j(b).a, image_of_j(b).b, image_of_j(b).c}},
           capsule_of(b)});
  body.edges = built.model.cell.edges;
  for (std::size_t k = 0; k < 3; ++k) body.far[k] = built.model.cell.periodic[k] ? 2 : 0;
  return body;
}

// Random mats, open and in tilted cells, after a random shake, so that fibres cross and lie along each other.
TEST(Crossings, AreWhereAPlainSearchFindsThem) {
  const Tally tally = testing::campaign("crossings", 30, [](unsigned seed, Tally& t) {
    Dice dice(seed);
    const double side = dice(2.2, 3.0), tilt = dice(-0.5, 0.5);
    const bool cell = dice.chance(0.6);
    const std::string vessel = cell ? "" : "box = { min = [0, 0, 0], max = [2.5, 2.5, 1.5] }\n",
                      before = cell ? "[contact]\nlaw = \"hertz\"\nE = 10\nnu = 0.3\n[cell]\na = [" +
                                          std::to_string(side) + ", 0, 0]\nb = [" + std::to_string(tilt) +
                                          ", " + std::to_string(side) + ", 0]\nc = [0, 0, 1.8]\n"
                                    : "[contact]\nlaw = \"hertz\"\nE = 10\nnu = 0.3\n";
    Built built = build(plain_fibres::fibres(
        "fibres = 14\nlength = 1.6\ndiameter = 0.16\nspacing = 0.4\ncurl = 0.9\ndensity = 1\nseed = " +
            std::to_string(seed) + "\n" + vessel,
        before, "capsule_radius = \"particles\"\n"));
    for (Vec3d& r : built.state.r) r = r + dice.vector(0.12);
    const double gap = dice.ratio(1e-3, 0.1);
    const Body body = body_of(built);
    const std::vector<Candidate> all = candidates(body, gap);
    constexpr double close = 1e-7;  // gaps nearer than this are not told apart: such a body is passed over
    std::map<std::tuple<Place, Place>, double> wanted;  // pair and least gap
    const auto pair_of = [&](const Candidate& c) {
      Place i = c.x.ends[c.s <= 0.5 ? 0 : 1], j = c.y.ends[c.t <= 0.5 ? 0 : 1];
      const auto key = [](const Place& p, const Place& q) {
        return std::tuple(moved(p, -std::get<1>(p), -std::get<2>(p), -std::get<3>(p)),
                          moved(q, -std::get<1>(p), -std::get<2>(p), -std::get<3>(p)));
      };
      return std::get<0>(i) < std::get<0>(j) || (std::get<0>(i) == std::get<0>(j) && key(i, j) > key(j, i))
                 ? key(i, j)
                 : key(j, i);
    };
    for (const Candidate& c : all) {
      if (!c.may_touch) continue;  // it only keeps others from being the least
      if (std::abs(c.gap - gap) < close || std::abs(c.s - 0.5) < 1e-6 || std::abs(c.t - 0.5) < 1e-6)
        return t.add("given up: on an edge");
      bool least = true;
      for (const Candidate& d : all) {
        if (&d == &c || d.gap > c.gap + close || !next_to(body, c, d)) continue;
        if (d.gap < c.gap - close)
          least = false;
        else if (&d < &c)  // at a particle, where both of its segments are as near: one of them
          least = false;
      }
      if (!least) continue;
      const auto [at, is_new] = wanted.emplace(pair_of(c), c.gap);
      if (!is_new) at->second = std::min(at->second, c.gap);
    }
    const std::vector<Crossing> found = crossings_within(built.model, built.state, built.state.bonds, gap);
    t.add("crossings", double(found.size()));
    std::map<std::tuple<Place, Place>, double> got;
    for (const Crossing& c : found) {
      const Image n = c.pair.image_j;
      got[{Place{c.pair.i.value, 0, 0, 0}, Place{c.pair.j.value, n.a, n.b, n.c}}] = c.gap;
      if (n != Image{}) t.add("through faces");
      if (norm(c.points.offset_i) > 0.01) t.add("between particles");
      // the points are as far apart as the gap says
      const Vec3d apart = body.at({c.pair.j.value, n.a, n.b, n.c}) + c.points.offset_j -
                          body.at({c.pair.i.value, 0, 0, 0}) - c.points.offset_i;
      EXPECT_NEAR(norm(apart) - c.points.R_i - c.points.R_j, c.gap, 1e-12) << seed;
    }
    // of segments as near at a particle either may be taken, but the pair of particles is the same
    EXPECT_EQ(got.size(), wanted.size()) << seed;
    for (const auto& [pair, least] : wanted) {
      const auto at = got.find(pair);
      if (at == got.end())
        ADD_FAILURE() << seed << ": missed " << std::get<0>(std::get<0>(pair)) << ", "
                      << std::get<0>(std::get<1>(pair)) << " at " << least;
      else
        EXPECT_NEAR(at->second, least, close) << seed;
    }
  });
  if (!tally.full) return;
  EXPECT_GT(tally.sum("crossings"), 100.0);
  EXPECT_GT(tally.sum("through faces"), 10.0);
  EXPECT_GT(tally.sum("between particles"), 60.0);
}

/// Straight fibres of particles with bonds as thick as they are.
Built straight(const std::vector<std::pair<Vec3d, Vec3d>>& ends, std::size_t particles, double R) {
  Built b;
  std::vector<Vec3d> r;
  for (const auto& [from, to] : ends)
    for (std::size_t k = 0; k < particles; ++k)
      r.push_back(from + (double(k) / double(particles - 1)) * (to - from));
  b.state.r = PerParticle<Vec3d>(r);
  b.model.r_0 = b.state.r;
  b.model.radius = PerParticle<double>(r.size(), R);
  b.model.mass = b.model.inertia = PerParticle<double>(r.size(), 1.0);
  b.state.v = b.state.omega = PerParticle<Vec3d>(r.size());
  b.state.q = PerParticle<Quatd>(r.size());
  for (std::size_t k = 0; k + 1 < r.size(); ++k)
    if ((k + 1) % particles != 0) {
      Bond bond;
      bond.i = ParticleId{k}, bond.j = ParticleId{k + 1}, set_capsule(bond, R);
      b.state.bonds.push_back(bond);
    }
  return b;
}

// Short beside their radius, so that capsules three bonds apart in one fibre are within the gap.
TEST(Crossings, AreNotOfAStraightFibreWithItself) {
  const Built b = straight({{{0, 0, 0}, {9, 0, 0}}}, 30, 0.28);
  EXPECT_TRUE(crossings_within(b.model, b.state, b.state.bonds, 1.0).empty());
}

// Two fibres at an acute angle, that cross between particles: bonded there, they have no second crossing
// beside it, in whatever order and however often it is looked for.
TEST(Crossings, AreFoundOnceHoweverAcute) {
  for (const double angle : {1.5, 0.8, 0.4, 0.2, 0.1}) {
    Built b = straight({{{-2.13, 0, 0}, {1.87, 0, 0}},
                        {{-1.9 * std::cos(angle), -1.9 * std::sin(angle), 0.17},
                         {2.1 * std::cos(angle), 2.1 * std::sin(angle), 0.17}}},
                       11, 0.08);
    for (int stage = 0; stage < 3; ++stage) {
      const std::vector<Crossing> found = crossings_within(b.model, b.state, b.state.bonds, 0.1);
      ASSERT_EQ(found.size(), stage == 0 ? 1u : 0u) << angle << ", " << stage;
      if (stage > 0) continue;
      EXPECT_NEAR(found[0].gap, 0.01, 1e-12);
      const Vec3d at = b.state.r[found[0].pair.i] + found[0].points.offset_i;
      EXPECT_LT(norm(at), 1e-12);  // where they cross
      Bond glue;
      glue.i = found[0].pair.i, glue.j = found[0].pair.j;
      b.state.bonds.push_back(glue);
    }
  }
}

// ---- bonds there -----------------------------------------------------------------------------------

const std::string mat_keys =
    "fibres = 12\nlength = 1.6\ndiameter = 0.16\nspacing = 0.4\ndensity = 1\nbox = { min = [0, 0, 0], max = "
    "[2, 2, 0.8] }\n";
std::string glue(const std::string& keys) {
  return "capsule_radius = \"particles\"\n[[bonds]]\nname = \"glue\"\ncrossing_gap = 0.1\n" + keys +
         "stiffness = { c_A = 20, c_D = 5, c_B = 0.1, c_T = 0.1 }\n";
}
const std::string contact = "[contact]\nlaw = \"hertz\"\nE = 10\nnu = 0.3\n";

TEST(Crossings, AreBondedWithoutEnergyFromAxisToAxisOrBetweenSurfaces) {
  for (const bool surfaces : {false, true}) {
    const Built b =
        build(plain_fibres::fibres(mat_keys, contact, glue(surfaces ? "attach = \"surfaces\"\n" : "")));
    for (const Crossing& c :
         crossings_within(b.model, b.state, b.state.bonds, 0.1))  // what is bonded is found no more
      for (const Bond& bond : b.state.bonds)
        EXPECT_FALSE(in_order({bond.i, bond.j, image_of_j(bond)}) == c.pair) << c.pair.i.value;
    std::size_t glued = 0;
    for (const BondId k : b.state.bonds.ids()) {
      const Bond& bond = b.state.bonds[k];
      if (bond.set != 1) continue;
      ++glued;
      EXPECT_TRUE(bond.law->has_offsets);
      const BondPose<double> pose = bond_pose(bond, b.state);
      const BondEnergy<double> U = bond.law->energy(bond, pose, no_history);
      EXPECT_NEAR(U.U_L + U.U_B + U.U_T, 0.0, 1e-14);
      EXPECT_LT(norm(bond.law->loads(bond, pose, no_history).F), 1e-12);
      EXPECT_NEAR(norm(bonded_points(bond, pose)), bond.a, 1e-14);
      if (surfaces)
        EXPECT_LE(bond.a, 0.1 + 1e-12);
      else
        EXPECT_NEAR(std::clamp(bond.a, 0.16 - 1e-9, 0.26 + 1e-9), bond.a, 0.0);
    }
    EXPECT_GT(glued, 5u);
  }
}

TEST(Crossings, WhatTheyCannotHaveIsRefused) {
  const auto told = [](const std::string& keys, const std::string& before = contact) {
    try {
      build(plain_fibres::fibres(mat_keys, before, keys));
    } catch (const CaseError& e) {
      return to_text(e.problems());
    }
    return std::string("nothing");
  };
  std::string neck = glue("attach = \"neck\"\n");
  const std::string stiffness = "stiffness = { c_A = 20, c_D = 5, c_B = 0.1, c_T = 0.1 }";
  neck.replace(
      neck.find(stiffness), stiffness.size(),
      "theory = \"bernoulli-euler\"\nE = 1\nnu = 0.3\nsection = { shape = \"circle\", diameter = 0.1 }");
  EXPECT_NE(told(neck).find("crossings are of fibres"), std::string::npos);
  EXPECT_NE(told(glue("capsule_radius = 0.1\n")).find("no fibre itself"), std::string::npos);
  EXPECT_NE(told(glue("expansion = 1e-3\n")).find("do not expand"), std::string::npos);
  EXPECT_NE(told(glue("when = \"approach\"\n")).find("on approach"), std::string::npos);
  try {
    build(parse_case(
        "[[specimen]]\nkind = \"rod\"\nparticles = 3\nmass = 1\ninertia = 1\nradius = 0.4\n"
        "[[bonds]]\ndistance = 1.1\nlaw = \"v-model\"\nstiffness = { c_A = 1, c_D = 1, c_B = 1, "
        "c_T = 1 }\n[[bonds]]\ncrossing_gap = 0.1\nstiffness = { c_A = 1, c_D = 1, c_B = 1, c_T = 1 "
        "}\n[[stage]]\nduration = 1\n",
        "case.toml"));
    FAIL();
  } catch (const CaseError& e) {
    EXPECT_NE(to_text(e.problems()).find("there are no fibres"), std::string::npos) << e.what();
  }
  std::string none = glue("");
  none.replace(none.find("crossing_gap = 0.1"), 18, "crossing_gap = 0.0");
  EXPECT_NE(told(none).find("the nearest fibres have a gap of"), std::string::npos) << told(none);
  std::string far = glue("");
  far.replace(far.find("crossing_gap = 0.1"), 18, "crossing_gap = 1e6");
  EXPECT_NE(told(far).find("in the right unit?"), std::string::npos) << told(far);
}

}  // namespace
}  // namespace vbond::crossings_test
