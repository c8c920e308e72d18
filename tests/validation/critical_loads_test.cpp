// Critical loads of bodies that deform before they buckle, by both stages that find them: buckling, and the
// first special point of a path with steps of its own. Values known from elsewhere stand beside those cases.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "static_bodies.hpp"
#include "vbond/statics/detail/linear_buckling.hpp"
#include "vbond/statics/detail/newton.hpp"

namespace vbond {
namespace {

using testing::everybody;
using testing::fixed;
using testing::in_plane;
using testing::pushed;
using testing::Specimen;
using testing::static_stage;

constexpr HeldDofs hinge{true, true, false, false, false, false};
constexpr HeldDofs clamp_in_plane{true, true, false, false, false, true};

struct Case {
  Specimen specimen;
  StaticStage stage;
};

struct Found {
  PointKind kind = PointKind::end;
  double load_factor = 0;
};

StaticResult by_buckling(Case c, int count = 1) {
  c.stage.kind = StageKind::buckling;
  c.stage.count = count;
  return run_static_stage(c.specimen.model, c.stage, c.specimen.state, {}).result;
}

/// The first special point of a path with this first step; kind end if there is none up to load factor `to`.
Found by_path(Case c, double first_step, double to) {
  c.stage.kind = StageKind::path;
  c.stage.path.first_step = first_step;
  c.stage.path.above = to;
  bool found = false;
  StaticHooks hooks;
  hooks.point = [&found](const StaticPoint& p) {
    found |= p.kind == PointKind::limit_point || p.kind == PointKind::bifurcation;
  };
  hooks.interrupted = [&found] { return found; };
  const StaticResult r = run_static_stage(c.specimen.model, c.stage, c.specimen.state, hooks).result;
  if (r.special_points.empty()) return {};
  return {r.special_points[0].kind, r.special_points[0].load_factor};
}

/// Both stages find the same, to 1e-6 of the load; returns it.
double expect_both_find_one(const Case& c) {
  const StaticResult r = by_buckling(c);
  EXPECT_EQ(r.ended, "converged");
  if (r.critical_loads.size() != 1) return 0.0;
  const CriticalLoad& found = r.critical_loads[0];
  for (const double first_step : {0.03, 0.4}) {
    const Found p = by_path(c, first_step * found.load_factor, 1.5 * found.load_factor);
    EXPECT_EQ(p.kind, found.kind);
    EXPECT_NEAR(p.load_factor / found.load_factor, 1.0, 1e-6) << "first step " << first_step;
  }
  return found.load_factor;
}

/// A circular arch of 40 bonds about the y axis, R = EI = 1, in its plane; a unit force down at the crown.
Case arch(double degrees, double EA, const HeldDofs& feet) {
  constexpr std::size_t N = 40;
  const double half = degrees * M_PI / 360;
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= N; ++k) {
    const double angle = half * (2.0 * static_cast<double>(k) / N - 1);
    r.push_back({std::sin(angle), std::cos(angle), 0});
  }
  Specimen s = testing::chain_through(r, EA);
  return {s, static_stage(StageKind::buckling,
                          {fixed(everybody(s), in_plane), fixed({ParticleId{0}, ParticleId{N}}, feet)},
                          {pushed(N / 2, {0, -1, 0})})};
}

// A deep arch sways aside, and a clamped or a shallow and soft one turns back; the clamped arch of 60 degrees
// that is soft (rise^2 EA / EI = 18) does neither. EA R^2 / EI = 1e7: K is rounded to eps EA / a, some 2e-7
// of what its softest mode resists with at 270 degrees, where that is least.
TEST(Arches, BuckleAtOneLoadByBothStages) {
  const std::map<std::pair<int, double>, double> known = {{{120, 1e6}, 11.5}, {{215, 1e6}, 3.299}};
  for (const double degrees : {60.0, 90.0, 120.0, 150.0, 180.0, 215.0, 240.0, 270.0})
    for (const double EA : {1e3, 1e4, 1e5, 1e6, 1e7})
      for (const bool hinged : {true, false}) {
        SCOPED_TRACE(::testing::Message()
                     << degrees << " degrees, EA " << EA << (hinged ? ", hinged" : ", clamped"));
        const Case c = arch(degrees, EA, hinged ? hinge : clamp_in_plane);
        if (degrees == 60.0 && EA == 1e3 && !hinged) {
          const StaticResult r = by_buckling(c);
          EXPECT_TRUE(r.critical_loads.empty());
          EXPECT_EQ(r.ended, "bond range");
          EXPECT_GT(r.searched_to, 100.0);
          EXPECT_EQ(by_path(c, 1.0, 100.0).kind, PointKind::end);
          continue;
        }
        const double f = expect_both_find_one(c);
        const auto at = known.find({static_cast<int>(degrees), EA});
        if (hinged && at != known.end()) {
          EXPECT_NEAR(f / at->second, 1.0, 3e-3);
        }
      }
}

// After the bifurcation comes a limit point: both are listed, and the search says that it ends there.
TEST(Arches, KeepTheirBifurcationWhereALimitPointEndsTheSearch) {
  const StaticResult r = by_buckling(arch(60, 1e4, hinge), 6);
  EXPECT_EQ(r.ended, "limit point");
  ASSERT_GE(r.critical_loads.size(), 2u);
  EXPECT_EQ(r.critical_loads.front().kind, PointKind::bifurcation);
  EXPECT_NEAR(r.critical_loads.front().load_factor, 22.0191781, 1e-6);
  EXPECT_EQ(r.critical_loads.back().kind, PointKind::limit_point);
  EXPECT_EQ(r.searched_to, r.critical_loads.back().load_factor);
}

// The rate of the tangent holds the rotations before buckling times the longitudinal stiffness: of an arch
// that bends, the linear estimate falls with the slenderness and has nothing to do with its critical
// load, 11.5 EI / R^2.
TEST(LinearEstimates, FallWithSlenderness) {
  const std::pair<double, double> cases[] = {{1e3, 6.53}, {1e4, 2.58}, {5e4, 1.22}};
  for (const auto& [EA, estimate] : cases) {
    const Case c = arch(120, EA, hinge);
    StaticBody body(c.specimen.model, c.stage, c.specimen.state);
    TangentSolver solver(LinearSolver::direct);
    ASSERT_EQ(solver.factor(body), 0);
    const std::vector<double> mu =
        linear_critical_factors(body, solver, solver.solve(body.load_direction()), 1);
    ASSERT_EQ(mu.size(), 1u);
    EXPECT_NEAR(mu[0] / estimate, 1.0, 5e-3);
    EXPECT_FALSE(by_buckling(c).critical_loads.at(0).estimate);
  }
}

/// A triangular sheet of `rows` rows of `bonds` bonds, clamped at its root, pushed sideways within its plane
/// at the tip of its middle row.
Case ribbon(std::size_t rows, std::size_t bonds) {
  std::vector<Vec3d> r;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t k = 0; k <= bonds; ++k)
      r.push_back({static_cast<double>(k) + 0.5 * static_cast<double>(row % 2),
                   0.5 * std::sqrt(3.0) * static_cast<double>(row), 0});
  Specimen s = testing::particles_at(r, 0.4);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.02, 0.015};
  recipe.n_2 = Vec3d{0, 0, 1};
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < std::min(r.size(), i + bonds + 3); ++j)
      if (norm(r[j] - r[i]) < 1.1) testing::bond(s, i, j, recipe);
  std::vector<ParticleId> root;
  for (std::size_t row = 0; row < rows; ++row) root.emplace_back(row * (bonds + 1));
  return {s, static_stage(StageKind::buckling, {fixed(root, testing::clamped)},
                          {pushed(rows / 2 * (bonds + 1) + bonds, {0, 1, 0})})};
}

TEST(Ribbons, BuckleSidewaysAtOneLoadByBothStages) {
  const std::map<std::pair<std::size_t, std::size_t>, double> known = {{{3, 60}, 1.1311e-4}};
  for (const auto& [rows, bonds] :
       {std::pair{3u, 30u}, {3u, 40u}, {3u, 50u}, {3u, 60u}, {3u, 70u}, {3u, 80u}, {5u, 60u}, {5u, 100u}}) {
    SCOPED_TRACE(::testing::Message() << rows << " x " << bonds);
    const double f = expect_both_find_one(ribbon(rows, bonds));
    if (const auto at = known.find({rows, bonds}); at != known.end()) {
      EXPECT_NEAR(f / at->second, 1.0, 1e-4);
    }
  }
}

/// Six rows of six cells of steel 1 mm thick, sides of 10 mm made of four bonds; lengths in m.
struct Honeycomb {
  Specimen specimen;
  std::vector<ParticleId> bottom, top;
};

Honeycomb honeycomb() {
  constexpr int cells = 6, bonds = 4;
  constexpr double side = 0.01, thick = 1e-3;
  std::vector<Vec3d> r;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const auto number = [&r](const Vec3d& x) {  // coordinates as in a table of nine digits: not quite symmetric
    const auto rounded = [](double v) { return std::round(v * 1e11) / 1e11; };
    const Vec3d p{rounded(x.x), rounded(x.y), 0};
    for (std::size_t k = 0; k < r.size(); ++k)
      if (norm(r[k] - p) < 1e-6) return k;
    r.push_back(p);
    return r.size() - 1;
  };
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      const Vec3d centre{(2 * column + row % 2) * 0.5 * std::sqrt(3.0) * side, 1.5 * side * row, 0};
      for (int k = 0; k < 6; ++k) {
        const auto corner = [&](int n) {
          const double angle = M_PI / 2 + n * M_PI / 3;
          return centre + side * Vec3d{std::cos(angle), std::sin(angle), 0};
        };
        for (int m = 0; m < bonds; ++m) {
          const auto along = [&](int n) {
            return corner(k) + (static_cast<double>(n) / bonds) * (corner(k + 1) - corner(k));
          };
          const std::size_t i = number(along(m)), j = number(along(m + 1));
          pairs.emplace_back(std::min(i, j), std::max(i, j));
        }
      }
    }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  Honeycomb h{testing::particles_at(r, 0.5 * thick), {}, {}};
  BondRecipe recipe;
  const double J = std::pow(thick, 4) / 12, J_p = 0.1406 * std::pow(thick, 4);
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {70e9, 0.33}, {thick * thick, J, J_p}, 0};
  recipe.n_2 = Vec3d{0, 0, 1};
  for (const auto& [i, j] : pairs) testing::bond(h.specimen, i, j, recipe);
  for (std::size_t k = 0; k < r.size(); ++k) {
    if (r[k].y < -0.0099) h.bottom.emplace_back(k);
    if (r[k].y > 0.0849) h.top.emplace_back(k);
  }
  return h;
}

/// Pressed by way: its cells lean to one side.
Case pressed_honeycomb(double way) {
  const Honeycomb h = honeycomb();
  return {h.specimen, static_stage(StageKind::buckling,
                                   {fixed(everybody(h.specimen), in_plane), fixed(h.bottom, clamp_in_plane),
                                    fixed(h.top, clamp_in_plane, {0, -way, 0})})};
}

// Its paths pass each other where they would cross, at a distance of some 1e-6 of the load: it is not quite
// symmetric.
TEST(Honeycomb, BifurcatesAtOneWayByBothStagesHoweverItIsStepped) {
  const Case c = pressed_honeycomb(0.04);
  ASSERT_EQ(c.specimen.model.particles(), 489u);
  const StaticResult r = by_buckling(c);
  ASSERT_EQ(r.critical_loads.size(), 1u);
  EXPECT_EQ(r.critical_loads[0].kind, PointKind::bifurcation);
  const double f = r.critical_loads[0].load_factor;
  EXPECT_NEAR(0.04 * f, 0.0124, 1e-4);
  for (const double first_step : {0.02, 0.05, 0.2}) {
    const Found p = by_path(c, first_step, 0.5);
    EXPECT_EQ(p.kind, PointKind::bifurcation);
    EXPECT_NEAR(p.load_factor / f, 1.0, 1e-5) << "first step " << first_step;
  }
  Case short_steps = c;
  short_steps.stage.path.largest_step = 1e-3;
  EXPECT_NEAR(by_path(short_steps, 0.02, 0.5).load_factor / f, 1.0, 1e-5);
}

TEST(Honeycomb, HasItsLimitLoadByBothStages) {
  const Honeycomb h = honeycomb();
  const Case c{h.specimen,
               static_stage(StageKind::buckling,
                            {fixed(everybody(h.specimen), in_plane), fixed(h.bottom, clamp_in_plane),
                             fixed(h.top, {true, false, false, false, false, true})},
                            {{"top", h.top, {0, -1, 0}}})};
  EXPECT_NEAR(expect_both_find_one(c), 522.8, 0.1);
}

/// A rod of 64 bonds closed to a ring, then twisted at its joint while the particle across is held in the
/// plane.
Case twisted_ring() {
  constexpr std::size_t N = 64;
  Specimen s = testing::particles_at([] {
    std::vector<Vec3d> r;
    for (std::size_t k = 0; k <= N; ++k) r.push_back({static_cast<double>(k), 0, 0});
    return r;
  }());
  BondRecipe recipe;
  recipe.parameters = GivenCoefficients{{9.765625, -2.0, 6.0, 5.0 / 6}};
  recipe.n_2 = Vec3d{0, 1, 0};
  for (std::size_t k = 0; k < N; ++k) testing::bond(s, k, k + 1, recipe);
  // a polygon whose bonds all turn by 2 pi / N: balanced and at rest but for its bending
  const double turn = 2 * M_PI / N;
  Vec3d at = s.state.r[ParticleId{0}];
  for (std::size_t k = 0; k <= N; ++k) {
    s.state.r[ParticleId{k}] = at;
    s.state.q[ParticleId{k}] = rotation_of({0, 0, turn * static_cast<double>(k)});
    const double line = turn * (static_cast<double>(k) + 0.5);
    at = at + Vec3d{std::cos(line), std::sin(line), 0};
  }
  return {s, static_stage(StageKind::buckling,
                          {fixed({ParticleId{0}}, testing::clamped),
                           fixed({ParticleId{N}}, testing::clamped, {}, {1, 0, 0}),
                           fixed({ParticleId{N / 2}}, {false, false, true, false, false, false})})};
}

TEST(TwistedRing, TurnsBackAtOneTwistByBothStages) {
  const double f = expect_both_find_one(twisted_ring());
  EXPECT_NEAR(f, 13.7225909, 1e-6);
}

}  // namespace
}  // namespace vbond
