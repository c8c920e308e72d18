// Pressure on the skin of solids: Lame's tube, and bodies that are pressed alike from all sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "bodies.hpp"
#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/packing/skin.hpp"
#include "vbond/terms/pressure/pressed.hpp"

namespace vbond::pressed_solids {
namespace {

using testing::Dice;
using testing::Specimen;

std::vector<Facet> skin_of(const Specimen& s, double radius) {
  std::vector<Facet> facets;
  const packing::Skin skin = packing::skin_of(s.state.r.values(), radius).value();
  for (const auto& [i, j, k] : skin.triangles)
    facets.push_back({ParticleId{i}, ParticleId{j}, ParticleId{k}});
  return facets;
}

Vec3d middle_of(const Facet& f, const State& s) {
  return (s.r[f.i] + s.r[f.j] + s.r[f.k]) / 3.0;
}
double from_axis(const Vec3d& r) {
  return std::hypot(r.x, r.y);
}

// ---- a thick tube ---------------------------------------------------------------------------------------

/// A tube cut from a lattice of neighbours at a distance of 1 that all have the same stiffness along and
/// across the bond: isotropic, E = 2 sqrt(2) k/L and nu = 0, as the tensor sum of n n (x) 1 has no direction.
/// A slice of the height of a cubic cell between two planes, in each of which bonds count by half.
constexpr double height = M_SQRT2, E = 2.0 * M_SQRT2;

Specimen tube(double inner, double outer) {
  const double half = 0.5 * M_SQRT2;
  const int n = static_cast<int>(std::ceil(outer / half));
  std::vector<Vec3d> r;
  for (int z = 0; z <= 2; ++z)
    for (int y = -n; y <= n; ++y)
      for (int x = -n; x <= n; ++x)
        if (const Vec3d p{half * x, half * y, half * z};
            (x + y + z) % 2 == 0 && from_axis(p) >= inner && from_axis(p) <= outer)
          r.push_back(p);
  Specimen s = testing::particles_at(r);
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j) {
      if (std::abs(r[j].y - r[i].y) > 1.1 || norm2(r[j] - r[i]) > 1.2) continue;
      const bool on_a_plane = r[i].z == r[j].z && r[i].z != half;
      BondRecipe recipe;
      const double k = on_a_plane ? 0.5 : 1.0;
      recipe.parameters = BondStiffness<double>{k, k, 0.25 * k, 0.25 * k};
      testing::bond(s, i, j, recipe);
    }
  return s;
}

struct Wall {
  std::vector<Facet> facets;
  double radius = 0;  ///< of a circle that holds as much
};

/// What of the skin faces the axis, or away from it, without the two planes.
Wall wall_of(const Specimen& s, double between, bool inner) {
  Wall wall;
  double twice_volume = 0.0;
  for (const Facet& f : skin_of(s, 1.1)) {
    const bool on_a_plane = s.state.r[f.i].z == s.state.r[f.j].z && s.state.r[f.i].z == s.state.r[f.k].z;
    const Vec3d middle = middle_of(f, s.state);
    if (on_a_plane || (from_axis(middle) < between) != inner) continue;
    const Vec3d area = area_of(f, {}, [&s](ParticleId p) { return s.state.r[p]; });
    twice_volume += middle.x * area.x + middle.y * area.y;
    wall.facets.push_back(f);
  }
  wall.radius = std::sqrt(std::abs(twice_volume) / (2.0 * M_PI * height));
  return wall;
}

// The surface of a cut lattice is rough by some 0.3 of the distance of particles: radii are those that
// enclose as much as the skin does.
TEST(PressedTube, FollowsLame) {
  const Specimen s = tube(18.7, 36.2);
  const Wall inner = wall_of(s, 27.0, true), outer = wall_of(s, 27.0, false);
  const double a = inner.radius, b = outer.radius;
  EXPECT_NEAR(a, 18.7, 0.5);
  EXPECT_NEAR(b, 36.2, 0.5);
  std::vector<ParticleId> all;
  for (const ParticleId p : s.state.r.ids()) all.push_back(p);
  const auto on = [&](double x, double y) {
    return *std::min_element(all.begin(), all.end(), [&](ParticleId p, ParticleId q) {
      const Vec3d at{x, y, 0.5 * height};
      return norm2(s.state.r[p] - at) < norm2(s.state.r[q] - at);
    });
  };
  for (const bool from_inside : {true, false}) {
    StaticStage stage = testing::static_stage(
        StageKind::equilibrium,
        {testing::fixed(all, {false, false, true, true, true, false}),
         testing::fixed({on(27, 0), on(-27, 0)}, {false, true}), testing::fixed({on(0, 27)}, {true})});
    const double p = 1e-5 * E;
    Pressure pressure;
    pressure.group = "wall", pressure.facets = from_inside ? inner.facets : outer.facets;
    pressure.pressure = p;
    stage.pressures = {pressure};
    const StaticOutcome found = run_static_stage(s.model, stage, s.state, {});
    double largest = 0.0;
    int counted = 0;
    for (const ParticleId q : all) {
      const Vec3d at = s.state.r[q];
      const double r = from_axis(at);
      if (r < 1.15 * a || r > 0.92 * b) continue;
      const double lame = from_inside ? p * a * a / (E * (b * b - a * a)) * (r + b * b / r)
                                      : -p * b * b / (E * (b * b - a * a)) * (r + a * a / r);
      const Vec3d went = found.state.r[q] - at;
      largest = std::max(largest, std::abs((went.x * at.x + went.y * at.y) / r / lame - 1.0));
      ++counted;
    }
    std::printf("tube of radii %.4f, %.4f under pressure from %s: %d particles, off by %.4f at most\n", a, b,
                from_inside ? "inside" : "outside", counted, largest);
    EXPECT_GT(counted, 1000);
    EXPECT_LT(largest, 0.02);
  }
}

// ---- all round ------------------------------------------------------------------------------------------

/// The sum of x (x) f over bonds, x from the centre to where f acts on a particle: the forces of pairs alone,
/// whose torques are in balance.
Tensor virial(const State& now) {
  Tensor sum;
  for (const BondId k : now.bonds.ids()) {
    const Bond& b = now.bonds[k];
    sum += dyad(between(now, b), bond_loads(now, k).F);
  }
  return sum;
}

// A body in balance under pressure on its closed skin: the sum of r (x) F over the corners is -p V 1,
// whatever its shape and its bonds. The stress between the centres is that over V. Tension is positive: F
// acts on i.
TEST(PressedBody, HasTheStressOfAFluid) {
  testing::campaign("pressed bodies", 25, [](unsigned seed, testing::Tally& tally) {
    Dice dice(seed);
    std::vector<Vec3d> r;
    for (int tries = 0; tries < 3000; ++tries) {
      const Vec3d x = dice.vector(1.8), at{x.x, 0.8 * x.y, 1.2 * x.z};
      if (std::all_of(r.begin(), r.end(), [&](const Vec3d& y) { return norm2(y - at) >= 0.7; }))
        r.push_back(at);
    }
    Specimen s = testing::particles_at(r);
    BondRecipe recipe;
    recipe.parameters =
        BondStiffness<double>{dice(0.3, 1), dice(0.05, 0.2), dice(0.02, 0.1), dice(0.02, 0.1)};
    testing::bond_near(s, 1.5, recipe);
    Pressure p;
    p.group = "body", p.facets = skin_of(s, 1.2), p.pressure = dice(-0.01, 0.02);
    ASSERT_TRUE(is_closed(p.facets));
    // its three turns are held by two particles across the lines to a third, which shrink with the body
    const Vec3d e = normalised(s.state.r[ParticleId{1}] - s.state.r[ParticleId{0}]),
                n = normalised(cross(e, s.state.r[ParticleId{2}] - s.state.r[ParticleId{0}]));
    HeldAxes axes;
    axes.along = axes.about = {e, cross(n, e), n};
    std::vector<Support> supports{testing::fixed({ParticleId{0}}, testing::translations),
                                  testing::fixed({ParticleId{1}}, {false, true, true}),
                                  testing::fixed({ParticleId{2}}, {false, false, true})};
    supports[1].axes = supports[2].axes = axes;
    StaticStage stage = testing::static_stage(StageKind::equilibrium, supports);
    stage.pressures = {p};
    stage.newton.tolerance = 1e-12;
    const StaticOutcome found = run_static_stage(s.model, stage, s.state, {});
    const SurfaceSize size = size_of(p.facets, {}, found.state.r);
    const Tensor sum = virial(found.state);
    double off = 0.0;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        off = std::max(off, std::abs(component(sum.row[static_cast<std::size_t>(a)], b) / size.volume +
                                     (a == b ? p.pressure : 0.0)));
    tally.below("error of the stress, in parts of the pressure", off / std::abs(p.pressure), 1e-8);
    tally.add("triangles", static_cast<double>(p.facets.size()));
  });
}

}  // namespace
}  // namespace vbond::pressed_solids
