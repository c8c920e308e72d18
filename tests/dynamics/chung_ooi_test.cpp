// C2 of the reference: the benchmarks of Chung & Ooi 2011 of spheres that meet a plane (tests 2 to 6 and 8; 1
// and 7 are in touch_test.cpp), and CT7, a sled on an incline.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "rods.hpp"

namespace vbond::chung_ooi_test {
namespace {

using testing::Specimen;

constexpr ParticleId first{0};
constexpr double rigid = 1e25;  // Young's modulus of a wall that does not give way
constexpr double pi = std::numbers::pi;

/// A sphere that has just not touched the plane z = 0 of its own or a rigid material.
struct Shot {
  double R, density, E, nu, mu = 0, e = 1, E_wall = rigid;
  Vec3d v, omega;
};
Specimen specimen_of(const Shot& s) {
  const double m = 4.0 / 3.0 * pi * s.R * s.R * s.R * s.density;
  Specimen to{equal_particles({{0, 0, s.R}}, m, 0.4 * m * sq(s.R), s.R), {}};
  to.model.materials = {{"ball", s.E, s.nu, {}}, {"wall", s.E_wall, s.nu, {}}};
  ContactModel& c = to.model.contact;
  c.law = ContactLaw::hertz, c.tangential = TangentialForm::mindlin;
  c.surface.friction = s.mu, c.surface.restitution = s.e;
  to.model.walls = {{"plane", PlaneWall{{0, 0, 0}, {0, 0, 1}}, 1, {}}};
  to.state = at_rest(to.model);
  to.state.v[first] = s.v, to.state.omega[first] = s.omega;
  return to;
}
/// 2.94 delta_max/v with k = 4/3 E* sqrt(R), in 2000 steps; and until it has left.
struct Result {
  double deepest = 0, force = 0, duration = 0;
  Vec3d v, omega;
};
Result shoot(const Shot& s) {
  const Specimen body = specimen_of(s);
  const double E_star = effective_modulus(s.E, s.nu, s.E_wall, s.nu), k = 4.0 / 3.0 * E_star * std::sqrt(s.R);
  const double m = body.model.mass[first], v = -s.v.z;
  const double t = 2.943275184 * std::pow(1.25 * m * sq(v) / k, 0.4) / v;
  Simulation run(body.model, testing::plain_stage(t / 2000, 4.0 * t), body.state);
  Result got;
  for (int n = 0; n < 8000; ++n) {
    run.step();
    const double overlap = s.R - run.state().r[first].z;
    if (overlap > 0.0) got.duration += t / 2000;
    got.deepest = std::max(got.deepest, overlap);
    got.force = std::max(got.force, -run.walls()[0].force.z);
    if (n > 1000 && overlap < 0.0) break;
  }
  got.v = run.state().v[first], got.omega = run.state().omega[first];
  EXPECT_LT(std::abs(run.balance_error()), 1e-3);
  return got;
}

TEST(ChungOoi, Test2ElasticImpactOnAPlane) {
  const struct {
    double E, nu, density, E_wall, deepest, force, duration;
  } rows[] = {{70e9, 0.3, 2699, rigid, 4.97171752417e-5, 11369.8583113, 0.000731656640619},
              {70e9, 0.3, 2699, 70e12, 4.9737056149e-5, 11365.313549, 0.000731949215523},
              {40e9, 0.35, 1800, rigid, 5.21232883183e-5, 7232.68102597, 0.000767065905163},
              {40e9, 0.35, 1800, 40e12, 5.21441313821e-5, 7229.78997709, 0.000767372639526}};
  for (const auto& r : rows) {
    const Result got = shoot({0.1, r.density, r.E, r.nu, 0.0, 1.0, r.E_wall, {0, 0, -0.2}, {}});
    EXPECT_NEAR(got.deepest / r.deepest, 1.0, 1e-4);
    EXPECT_NEAR(got.force / r.force, 1.0, 1e-4);
    EXPECT_NEAR(got.duration / r.duration, 1.0, 2e-3);
  }
}

TEST(ChungOoi, Test3ReboundAtTheRestitutionThatWasGiven) {
  for (const double e : {0.2, 0.4, 0.6, 0.8, 1.0}) {
    const Result got = shoot({0.0025, 4000, 380e9, 0.23, 0.092, e, rigid, {0, 0, -3.9}, {}});
    EXPECT_NEAR(got.v.z / 3.9, e, 1e-3) << e;
  }
}

// Gross sliding: the rebound follows from the impulse alone, mu (1 + e) m v_n.
TEST(ChungOoi, Test4ObliqueImpactThatSlides) {
  const struct {
    double degrees, tangential, omega;
  } rows[] = {{40, 0.782910165573, 544.216357458}, {50, 0.847149611185, 456.651744824},
              {60, 0.894829874964, 355.212},       {70, 0.933699182126, 242.979318302},
              {80, 0.967880277194, 123.363832971}, {85, 0.984063065052, 61.9175313858}};
  for (const auto& r : rows) {
    const double th = r.degrees * pi / 180, v_t = 3.9 * std::sin(th);
    const Result got =
        shoot({0.0025, 4000, 380e9, 0.23, 0.092, 0.98, rigid, {v_t, 0, -3.9 * std::cos(th)}, {}});
    EXPECT_NEAR(got.v.x / v_t, r.tangential, 1e-3) << r.degrees;
    EXPECT_NEAR(std::abs(got.omega.y) / r.omega, 1.0, 4e-3) << r.degrees;  // the lever is R - d: d/R = 3e-3
  }
}

TEST(ChungOoi, Test5ElasticObliqueImpactThatSlides) {
  const double v_n = 5.0, mu = 0.3, R = 1e-5;
  for (const double psi : {8.0, 12.0}) {
    const Result got = shoot({R, 7850, 208e9, 0.3, mu, 1.0, rigid, {psi * mu * v_n, 0, -v_n}, {}});
    EXPECT_NEAR(R * std::abs(got.omega.y) / (mu * v_n), 5.0, 4e-2) << psi;  // the lever is R - d: d/R = 8e-3
    const double surface = got.v.x - R * std::abs(got.omega.y);
    EXPECT_NEAR(surface / (mu * v_n), psi - 7.0, 4e-2) << psi;
  }
}

TEST(ChungOoi, Test6SpinningSphere) {
  const double v_n = 0.2, mu = 0.4, e = 0.5, R = 0.1;
  for (const double surface : {0.6, 1.5}) {  // sliding all the way needs 3.5 mu (1 + e) v_n = 0.42
    const Result got = shoot({R, 2700, 70e9, 0.33, mu, e, rigid, {0, 0, -v_n}, {0, surface / R, 0}});
    EXPECT_NEAR(got.v.x, mu * (1 + e) * v_n, 1e-3 * v_n) << surface;
    EXPECT_NEAR(got.omega.y, surface / R - 2.5 * mu * (1 + e) * v_n / R, 3e-3 * surface / R) << surface;
  }
}

// A sphere that is five times as large, a thousand times as stiff and as dense is a plane, but for its
// curvature.
TEST(ChungOoi, Test8AgainstALargeSphere) {
  const double v_n = 0.2, mu = 0.4, e = 0.5, R = 0.1, surface = 1.0, density = 2700;
  const auto mass = [&](double r, double d) { return 4.0 / 3.0 * pi * r * r * r * d; };
  Specimen s{equal_particles({{0, 0, 0.6}, {0, 0, 0}}, 1.0, 1.0, R), {}};
  const double R_i[] = {R, 0.5}, m[] = {mass(R, density), mass(0.5, 1000 * density)};
  for (const ParticleId p : s.model.mass.ids()) {
    s.model.radius[p] = R_i[p.value], s.model.mass[p] = m[p.value];
    s.model.inertia[p] = 0.4 * m[p.value] * sq(R_i[p.value]);
  }
  s.model.materials = {{"ball", 70e9, 0.33, {}}, {"large", 70e12, 0.33, {}}};
  s.model.material = PerParticle<std::uint32_t>(std::vector<std::uint32_t>{0, 1});
  s.model.contact.law = ContactLaw::hertz, s.model.contact.tangential = TangentialForm::mindlin;
  s.model.contact.surface.friction = mu, s.model.contact.surface.restitution = e;
  s.state = at_rest(s.model);
  s.state.v[first] = {0, 0, -v_n}, s.state.omega[first] = {0, surface / R, 0};
  Simulation run(s.model, testing::plain_stage(5e-7, 3e-3), s.state);
  run.run();
  EXPECT_NEAR(run.state().v[first].x, mu * (1 + e) * v_n, 2e-3 * v_n);
  EXPECT_NEAR(run.state().omega[first].y, surface / R - 2.5 * mu * (1 + e) * v_n / R, 3e-3 * surface / R);
}

// CT7: four spheres at the corners of a square, stiffly bonded, on a plane at an angle: below tan = mu it
// stays, above it slides with g (sin - mu cos).
TEST(Sled, SticksOrSlides) {
  const struct {
    double degrees, a;
  } rows[] = {{10, 0.0}, {21, 0.0}, {22.5, 0.12882118592724182}, {30, 1.5067163155498617}};
  const double g = 9.81, k = 1e6;
  for (const auto& row : rows) {
    const double th = row.degrees * pi / 180;
    Specimen s{equal_particles({{0, 0, 0.5}, {1.2, 0, 0.5}, {1.2, 1.2, 0.5}, {0, 1.2, 0.5}}, 1.0, 0.1, 0.5),
               {}};
    s.state = at_rest(s.model);
    BondRecipe stiff;
    stiff.parameters = BondStiffness<double>{1e6, 1e6, 1e6, 1e6};
    stiff.damping = {DampingBy::ratio, {0.1, 0.1, 0.1, 0.1}};  // else it rocks
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) testing::bond(s, a, b, stiff);
    ContactModel& c = s.model.contact;
    c.law = ContactLaw::linear, c.k = k, c.tangential = TangentialForm::linear, c.k_t = 0.3 * k;
    c.surface.friction = 0.4, c.surface.restitution = 0.1;
    s.model.walls = {{"slope", PlaneWall{{0, 0, g * std::cos(th) / k}, {0, 0, 1}}, 0, {}}};
    Stage stage = testing::plain_stage(1e-4, 1.0);
    stage.gravity = {g * std::sin(th), 0, -g * std::cos(th)};
    Simulation run(s.model, stage, s.state);
    while (run.clock().time() < 0.5) run.step();
    const double early = run.state().v[first].x, from = run.clock().time();
    run.run();
    EXPECT_NEAR((run.state().v[first].x - early) / (run.clock().time() - from), row.a, 1e-4 * g)
        << row.degrees;
  }
}

}  // namespace
}  // namespace vbond::chung_ooi_test
