// Grips that are free in part, under drag: a rigid body each of whose particles is dragged by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "clouds.hpp"
#include "vbond/dynamics/free_grip.hpp"

namespace vbond {
namespace {

using testing::cloud;
using testing::grip;
using testing::mass_of;
using testing::Specimen;

/// A rigid body of particles each of which is dragged by itself, by Runge and Kutta's rule.
class DraggedBody {
 public:
  DraggedBody(const Specimen& s, const Stage& stage, const Vec3d& V, const Vec3d& w) : s_(s), stage_(stage) {
    const double M = mass_of(s);
    for (const ParticleId p : s.model.mass.ids()) now_.centre += s.model.mass[p] / M * s.state.r[p];
    GripMass mass;
    for (const ParticleId p : s.model.mass.ids())
      mass.add(arm(p), s.model.mass[p], s.model.inertia[p], 0.0, 0.0);
    const auto& I = mass.inertia;
    inertia_ = *principal_inertia({I[0], I[1], I[2], I[3], I[4], I[5]});
    start_ = now_.centre;
    now_.V = V, now_.L = angular_momentum(inertia_.moments, inertia_.axes, w);
  }
  void go(double T, double h) {
    for (int n = 0; n < static_cast<int>(std::round(T / h)); ++n) {
      const Rates a = rates(now_), b = rates(after(now_, a, h / 2)), c = rates(after(now_, b, h / 2)),
                  d = rates(after(now_, c, h));
      now_ = after(now_,
                   {mean(a.V, b.V, c.V, d.V), mean(a.w, b.w, c.w, d.w), mean(a.F, b.F, c.F, d.F),
                    mean(a.M, b.M, c.M, d.M)},
                   h);
    }
  }
  Vec3d place(ParticleId p) const { return now_.centre + rotate(now_.turn, s_.state.r[p] - start_); }
  double angle() const { return norm(rotation_vector(now_.turn)); }

 private:
  struct Now {
    Vec3d centre, V, L;
    Quatd turn{1, 0, 0, 0};
  };
  struct Rates {
    Vec3d V, w, F, M;
  };
  static Vec3d mean(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    return 1.0 / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  Vec3d arm(ParticleId p) const { return s_.state.r[p] - now_.centre; }
  Rates rates(const Now& at) const {
    Rates x{at.V, angular_velocity(inertia_.moments, at.turn * inertia_.axes, at.L), {}, {}};
    for (const ParticleId p : s_.state.r.ids()) {
      const Vec3d y = rotate(at.turn, s_.state.r[p] - start_);
      const Vec3d F = -stage_.b_translation * (x.V + cross(x.w, y));
      x.F += F, x.M += cross(y, F) - stage_.b_rotation * x.w;
    }
    return x;
  }
  /// Turned by the mean angular velocity: exact to fourth order but for what rates do not commute, h^3 of it.
  Now after(const Now& at, const Rates& x, double h) const {
    const double M = mass_of(s_);
    return {at.centre + h * x.V, at.V + h / M * x.F, at.L + h * x.M, rotation_of(h * x.w) * at.turn};
  }

  const Specimen& s_;
  const Stage& stage_;
  PrincipalInertia inertia_{};
  Now now_;
  Vec3d start_;
};

// Where masses differ, drag turns a body that is only thrown: its resultant passes beside the centre of mass.
// The reference is good to 1e-7; errors are of the second order in the step, also with strong drag.
TEST(FreeGrip, DragPassesBesideTheCentreOfMass) {
  testing::campaign("drag of clumps", 10, [](unsigned seed) -> testing::Verdict {
    testing::Dice dice(seed);
    Specimen s = cloud(2 + seed % 4, seed);
    s.model.mass[ParticleId{1}] = dice(2.0, 9.0);
    Stage stage = testing::plain_stage(0.04, 4.0);
    stage.b_translation = std::exp(dice(-3.0, 0.5)), stage.b_rotation = dice(0.0, 0.02);
    stage.supports = {grip(s.model.groups[0].particles, HeldDofs{})};
    const Vec3d V = dice.vector(1.0), w = dice.vector(0.3);
    DraggedBody right(s, stage, V, w);
    Vec3d centre;
    for (const ParticleId p : s.model.mass.ids()) centre += s.model.mass[p] / mass_of(s) * s.state.r[p];
    for (const ParticleId p : s.model.mass.ids())
      s.state.v[p] = V + cross(w, s.state.r[p] - centre), s.state.omega[p] = w;
    right.go(4.0, 1e-3);
    double error[2];
    for (const int k : {0, 1}) {
      stage.dt = k == 0 ? 0.04 : 0.02;
      Simulation run(s.model, stage, s.state);
      run.run();
      error[k] = 0.0;
      for (const ParticleId p : s.state.r.ids())
        error[k] = std::max(error[k], norm(run.state().r[p] - right.place(p)));
      if (!(std::abs(run.books().work_supports) < 1e-12)) return testing::wrong("the support does work");
    }
    if (error[0] > 3e-3) return testing::wrong("off by " + std::to_string(error[0]));
    if (std::abs(error[1] / error[0] - 0.25) > 0.05)
      return testing::wrong("of order " + std::to_string(std::log2(error[0] / error[1])));
    return {};
  });
}

}  // namespace
}  // namespace vbond
