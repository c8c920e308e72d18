// Small bonded bodies pressed by random walls, against a minimisation that shares nothing with statics but
// the energy of a bond: its own distances from walls, its own repulsion, its own slopes by differences.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "bodies.hpp"
#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::wall_campaign_test {
namespace {

using testing::Specimen;

/// A body, walls around it and what moves them.
struct Pressed {
  Specimen s;
  StaticStage stage;
};

/// Four to six particles in a heap, the first clamped; one to three planes, spheres or cylinders, each of
/// which begins just off a particle and moves into it.
Pressed random_case(unsigned seed) {
  testing::Dice dice(seed);
  Pressed c;
  const std::size_t n = dice.count(4, 6);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)
    r.push_back({k % 2 ? 1.0 : 0.0, k / 2 % 2 ? 1.0 : 0.0, k / 4 ? 1.0 : 0.0});
  for (Vec3d& x : r) x += dice.vector(0.1);
  c.s = testing::particles_at(r, 0.4);
  BondRecipe recipe = testing::papers_bond();
  recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.2, 0.1};
  testing::bond_near(c.s, 1.3, recipe);
  const bool linear = dice.chance(0.5);
  c.s.model.contact = {.law = linear ? ContactLaw::linear : ContactLaw::hertz,
                       .pairs = ContactPairs::none,
                       .E = dice(0.5, 5.0),
                       .nu = 0.25};
  c.s.model.contact.k = dice(0.2, 5.0);
  c.stage =
      testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)});
  c.stage.newton.tolerance = 1e-12;
  c.stage.steps = 3;
  const int walls = dice.whole(1, 3);
  for (int w = 0; w < walls; ++w) {
    const Vec3d to = dice.direction();
    std::size_t first = 1;  // that the wall comes to
    for (std::size_t k = 1; k < n; ++k)
      if (dot(r[k], to) < dot(r[first], to)) first = k;
    if (dot(r[0], to) < dot(r[first], to) + 0.3) continue;  // it would meet the clamp
    const double gap = dice(-0.02, 0.05);
    const Vec3d at = r[first] - (0.4 + gap) * to;
    Wall wall{"w" + std::to_string(w), PlaneWall{at, to}, 0, at};
    const double kind = dice(0, 3), R_w = dice(0.5, 3.0);
    if (kind > 2) wall.shape = SphereWall{at - R_w * to, R_w, WallSide::outside};
    if (kind > 1 && kind < 2)
      wall.shape = CylinderWall{at - R_w * to, normalised(cross(to, dice.direction())), R_w,
                                std::numeric_limits<double>::infinity(), WallSide::outside};
    c.stage.walls.push_back(
        {wall.name, c.s.model.walls.size(), dice(0.1, 0.3) * to + dice.vector(0.03), dice.vector(0.1), at});
    c.s.model.walls.push_back(std::move(wall));
  }
  return c;
}

/// Distance of a point from a wall that has been carried along to load factor 1, and the least radius R*.
std::pair<double, double> distance_from(const Wall& wall, const WallDrive& d, double R, const Vec3d& x) {
  const Vec3d pivot = *d.pivot;
  const auto carried = [&](const Vec3d& p) {
    return pivot + d.velocity + rotate(rotation_of(d.angular_velocity), p - pivot);
  };
  const auto turned = [&](const Vec3d& e) { return rotate(rotation_of(d.angular_velocity), e); };
  if (const auto* plane = std::get_if<PlaneWall>(&wall.shape))
    return {dot(x - carried(plane->point), turned(plane->normal)), R};
  if (const auto* sphere = std::get_if<SphereWall>(&wall.shape))
    return {norm(x - carried(sphere->centre)) - sphere->radius, R * sphere->radius / (R + sphere->radius)};
  const auto& cylinder = std::get<CylinderWall>(wall.shape);
  return {norm(cross(x - carried(cylinder.centre), turned(cylinder.axis))) - cylinder.radius,
          R * std::sqrt(cylinder.radius / (R + cylinder.radius))};
}

double energy_of(const Pressed& c, const State& s) {
  const Energies e = bond_energies(s);
  double U = e.U_L + e.U_B + e.U_T;
  const ContactModel& law = c.s.model.contact;
  for (const WallDrive& d : c.stage.walls)
    for (const ParticleId p : s.r.ids()) {
      const auto [distance, R] = distance_from(c.s.model.walls[d.index], d, 0.4, s.r[p]);
      const double overlap = 0.4 - distance;
      if (overlap <= 0) continue;
      U += law.law == ContactLaw::linear
               ? 0.5 * law.k * overlap * overlap
               : 8.0 / 15.0 * law.E / (2 * (1 - 0.0625)) * std::sqrt(R) * std::pow(overlap, 2.5);
    }
  return U;
}

/// The state with free particles moved and turned by these.
State moved(const State& from, const Vector& x) {
  State s = from;
  for (std::size_t k = 1; k < s.r.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(6 * (k - 1));
    s.r[ParticleId{k}] += {x[at], x[at + 1], x[at + 2]};
    s.q[ParticleId{k}] = normalised(rotation_of({x[at + 3], x[at + 4], x[at + 5]}) * s.q[ParticleId{k}]);
  }
  return s;
}

Vector slope_of(const Pressed& c, const State& s) {
  const auto n = static_cast<Eigen::Index>(6 * (s.r.size() - 1));
  constexpr double h = 1e-5;  // truncation h^2, rounding 1e-16/h: 1e-10 both
  Vector g(n);
  for (Eigen::Index k = 0; k < n; ++k)
    g[k] =
        (energy_of(c, moved(s, h * Vector::Unit(n, k))) - energy_of(c, moved(s, -h * Vector::Unit(n, k)))) /
        (2 * h);
  return g;
}

/// Quasi-Newton (Broyden, Fletcher, Goldfarb, Shanno) with halved steps; nothing if it does not come to rest.
std::optional<State> least_energy(const Pressed& c, State s) {
  const auto n = static_cast<Eigen::Index>(6 * (s.r.size() - 1));
  DenseMatrix H = DenseMatrix::Identity(n, n);
  Vector g = slope_of(c, s);
  double U = energy_of(c, s);
  for (int k = 0; k < 600; ++k) {
    if (g.cwiseAbs().maxCoeff() < 3e-9) return s;
    Vector x = -H * g;
    if (x.dot(g) >= 0) H.setIdentity(), x = -g;
    x *= std::min(1.0, 0.2 / x.cwiseAbs().maxCoeff());
    double length = 1.0;
    State next = moved(s, x);
    double U_next = energy_of(c, next);
    while (!(U_next <= U + 1e-4 * length * x.dot(g)) && length > 1e-10) {
      length *= 0.5;
      next = moved(s, length * x);
      U_next = energy_of(c, next);
    }
    if (length <= 1e-10) return g.cwiseAbs().maxCoeff() < 1e-7 ? std::optional(s) : std::nullopt;
    const Vector g_next = slope_of(c, next), y = g_next - g, d = length * x;
    if (const double dy = d.dot(y); dy > 1e-14) {
      const Vector Hy = H * y;
      H += (1 + y.dot(Hy) / dy) / dy * d * d.transpose() - (Hy * d.transpose() + d * Hy.transpose()) / dy;
    }
    s = std::move(next), g = g_next, U = U_next;
  }
  return std::nullopt;
}

using testing::distance_between;

// Statics follows the walls, the reference begins with them in place: the two may end in different valleys.
// Then the reference, let go where statics ended, must stay there.
TEST(WallsAtRestCampaign, FindsTheLeastEnergyOfRandomBodies) {
  const testing::Tally all =
      testing::campaign("walls at rest", 150, [](unsigned seed, testing::Tally& tally) -> testing::Verdict {
        const Pressed c = random_case(seed);
        double U = 0, work = 0, at_start = 0;
        StaticHooks hooks;
        hooks.point = [&](const StaticPoint& p) {
          if (p.load_factor == 0.0) at_start = p.energies.potential();
          U = p.energies.potential(), work = 0;
          for (const WallState& w : p.state.walls) work += w.work;
        };
        const StaticOutcome out = run_static_stage(c.s.model, c.stage, c.s.state, hooks);
        if (U < 1e-9) tally.add("untouched");
        // walls that begin a little inside push with a relief, which works as well
        if (std::abs(at_start) < 1e-12 && U > 1e-6 && !out.result.jumped) {
          const double open = std::abs(work - U) / U;
          tally.add("open books", open > 1e-9), tally.below("books", open, 1e-5);
        }
        const std::optional<State> reference = least_energy(c, c.s.state);
        if (reference && distance_between(out.state, *reference) < 1e-6) return {};
        const std::optional<State> stays = least_energy(c, out.state);
        if (!stays) return {"not judged"};
        const double off = distance_between(out.state, *stays);
        return off < 1e-6 ? testing::Verdict{"in another valley"}
                          : testing::wrong("off by " + std::to_string(off));
      });
  EXPECT_EQ(all["given up"], 0u);
  EXPECT_LE(all["not judged"], all.full ? all.cases / 75 : all.cases);
  // a hundred balances in between are the most: one of 150 has a step with too many kinks for them
  EXPECT_LE(all.sum("open books"), all.full ? all.cases / 150 : all.cases);
  if (!all.full) return;
  EXPECT_GE(15 * all["right"], 13 * all.cases);
  EXPECT_LT(5 * all.sum("untouched"), all.cases);
}

}  // namespace
}  // namespace vbond::wall_campaign_test
