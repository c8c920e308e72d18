// The law of two bodies that touch, without a step loop.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "vbond/physics/hertz.hpp"
#include "vbond/physics/touch.hpp"

namespace vbond::touch_test {
namespace {

/// A body on a plane that faces up, at this overlap and velocity; the plane is the second.
Touching<double> on_plane(double overlap, const Vec3d& v = {}, const Vec3d& omega = {}) {
  return {.n = {0, 0, -1},
          .overlap = overlap,
          .R = 1.0,
          .m = 1.0,
          .Theta = 0.4,
          .l_i = 1.0 - overlap,
          .l_j = 0.0,
          .v = -v,
          .w_i = omega,
          .w_j = {}};
}

constexpr TouchForms slipping{.tangential = TangentialForm::mindlin};
constexpr TouchNumbers<double> steady{.stiffness = 0.75, .tangential = 1.2, .friction = 1e9};

/// Moves the body along x by `way` at this depth, from what is remembered; returns the work that this takes.
double shear(double depth, double way, TouchHistory<double>& h, const TouchForms& forms = slipping) {
  constexpr int steps = 1000;
  double work = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double before = h.F_t.x;
    h = touch(forms, steady, on_plane(depth, {way, 0, 0}), 1.0 / steps, h).history;
    work -= 0.5 * (before + h.F_t.x) * way / steps;
  }
  return work;
}
/// Moves it back until its force is zero; returns the work that it gives.
double release(double depth, TouchHistory<double>& h, const TouchForms& forms = slipping) {
  const double k_t = steady.tangential * std::sqrt(depth);
  return -shear(depth, h.F_t.x / k_t, h, forms);
}
/// To another depth without slip; returns what the step counts as dissipated.
double press(double depth, TouchHistory<double>& h, const TouchForms& forms = slipping) {
  const TouchLoads<double> l = touch(forms, steady, on_plane(depth), 1.0, h);
  h = l.history;
  return l.lost.friction;
}

// Case CT3e of the reference: shear at one depth, change the depth, release. Depths 4 : 1, so a factor 2 of
// stiffness. A rule that keeps the force gives back 2 for 1 in the first cycle; this one loses in both.
TEST(Friction, GivesBackHalfOfWhatWasPutInAfterAChangeOfDepth) {
  for (const auto& [first, second] : {std::pair(0.04, 0.01), std::pair(0.01, 0.04)}) {
    TouchHistory<double> h;
    press(first, h);
    const double in = shear(first, 1e-3, h);
    press(second, h);
    EXPECT_NEAR(release(second, h) / in, 0.5, 1e-9);  // closed form; 1000 steps of linear springs
  }
}

// The same cycles without rescaling, by F^2/2k: a force that stays gives back k_1/k_2 of what was put in, a
// spring times the slip k_2/k_1. Each makes energy in one of the two, and the account says so.
TEST(Friction, WithoutRescalingCanMakeEnergyAndCountsIt) {
  for (const auto& [form, deep_first, shallow_first] :
       {std::tuple(TangentialForm::mindlin_force, 2.0, 0.5),
        std::tuple(TangentialForm::mindlin_displacement, 0.5, 2.0)})
    for (const auto& [first, second, ratio] :
         {std::tuple(0.04, 0.01, deep_first), std::tuple(0.01, 0.04, shallow_first)}) {
      const TouchForms forms{.tangential = form};
      TouchHistory<double> h;
      press(first, h, forms);
      const double in = shear(first, 1e-3, h, forms), counted = press(second, h, forms);
      const double out = release(second, h, forms);
      EXPECT_NEAR(out / in, ratio, 1e-9);  // closed form; 1000 steps of linear springs
      EXPECT_NEAR(counted, in - out, 1e-9 * in);
      EXPECT_TRUE(can_make_energy(form));
    }
  EXPECT_FALSE(can_make_energy(TangentialForm::mindlin) || can_make_energy(TangentialForm::linear));
}

TEST(ContactDamping, ByCoefficientIsTheSameAtEveryOverlap) {
  TouchNumbers<double> n = steady;
  n.viscous = 0.3;
  TouchForms forms;
  forms.attraction = true;
  for (const double depth : {0.01, 0.04})
    for (const double speed : {-0.2, 0.1}) {
      const Touching<double> p = on_plane(depth, {0, 0, speed});
      const double damped = dot(touch(forms, n, p, 0.1, {}).F - touch(forms, steady, p, 0.1, {}).F, p.n);
      EXPECT_NEAR(damped, 0.3 * dot(p.v, p.n), 1e-15);
    }
}

// Random closed loops of depth and slip, with and without sliding: over the loop, energy is never made, and
// the step's own account of what is dissipated is what went in less what is stored.
TEST(Friction, NeverReturnsEnergyOverLoops) {
  std::mt19937_64 random(7);
  const auto dice = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (int loop = 0; loop < 2000; ++loop) {
    TouchForms forms = slipping;
    TouchNumbers<double> n = steady;
    n.friction = dice(0.05, 1.0);
    if (loop % 2 == 0) forms.rolling = RollingForm::spring, n.rolling = dice(0.01, 0.5), n.twisting = 0.1;
    std::vector<double> depths;
    std::vector<Vec3d> ways, turns;
    Vec3d sum, turned;
    for (int k = 0; k < 12; ++k) {
      depths.push_back(dice(0.005, 0.05));
      ways.push_back({dice(-0.02, 0.02), dice(-0.02, 0.02), 0});
      turns.push_back({dice(-0.02, 0.02), dice(-0.02, 0.02), dice(-0.02, 0.02)});
      sum += ways.back(), turned += turns.back();
    }
    ways.push_back(-sum), turns.push_back(-turned), depths.push_back(depths.front());
    TouchHistory<double> h;
    press(depths.front(), h);
    double in = 0.0, dissipated = 0.0;
    for (std::size_t k = 0; k < ways.size(); ++k) {
      constexpr int steps = 50;
      const TouchLoads<double> pressed = touch(forms, n, on_plane(depths[k]), 1.0, h);
      EXPECT_GE(pressed.lost.sum(), 0.0);
      h = pressed.history, dissipated += pressed.lost.sum();
      for (int s = 0; s < steps; ++s) {
        const Touching<double> p = on_plane(depths[k], ways[k], turns[k]);
        const TouchHistory<double> before = h;
        const TouchLoads<double> l = touch(forms, n, p, 1.0 / steps, before);
        h = l.history;
        const Vec3d u = (1.0 / steps) * (p.v - cross(p.l_i * p.w_i, p.n));
        in += 0.5 * dot(before.F_t + h.F_t, u) +
              0.5 / steps * (dot(before.M_r + h.M_r, -p.w_i) - (before.M_t + h.M_t) * dot(p.w_i, p.n));
        dissipated += l.lost.sum();
        // forces turn by 2e-2/50 at most in a step, to first order
        const double moved = (norm(before.F_t) + norm(h.F_t)) * norm(u) +
                             (norm(before.M_r) + norm(h.M_r)) * norm(p.w_i) / steps;
        EXPECT_GT(l.lost.sum(), -4e-4 * moved - 1e-18);
      }
    }
    EXPECT_GT(in, 0.0) << loop;
    EXPECT_NEAR(dissipated, in - history_energy(forms, n, h), 4e-4 * in) << loop;
  }
}

// CT4: at a constant normal force the rule is linear and reaches mu F_n at 2/3 of Mindlin's s_max =
// 3 mu F_n/(16 G* a).
TEST(Friction, ReachesItsLimitAtTwoThirdsOfMindlinsSlip) {
  TouchNumbers<double> n = steady;
  n.friction = 0.3;
  const double depth = 0.01, a = std::sqrt(depth), F_n = 4.0 / 3.0 * n.stiffness * a * depth;
  const double G_star = n.tangential / 8.0, s_max = 3.0 * n.friction * F_n / (16.0 * G_star * a);
  for (const double part : {0.2, 0.5, 0.9, 1.1}) {
    TouchHistory<double> h;
    h = touch(slipping, n, on_plane(depth), 1.0, h).history;
    h = touch(slipping, n, on_plane(depth, {part * 2.0 / 3.0 * s_max, 0, 0}), 1.0, h).history;
    EXPECT_NEAR(-h.F_t.x / (n.friction * F_n), std::min(part, 1.0), 1e-12);
  }
}

// CT5: E* = 1000, R* = 0.01, w = 0.2.
TEST(Jkr, HasTheForcesOfTheReference) {
  const TouchForms jkr{.adhesion = AdhesionForm::jkr};
  const TouchNumbers<double> n{.stiffness = 1000.0, .work = 0.2};
  const double R = 0.01, pull_off = 5.698584674971594e-4;
  const std::pair<double, double> at[] = {{-1, -0.009424777960769378},
                                          {0, -0.008377580409572812},
                                          {1, -0.00583327440065624},
                                          {3, 0.0022433444434386413}};
  for (const auto& [multiple, F] : at)
    EXPECT_NEAR(normal_force(jkr, n, R, multiple * pull_off).F, F, 1e-9 * 0.0094) << multiple;
  EXPECT_NEAR(normal_force(jkr, n, R, 0.0).a, 0.005008833798856054, 1e-12);
  const double tear = reach_of_adhesion(1000.0, 0.2, R);
  EXPECT_NEAR(tear, 0.0011853533796699924, 1e-12);
  EXPECT_NEAR(normal_energy(jkr, n, R, -tear) - normal_energy(jkr, n, R, 0.0), 1.0451149341950927e-05,
              1e-9 * 1e-5);
  const TouchForms dmt{.adhesion = AdhesionForm::dmt};
  EXPECT_NEAR(normal_force(dmt, n, R, 0.0).F, -0.012566370614359173, 1e-15);
}

// The force of every form is the slope of its energy.
TEST(NormalForce, IsTheGradientOfItsEnergy) {
  TouchForms forms[5];
  forms[1].normal = NormalForm::linear, forms[2].normal = NormalForm::one_hertz;
  forms[3].adhesion = AdhesionForm::jkr, forms[4].adhesion = AdhesionForm::dmt;
  const TouchNumbers<double> n{.stiffness = 100.0, .work = 0.3};
  for (const TouchForms& f : forms)
    for (const double d : {0.003, 0.02, 0.1}) {
      const double h = 1e-5 * d, F = normal_force(f, n, 0.4, d).F;
      const double slope = (normal_energy(f, n, 0.4, d + h) - normal_energy(f, n, 0.4, d - h)) / (2.0 * h);
      EXPECT_NEAR(slope, F, 1e-8 * (std::abs(F) + n.stiffness * d * d));  // h^2 and rounding / h
    }
}

/// Restitution of a body that hits a plane at unit speed, m = R = 1.
double rebound(const TouchForms& forms, const TouchNumbers<double>& n, double dt,
               double* duration = nullptr) {
  double z = 0.0, v = -1.0, F = 0.0, last = 0.0;
  TouchHistory<double> h;
  for (int k = 1;; ++k) {
    v += 0.5 * dt * F;
    z += dt * v;
    const bool on = z < 0.0;
    const TouchLoads<double> l = on ? touch(forms, n, on_plane(-z, {0, 0, v}), dt, h) : TouchLoads<double>{};
    h = l.history, F = l.F.z;
    v += 0.5 * dt * F;
    if (F != 0.0) last = k * dt;
    if (!on) break;
  }
  if (duration != nullptr) *duration = last;
  return v;
}

// CT1, CT2: the restitution that was asked for, for both forms, with and without attraction, to second order
// in the step but for the step in which contact begins and ends.
TEST(Restitution, IsWhatWasAskedFor) {
  for (const NormalForm normal : {NormalForm::hertz, NormalForm::linear})
    for (const bool attraction : {false, true})
      for (const double e : {0.2, 0.5, 0.8, 0.95, 1.0}) {
        TouchForms forms;
        forms.normal = normal, forms.attraction = attraction;
        const TouchNumbers<double> n{.stiffness = normal == NormalForm::linear ? 1.0 : 0.75,
                                     .damping = damping_of_restitution(normal, attraction, e)};
        EXPECT_NEAR(rebound(forms, n, 1e-4), e, 2e-4) << e << (attraction ? " with attraction" : "");
      }
}

// Durations of CT1 and CT2, m* = k = v = 1.
TEST(Restitution, TakesTheTimeOfTheReference) {
  struct Row {
    NormalForm form;
    double e, t;
  };
  for (const Row& r :
       {Row{NormalForm::hertz, 0.2, 4.170293648841093}, Row{NormalForm::hertz, 0.5, 3.518531544778656},
        Row{NormalForm::hertz, 0.8, 3.29763221252245}, Row{NormalForm::linear, 0.2, 3.5298576168267175},
        Row{NormalForm::linear, 0.5, 3.2171505117118095}}) {
    TouchForms forms;
    forms.normal = r.form, forms.attraction = true;
    const TouchNumbers<double> n{.stiffness = r.form == NormalForm::linear ? 1.0 : 0.75,
                                 .damping = damping_of_restitution(r.form, true, r.e)};
    double t = 0.0;
    rebound(forms, n, 1e-4, &t);
    EXPECT_NEAR(t, r.t, 3e-4) << r.e;  // known to one or two steps
  }
}

TEST(Restitution, ClosedFormsMeetThoseOfTheReference) {
  const std::pair<double, double> hertz[] = {{0.2, 1.0195347712079317},
                                             {0.5, 0.4817692577645866},
                                             {0.8, 0.15842608746310957},
                                             {0.95, 0.03650378047743856}};
  for (const auto& [e, alpha] : hertz)
    EXPECT_NEAR(damping_of_restitution(NormalForm::hertz, true, e), alpha, 1e-14);
  // without attraction, .5502831... is what .5 gave with its damping
  EXPECT_NEAR(damping_of_restitution(NormalForm::linear, false, 0.5502831696271157), 2.0 * 0.2154537619662468,
              1e-12);
  EXPECT_NEAR(damping_of_restitution(NormalForm::linear, false, 0.3248628479544189), 2.0 * 0.4559498107691261,
              1e-12);
  EXPECT_GT(damping_of_restitution(NormalForm::hertz, false, least_restitution), 1.0);
  EXPECT_TRUE(std::isfinite(damping_of_restitution(NormalForm::hertz, false, least_restitution)));
}

// Constant rolling resistance stops what rolls within a step and never turns it round.
TEST(Rolling, OfConstantMomentStopsAndDoesNotReverse) {
  const TouchForms forms{.rolling = RollingForm::constant};
  const TouchNumbers<double> n{.stiffness = 0.75, .rolling = 0.1, .twisting = 0.2};
  for (const double omega : {1e-6, 1e-3, 1.0}) {
    const double dt = 1e-2, before = omega;
    const TouchLoads<double> l =
        touch(forms, n, on_plane(0.01, {}, {0, omega, 0}), dt, TouchHistory<double>{});
    const double after = omega + dt * l.M.y / 0.4;
    EXPECT_LE(l.M.y, 0.0);
    EXPECT_GE(after, -1e-15 * before);
    EXPECT_LE(std::abs(l.M.y), 0.1 * normal_force(forms, n, 1.0, 0.01).F * (1 + 1e-14));
  }
}

TEST(Pairs, HaveTheModuliOfTheirMaterials) {
  EXPECT_NEAR(effective_modulus(70e9, 0.25, 70e9, 0.25), effective_modulus(70e9, 0.25), 1e-4);
  // k_t/k_n of equal materials: 3 (1 - nu)/(2 - nu) of 4/3 E*
  EXPECT_NEAR(mindlin_modulus(1.0, 0.3, 1.0, 0.3) / (4.0 / 3.0 * effective_modulus(1.0, 0.3, 1.0, 0.3)),
              3.0 * 0.7 / 1.7, 1e-14);
}

}  // namespace
}  // namespace vbond::touch_test
