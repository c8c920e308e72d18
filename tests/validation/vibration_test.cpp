// Validation cases D7 and D8: in-plane vibration of a ring; a free asymmetric top.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "cases.hpp"
#include "rings.hpp"
#include "swings.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

using testing::number;
using testing::validation_case;

/// Motion number n of a ring: x cos(n phi) outwards, y sin(n phi) along, a turn z sin(n phi). By symmetry the
/// ring's vibration stays within these three.
struct RodWave {
  const testing::Specimen& ring;
  int n;

  double angle(ParticleId p) const {
    return 2 * M_PI * p.value / static_cast<double>(ring.model.particles());
  }
  State moved(const Vec3d& by) const {
    State s = ring.state;
    for (const ParticleId p : s.r.ids()) {
      const double phi = angle(p), c = std::cos(n * phi), t = std::sin(n * phi);
      const Vec3d out{std::cos(phi), std::sin(phi), 0}, along{-out.y, out.x, 0};
      s.r[p] += by.x * c * out + by.y * t * along;
      s.q[p] = rotation_of({0, 0, by.z * t});
    }
    return s;
  }
  /// The three components of given vectors, of position or force, and turns or moments about z.
  template <class Shift, class Turn>
  Vec3d components(Shift shift, Turn turn) const {
    Vec3d sum;
    for (const ParticleId p : ring.state.r.ids()) {
      const double phi = angle(p), c = std::cos(n * phi), t = std::sin(n * phi);
      const Vec3d out{std::cos(phi), std::sin(phi), 0}, along{-out.y, out.x, 0};
      sum += Vec3d{c * dot(out, shift(p)), t * dot(along, shift(p)), t * turn(p)};
    }
    return sum / (0.5 * static_cast<double>(ring.model.particles()));
  }
  /// Restoring load per unit of `direction`, by a central difference.
  Vec3d stiffness_times(const Vec3d& direction) const {
    const double h = 1e-5;
    Vec3d sum;
    for (const double sign : {-1.0, 1.0}) {
      Loads l{PerParticle<Vec3d>(ring.model.particles()), PerParticle<Vec3d>(ring.model.particles())};
      add_bond_loads(moved(sign * h * direction), l);
      sum -= sign / (2 * h) *
             components([&](ParticleId p) { return l.F[p]; }, [&](ParticleId p) { return l.M[p].z; });
    }
    return sum;
  }
};

/// The shape of the slowest of the three modes, by inverse iteration; its largest component is 1.
Vec3d slowest_shape(const RodWave& w, double m, double Theta) {
  const Vec3d k1 = w.stiffness_times({1, 0, 0}), k2 = w.stiffness_times({0, 1, 0}),
              k3 = w.stiffness_times({0, 0, 1});
  const double det = dot(k1, cross(k2, k3));
  Vec3d shape{1, 1, 1};
  for (int i = 0; i < 20; ++i) {
    const Vec3d b{m * shape.x, m * shape.y, Theta * shape.z};
    shape = Vec3d{dot(b, cross(k2, k3)), dot(k1, cross(b, k3)), dot(k1, cross(k2, b))} / det;
    shape = shape / std::max({std::abs(shape.x), std::abs(shape.y), std::abs(shape.z)});
  }
  return shape;
}

/// Frequency of that mode, swung freely with an amplitude of 1e-6. Modes that stretch the ring are sorted out
/// by projection: they are orthogonal in mass.
double ring_frequency(std::size_t N, int n) {
  testing::Specimen ring = testing::ring(N, 1e6);
  const double a = 2 * std::sin(M_PI / static_cast<double>(N)), m = 2 * M_PI / static_cast<double>(N);
  ring.model.mass.assign(N, m);
  ring.model.inertia.assign(N, 0.1 * m * a * a);
  const RodWave w{ring, n};
  const Vec3d shape = slowest_shape(w, m, 0.1 * m * a * a);
  const Vec3d weights{m * shape.x, m * shape.y, 0.1 * m * a * a * shape.z};
  const double size = 1e-6;
  Simulation run(ring.model, testing::plain_stage(0.9 * step_bound(ring.model, ring.state).dt, 1e99),
                 w.moved(size * shape));
  return testing::frequency_of_mode(
      run,
      [&](const State& s) {
        return dot(weights, w.components([&](ParticleId p) { return s.r[p] - ring.state.r[p]; },
                                         [&](ParticleId p) { return 2 * s.q[p].z; })) /
               dot(weights, shape) / size;
      },
      1);
}

// Amplitude 1e-6 couples to stretching, EA / EI = 1e6 times stiffer, at 1e6 * 1e-12; leap-frog's shift is
// 1e-8; rounding of positions, 1e-16, times EA / EI gives random forces of 1e-4 of the amplitude's, of which
// an average over thousands of steps leaves 1e-6.
TEST(Ring, VibratesInItsPlaneWithTheExactDiscreteFrequencies) {
  const auto& expected = validation_case("D7").at("expected");
  for (const int n : {2, 3, 4}) {
    const auto which = static_cast<std::size_t>(n - 2);
    std::array<double, 2> error{};
    for (const std::size_t N : {24u, 48u}) {
      const double found = ring_frequency(N, n);
      EXPECT_NEAR(found / number(expected.at("discrete_N").at(std::to_string(N))[which]), 1.0, 1e-5)
          << "N = " << N << ", n = " << n;
      error[N / 48] = std::abs(found - number(expected.at("continuum_inextensional_Hoppe")[which]));
    }
    EXPECT_GT(error[0] / error[1], 3.5) << "second order, n = " << n;
  }
}

/// Period of the free top of case D8 when every stiffness of its bonds is c: omega_y, in the body, changes
/// sign twice a period.
double polhode_period(double c) {
  testing::Specimen top = testing::particles_at(
      {{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0.6, 0}, {0, -0.6, 0}, {0, 0, 0.3}, {0, 0, -0.3}}, 0.1, 0.01);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{c, c, c, c};
  for (std::size_t k = 1; k < 7; ++k) testing::bond(top, 0, k, recipe);
  const Vec3d spin{0.02, 1, 0.01};
  for (const ParticleId p : top.state.r.ids()) {
    top.state.omega[p] = spin;
    top.state.v[p] = cross(spin, top.state.r[p]);
  }
  Simulation run(top.model, testing::plain_stage(0.5 * step_bound(top.model, top.state).dt, 1e99), top.state);
  const ParticleId centre{0};
  const auto omega_y = [&] {
    const State& s = run.state();
    return dot(rotate(s.q[centre], Vec3d{0, 1, 0}), s.omega[centre]);
  };
  double first = 0.0, last = 0.0;
  for (int flips = 0; flips < 3;) {
    const double before = omega_y();
    run.step();
    const double now = omega_y();
    if ((before > 0.0) == (now > 0.0)) continue;
    last = run.state().clock.time() - run.stage().dt * now / (now - before);
    if (++flips == 1) first = last;
  }
  return last - first;
}

// D8: the bonds' give and the step both lengthen the period as 1 / c, so that Richardson's value is the rigid
// body's, up to 1 / c^2 and to the small vibration of bonds that start without the pull of the spin: (spin /
// bond frequency)^2 = 1e-4 of the amplitude at c = 1e4.
TEST(AsymmetricTop, TumblesWithThePeriodOfTheRigidBody) {
  const double T = number(validation_case("D8").at("expected").at("polhode_period"));
  const double soft = polhode_period(1e4), stiff = polhode_period(4e4);
  EXPECT_NEAR(soft / T, 1.0, 0.001);
  EXPECT_GT((soft - T) / (stiff - T), 3.0);
  EXPECT_NEAR((4 * stiff - soft) / 3 / T, 1.0, 1e-4);
}

}  // namespace
}  // namespace vbond
