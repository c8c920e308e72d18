// Random encounters of two spheres, or of a sphere with a plane, a ridge of two triangles, a sphere or a
// cylinder from inside or outside, or a bond that touches as a capsule, with and without adhesion, against an
// integrator of its own: other formulas of geometry, other code, a much smaller step.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "campaigns/judge.hpp"
#include "rods.hpp"

namespace vbond::encounter_campaign_test {
namespace {

using testing::Dice;
using testing::Specimen;
using testing::Verdict;

constexpr double slope = 0.36397023426620234;  // tan 20 degrees

enum class Partner { particle, plane, ridge, hollow_sphere, ball, trough, fibre };

struct Body {
  Vec3d r, v, w;
  double m = 1, I = 1, R = 1;
};

/// What one encounter is made of.
struct Encounter {
  Partner partner;
  Body i, j;  // j: the particle, or a wall, which nothing moves
  double E = 100, nu = 0.3, mu = 0, e = 1, mu_r = 0, k_r = 0;
  bool attraction = false;
  AdhesionForm adhesion = AdhesionForm::none;
  double work = 0;  // of adhesion
  double wall_radius = 1;
  double dt = 1e-3;
};

/// The nearest point of the partner: its direction from i, distance from the centre of i, and the sum of
/// principal curvatures as 1/R*.
struct Near {
  Vec3d n;
  double distance;
  double per_R;  // of the equivalent sphere
};
Near near_of(const Encounter& c, const Body& i, const Body& j) {
  const double x = i.r.x, z = i.r.z;
  switch (c.partner) {
    case Partner::particle: {
      const Vec3d d = j.r - i.r;
      const double l = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
      return {(1.0 / l) * d, l - j.R, 1.0 / i.R + 1.0 / j.R};
    }
    case Partner::plane: return {{0, 0, -1}, z, 1.0 / i.R};
    case Partner::ridge: {  // z = -|x| tan 20: the edge is nearest within the cone of its two normals
      if (z > 0.0 && std::abs(x) <= slope * z) {
        const double l = std::hypot(x, z);
        return {{-x / l, 0, -z / l}, l, 1.0 / i.R};
      }
      const double s = x > 0.0 ? 1.0 : -1.0, l = std::hypot(1.0, slope);
      const Vec3d normal{s * slope / l, 0, 1.0 / l};
      return {-normal, (z + std::abs(x) * slope) / l, 1.0 / i.R};
    }
    case Partner::hollow_sphere:
    case Partner::ball: {
      const double l = std::sqrt(x * x + i.r.y * i.r.y + z * z);
      const bool inside = c.partner == Partner::hollow_sphere;
      const Vec3d out = (1.0 / l) * i.r;
      return {inside ? out : -out, inside ? c.wall_radius - l : l - c.wall_radius,
              1.0 / i.R + (inside ? -1.0 : 1.0) / c.wall_radius};
    }
    case Partner::fibre: {  // a capsule along y
      const double l = std::hypot(x, z);
      return {{-x / l, 0, -z / l}, l - c.wall_radius, 1.0 / i.R + 1.0 / c.wall_radius};
    }
    case Partner::trough: {  // a cylinder along y, from inside
      const double l = std::hypot(x, z), flat = 1.0 / i.R, round = 1.0 / i.R - 1.0 / c.wall_radius;
      return {{x / l, 0, z / l}, c.wall_radius - l, std::sqrt(flat * round)};
    }
  }
  return {};
}

/// Kicks and drifts of two bodies with forces written out once more: tangential force and rolling moment as
/// rates.
struct OwnIntegrator {
  Encounter c;
  Body i, j;
  Vec3d F_t{}, M_r{};  // elastic, on i
  double a_before = 0, k_before = 0;
  bool touched = false, over = false;

  explicit OwnIntegrator(const Encounter& e) : c(e), i(e.i), j(e.j) {}

  static double length(const Vec3d& x) { return std::sqrt(x.x * x.x + x.y * x.y + x.z * x.z); }
  static Vec3d plane_part(const Vec3d& x, const Vec3d& n) {
    const double l = length(x);
    Vec3d y = x - (x.x * n.x + x.y * n.y + x.z * n.z) * n;
    const double k = length(y);
    return k > 0.0 ? (l / k) * y : y;
  }
  /// Where the distance at which JKR still holds is least, and what is there.
  static double jkr_overlap(double a, double R, double w, double E_star) {
    return a * a / R - std::sqrt(2.0 * M_PI * w * a / E_star);
  }
  static double least_jkr_radius(double R, double w, double E_star) {
    return std::cbrt(M_PI * w * R * R / (8.0 * E_star));
  }
  /// The radius of the contact, by bisection.
  static double jkr_radius(double d, double R, double w, double E_star) {
    double low = least_jkr_radius(R, w, E_star), high = low + std::sqrt(R * std::max(d, 0.0)) + low;
    while (jkr_overlap(high, R, w, E_star) < d) high *= 2.0;
    for (int k = 0; k < 100 && high - low > 1e-15 * high; ++k) {
      const double a = 0.5 * (low + high);
      (jkr_overlap(a, R, w, E_star) < d ? low : high) = a;
    }
    return 0.5 * (low + high);
  }
  /// Loads on i: force, and moments on i and j.
  void loads(double dt, Vec3d& F, Vec3d& M_i, Vec3d& M_j) {
    F = M_i = M_j = {};
    const Near near = near_of(c, i, j);
    const double d = i.R - near.distance;
    const double E_star = c.E / (2.0 * (1.0 - c.nu * c.nu)), R = 1.0 / near.per_R;
    const bool jkr = c.adhesion == AdhesionForm::jkr;
    const double holds_to =
        jkr && touched ? jkr_overlap(least_jkr_radius(R, c.work, E_star), R, c.work, E_star) : 0.0;
    if (d <= holds_to) {
      if (touched) over = true;
      return;
    }
    touched = true;
    const bool pair = c.partner == Partner::particle;
    const double m = pair ? i.m * j.m / (i.m + j.m) : i.m;
    const bool two = pair || c.partner == Partner::fibre;  // the contact is in the middle of the overlap
    const double l_i = two ? i.R - 0.5 * d : near.distance, l_j = pair ? j.R - 0.5 * d : 0.0;
    const Vec3d n = near.n, zero{};
    const Vec3d w_j = pair ? j.w : zero, v_j = pair ? j.v : zero;
    const double G = c.E / (2.0 * (1.0 + c.nu));
    const double G_star = G / (2.0 * (2.0 - c.nu));
    const double a = jkr ? jkr_radius(d, R, c.work, E_star) : std::sqrt(R * d);
    const double k_n = 4.0 / 3.0 * E_star * a;  // F/d of Hertz
    double elastic = k_n * d, pressed = 0.0;    // and what friction counts besides
    if (jkr) {
      elastic = k_n * a * a / R - std::sqrt(8.0 * M_PI * c.work * E_star * a * a * a);
      pressed = 3.0 * M_PI * c.work * R;
    } else if (c.adhesion == AdhesionForm::dmt) {
      pressed = 2.0 * M_PI * c.work * R;
      elastic -= pressed;
    }
    const bool adheres = c.adhesion != AdhesionForm::none;
    const double v_n = dot(v_j - i.v, n);
    const double g = damping_of_restitution(NormalForm::hertz, c.attraction || adheres, c.e);
    double F_n = elastic - g * std::sqrt(m * k_n) * v_n;
    if (!c.attraction && !adheres) F_n = std::max(F_n, 0.0);
    const double pressing = std::max(adheres ? elastic + pressed : F_n, 0.0), limit = c.mu * pressing;
    const Vec3d v_c = v_j - i.v - cross(l_i * i.w + l_j * w_j, n);
    const Vec3d v_t = v_c - dot(v_c, n) * n;
    const double k_t = 8.0 * G_star * a;
    const double spin = 0.5 * dot(i.w + w_j, n) * dt;
    F_t = plane_part(F_t + spin * cross(n, F_t), n);
    if (a < a_before) F_t = (a / a_before) * F_t;
    F_t = F_t + (k_t * dt) * v_t;
    Vec3d friction = F_t;
    if (length(F_t) > limit) {
      F_t = (limit / length(F_t)) * F_t;
      friction = F_t;
    } else {
      friction = F_t + (g * std::sqrt(m * k_n)) * v_t;
      if (length(friction) > limit && length(friction) > 0.0)
        friction = (limit / length(friction)) * friction;
    }
    F = friction - F_n * n;
    M_i = l_i * cross(n, F), M_j = l_j * cross(n, F);
    if (c.mu_r > 0.0) {
      const Vec3d w = w_j - i.w;
      M_r = plane_part(M_r + spin * cross(n, M_r), n) + (c.k_r * dt) * (w - dot(w, n) * n);
      const double most = c.mu_r * R * pressing;
      if (length(M_r) > most) M_r = (most / length(M_r)) * M_r;
      M_i = M_i + M_r, M_j = M_j - M_r;
    }
    a_before = a;
  }
  void run(double dt, int steps) {
    Vec3d F, M_i, M_j;
    for (int k = 0; k < steps && !over; ++k) {
      i.r = i.r + dt * i.v, j.r = j.r + dt * j.v;
      loads(dt, F, M_i, M_j);
      i.v = i.v + (dt / i.m) * F, i.w = i.w + (dt / i.I) * M_i;
      if (c.partner != Partner::particle) continue;
      j.v = j.v - (dt / j.m) * F, j.w = j.w + (dt / j.I) * M_j;
    }
  }
};

Encounter random_encounter(Partner partner, unsigned seed) {
  Dice dice(seed);
  Encounter c;
  c.partner = partner;
  c.E = std::pow(10.0, dice(1, 4)), c.nu = dice(0.0, 0.45), c.mu = dice(0, 1) < 0.2 ? 0.0 : dice(0.05, 1.0);
  c.e = dice(0, 1) < 0.2 ? 1.0 : dice(0.2, 0.98), c.attraction = dice(0, 1) < 0.5;
  if (dice(0, 1) < 0.5) c.mu_r = dice(0.01, 0.3);
  const double ratio = std::exp(dice(-std::log(20.0), std::log(20.0)));  // radii 1 : 20 and 20 : 1
  c.i.R = 1.0, c.j.R = ratio;
  for (Body* b : {&c.i, &c.j}) b->m = b->R * b->R * b->R, b->I = 0.4 * b->m * b->R * b->R;
  const double speed =
      std::pow(10.0, dice(-2, -0.3)) * std::sqrt(c.E);  // of impact against that of sound, about
  const double v = 0.1 * speed;
  const double lean = dice(0.0, 1.2), around = dice(0, 2 * M_PI);
  const Vec3d spin{dice(-1, 1) * v, dice(-1, 1) * v, dice(-1, 1) * v};
  c.i.v = v * Vec3d{std::sin(lean) * std::cos(around), std::sin(lean) * std::sin(around), -std::cos(lean)};
  c.i.w = spin;
  const double gap = 1e-3;
  switch (partner) {
    case Partner::particle:
      c.i.r = {0, 0, 1.0 + c.j.R + gap};
      c.j.w = {dice(-1, 1) * v / c.j.R, dice(-1, 1) * v / c.j.R, dice(-1, 1) * v / c.j.R};
      break;
    case Partner::plane: c.i.r = {0, 0, 1.0 + gap}; break;
    case Partner::ridge: {
      const double th = dice(-0.6, 0.6);  // within 20 degrees the edge is met, beyond them a face
      c.i.r = (1.0 + gap) * Vec3d{std::sin(th), 0, std::cos(th)};
      if (std::abs(th) > 0.3490658503988659) {
        const double s = th > 0 ? 1.0 : -1.0, along = dice(0.3, 1.5), l = std::hypot(1.0, slope);
        c.i.r = along * Vec3d{s / l, 0, -slope / l} + (1.0 + gap) * Vec3d{s * slope / l, 0, 1.0 / l};
      }
      break;
    }
    case Partner::hollow_sphere:
    case Partner::trough:
      c.wall_radius = dice(1.5, 20.0);
      c.i.r = {0, 0, -(c.wall_radius - 1.0 - gap)};
      break;
    case Partner::fibre:
      c.wall_radius = std::exp(dice(-std::log(20.0), std::log(5.0)));
      c.i.r = {0, 0, c.wall_radius + 1.0 + gap};
      c.mu_r = 0.0;
      break;
    case Partner::ball:
      c.wall_radius = std::exp(dice(-std::log(20.0), std::log(20.0)));
      c.i.r = {0, 0, c.wall_radius + 1.0 + gap};
      break;
  }
  const double m = partner == Partner::particle ? c.i.m * c.j.m / (c.i.m + c.j.m) : c.i.m;
  const double R = partner == Partner::particle ? c.j.R / (1.0 + c.j.R) : 1.0;
  const double k = 4.0 / 3.0 * c.E / (2.0 * (1.0 - c.nu * c.nu)) * std::sqrt(R);
  const double v_n = std::max(std::cos(lean) * v, 0.05 * v);
  // an adhesion that takes a part of the energy of the impact: they part again
  const double kind = dice(0, 1), part = dice(0.01, 0.1);
  if (kind < 0.4 && partner != Partner::fibre) {  // capsules take none
    c.adhesion = kind < 0.2 ? AdhesionForm::jkr : AdhesionForm::dmt;
    const double overlap = std::pow(1.25 * m * v_n * v_n / k, 0.4);
    c.work = part * m * sq(v_n * c.e) / (R * overlap);
  }
  c.k_r = 0.2 * k * std::sqrt(0.01);
  c.dt = 2.94 * std::pow(m * m / (k * k * v_n), 0.2) / 400;  // 400 steps of a head-on impact
  return c;
}

Specimen specimen_of(const Encounter& c) {
  const bool pair = c.partner == Partner::particle;
  const double far = 200.0;
  std::vector<Vec3d> places{c.i.r};
  if (pair) places.push_back(c.j.r);
  if (c.partner == Partner::fibre) places.insert(places.end(), {{0, -far, 0}, {0, far, 0}});
  Specimen s = testing::particles_at(places, 1.0);
  Body heavy;
  heavy.m = heavy.I = 1e12, heavy.R = c.wall_radius;
  const Body* bodies[] = {&c.i, pair ? &c.j : &heavy, &heavy};
  for (const ParticleId p : s.state.r.ids()) {
    const Body& b = *bodies[p.value];
    s.model.mass[p] = b.m, s.model.inertia[p] = b.I, s.model.radius[p] = b.R;
    s.state.v[p] = b.v, s.state.omega[p] = b.w;
  }
  ContactModel& m = s.model.contact;
  m = {.law = ContactLaw::hertz, .pairs = ContactPairs::all, .E = c.E, .nu = c.nu};
  m.tangential = TangentialForm::mindlin, m.attraction = c.attraction;
  m.surface.friction = c.mu, m.surface.restitution = c.e;
  m.adhesion = c.adhesion, m.surface.work_of_adhesion = c.work;
  if (c.partner == Partner::fibre) {
    BondRecipe recipe = testing::papers_bond();
    recipe.capsule = true, recipe.capsule_radius = c.wall_radius;
    testing::bond(s, 1, 2, recipe);
  }
  if (c.mu_r > 0.0)
    m.rolling = RollingForm::spring, m.rolling_stiffness = c.k_r, m.surface.rolling_friction = c.mu_r;
  Wall wall{"wall", PlaneWall{{0, 0, 0}, {0, 0, 1}}, 0, {}};
  if (c.partner == Partner::ridge)
    wall.shape = MeshWall{{{{0, -far, 0},
                            {0, far, 0},
                            {far, -far, -slope * far},
                            {far, far, -slope * far},
                            {-far, -far, -slope * far},
                            {-far, far, -slope * far}},
                           {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {1, 5, 4}}}};
  if (c.partner == Partner::hollow_sphere || c.partner == Partner::ball)
    wall.shape =
        SphereWall{{}, c.wall_radius, c.partner == Partner::ball ? WallSide::outside : WallSide::inside};
  if (c.partner == Partner::trough)
    wall.shape =
        CylinderWall{{}, {0, 1, 0}, c.wall_radius, std::numeric_limits<double>::infinity(), WallSide::inside};
  if (!pair && c.partner != Partner::fibre) s.model.walls = {wall};
  return s;
}

Verdict judge(Partner partner, unsigned seed, testing::Tally& all) {
  const Encounter c = random_encounter(partner, seed);
  const Specimen s = specimen_of(c);
  constexpr int finer = 40;
  OwnIntegrator own(c);
  own.run(c.dt / finer, finer * 6000);
  Simulation run(s.model, testing::plain_stage(c.dt, 1e9), s.state);
  bool touched = false, parted = false;
  try {
    for (int k = 0; k < 6000; ++k) {
      run.step();
      const bool touches = norm(run.loads().F[ParticleId{0}]) > 0.0 || !run.state().contact_history.empty() ||
                           !run.state().wall_history.empty() || !run.state().fibre_history.empty();
      parted = touched && !touches;
      if (parted) break;
      touched = touched || touches;
    }
  } catch (const Diverged&) {
    return testing::wrong("passed through");
  }
  if (!own.over || !parted)
    return own.over == parted ? Verdict{"stick with both"} : testing::wrong("sticks, or does so alone");
  const double v_0 = norm(c.i.v), scale = v_0 * c.i.m;
  const State& state = run.state();
  double error = norm(state.v[ParticleId{0}] - own.i.v) * c.i.m;
  error = std::max(error, norm(state.omega[ParticleId{0}] - own.i.w) * c.i.I);
  if (partner == Partner::particle) {
    error = std::max(error, norm(state.v[ParticleId{1}] - own.j.v) * c.j.m);
    error = std::max(error, norm(state.omega[ParticleId{1}] - own.j.w) * c.j.I / c.j.R);
  }
  all.most("error of the momentum", error / scale);
  const Energies e = run.energies();
  const double made = e.total() - run.books().at_start;
  // DMT's pull of 2 pi w R begins and ends with a jump somewhere in a step, of 1/136 of the overlap: up to
  // 2 pi 0.1/136 of the energy
  const double jump = c.adhesion == AdhesionForm::dmt ? 5e-3 : 0.0;
  if (made > (1e-3 + jump) * run.books().at_start ||
      run.books().dissipated < -(1e-4 + jump) * run.books().at_start ||
      std::abs(run.balance_error()) > 3e-3 + jump)
    return testing::wrong("energy is made");
  return error < 5e-3 * scale ? Verdict{} : testing::wrong("off by " + std::to_string(error / scale));
}

// Both err by a part of a step in when contact begins, slips and ends: 1/400 of the duration, and the rest by
// the order of the method. Of 7000 (VBOND_CAMPAIGN=1000) none was wrong, 14 stuck with both; the worst was
// 4.7e-3 of the momentum.
TEST(Encounters, AreThoseOfAnotherIntegrator) {
  constexpr std::array partners{"particle", "plane", "ridge", "hollow sphere", "ball", "trough", "fibre"};
  for (std::size_t k = 0; k < partners.size(); ++k)
    testing::campaign(partners[k], 5, [k](unsigned seed, testing::Tally& all) {
      return judge(static_cast<Partner>(k), seed, all);
    });
}

}  // namespace
}  // namespace vbond::encounter_campaign_test
