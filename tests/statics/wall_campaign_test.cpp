// Small bonded bodies pressed by random walls, against a minimisation that shares nothing with statics but
// the energy of a bond: its own distances from walls, its own repulsion, its own slopes by differences.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "bodies.hpp"
#include "vbond/core/error.hpp"
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
  const auto any = [&dice](double size) {
    return Vec3d{dice(-size, size), dice(-size, size), dice(-size, size)};
  };
  const auto direction = [&] {
    Vec3d e = any(1.0);
    while (norm(e) < 0.2) e = any(1.0);
    return normalised(e);
  };
  Pressed c;
  const auto n = static_cast<std::size_t>(dice(4, 6.999));
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)
    r.push_back({k % 2 ? 1.0 : 0.0, k / 2 % 2 ? 1.0 : 0.0, k / 4 ? 1.0 : 0.0});
  for (Vec3d& x : r) x += any(0.1);
  c.s = testing::particles_at(r, 0.4);
  BondRecipe recipe = testing::papers_bond();
  recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.2, 0.1};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (norm(r[j] - r[i]) < 1.3) testing::bond(c.s, i, j, recipe);
  const bool linear = dice(0, 1) < 0.5;
  c.s.model.contact = {.law = linear ? ContactLaw::linear : ContactLaw::hertz,
                       .pairs = ContactPairs::none,
                       .E = dice(0.5, 5.0),
                       .nu = 0.25};
  c.s.model.contact.k = dice(0.2, 5.0);
  c.stage =
      testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)});
  c.stage.newton.tolerance = 1e-12;
  c.stage.steps = 3;
  const int walls = static_cast<int>(dice(1, 3.999));
  for (int w = 0; w < walls; ++w) {
    const Vec3d to = direction();
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
      wall.shape = CylinderWall{at - R_w * to, normalised(cross(to, direction())), R_w,
                                std::numeric_limits<double>::infinity(), WallSide::outside};
    c.stage.walls.push_back(
        {wall.name, c.s.model.walls.size(), dice(0.1, 0.3) * to + any(0.03), any(0.1), at});
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

double distance_between(const State& a, const State& b) {
  double largest = 0;
  for (const ParticleId p : a.r.ids())
    largest = std::max({largest, norm(a.r[p] - b.r[p]), norm(rotation_vector(a.q[p] * conjugate(b.q[p])))});
  return largest;
}

// Statics follows the walls, the reference begins with them in place: the two may end in different valleys.
// Then the reference, let go where statics ended, must stay there.
TEST(WallsAtRestCampaign, FindsTheLeastEnergyOfRandomBodies) {
  int open_books = 0, right = 0, other_valley = 0, wrong = 0, given_up = 0, not_judged = 0, untouched = 0;
  double worst_books = 0;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    const Pressed c = random_case(seed);
    std::optional<State> found;
    double U = 0, work = 0, at_start = 0;
    StaticHooks hooks;
    hooks.point = [&](const StaticPoint& p) {
      if (p.load_factor == 0.0) at_start = p.energies.potential();
      U = p.energies.potential(), work = 0;
      for (const WallState& w : p.state.walls) work += w.work;
    };
    try {
      const StaticOutcome out = run_static_stage(c.s.model, c.stage, c.s.state, hooks);
      found = out.state;
      if (U < 1e-9) ++untouched;
      // walls that begin a little inside push with a relief, which works as well
      if (std::abs(at_start) < 1e-12 && U > 1e-6 && !out.result.jumped) {
        const double open = std::abs(work - U) / U;
        open_books += open > 1e-9;
        worst_books = std::max(worst_books, open);
      }
    } catch (const NoEquilibrium& e) {
      ++given_up;
      std::printf("seed %u: %s\n", seed, e.what());
      continue;
    }
    const std::optional<State> reference = least_energy(c, c.s.state);
    if (reference && distance_between(*found, *reference) < 1e-6) {
      ++right;
      continue;
    }
    const std::optional<State> stays = least_energy(c, *found);
    if (!stays)
      ++not_judged;
    else if (distance_between(*found, *stays) < 1e-6)
      ++other_valley;
    else
      ++wrong, std::printf("seed %u: wrong by %.2g\n", seed, distance_between(*found, *stays));
  }
  std::printf(
      "right %d, in another valley %d, wrong %d, given up %d, not judged %d; untouched %d; books %.1e\n",
      right, other_valley, wrong, given_up, not_judged, untouched, worst_books);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(given_up, 0);
  EXPECT_LE(not_judged, 2);
  EXPECT_GE(right, 130);
  EXPECT_LT(untouched, 30);
  // a hundred balances in between are the most: seed 99 has a step with too many kinks for them
  EXPECT_LE(open_books, 1);
  EXPECT_LT(worst_books, 1e-5);
}

}  // namespace
}  // namespace vbond::wall_campaign_test
