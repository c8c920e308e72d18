#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "plain_bonds.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/model/losses.hpp"

/// How bonds flow once more, in words of materials.md, section 3, apart from physics/flow_step.hpp: turned
/// axes as vectors of the bodies, roots by regula falsi, creep by small steps. For tests.
namespace vbond::testing {

/// Limits of a kind of load, their growth by flow, and the stiffness of the shift of their middle.
struct PlainLimit {
  double limit = 0, isotropic = 0, kinematic = 0;
};

struct PlainBond {
  std::size_t i = 0, j = 0;
  PlainLaw law;                    ///< a: the length that the coefficients were made for
  Stretch form;                    ///< of the axial force
  double a = 1, R_i = 0, R_j = 0;  ///< of now: temperature changes them
  std::array<double, 4> g{};       ///< damping of stretching, shear, bending, torsion
  Vec3d points_i, points_j;        ///< where the bonded points are, unit vectors in the bodies
  Vec3d axes_i[3], axes_j[3];      ///< in the bodies, turned by flow
  PlainLimit axial, shear, bending, torsion;
  double compression = 0;  ///< limit of -N
  double creep = 0;
  int exponent = 1;
  double N_c = 0, u_f = 0;  ///< softening
  Criterion criterion = Criterion::none;
  PlainLimits limits{1, 1, 1, 1};
  double factor = 1;
  bool broken = false;
  // what flow has done
  double stretch = 0, crept = 0, damage = 0, bent_2 = 0, bent_3 = 0, twisted = 0;
  std::array<double, 4> flow{};  ///< axial, shear, bending, torsion, all counted positive
  Losses lost{};
};

/// The first x >= 0 at which f, which falls, is zero; 0 if it is not above zero there. Small steps out: at
/// large angles f rises again, and falls to other zeros.
inline double root(const std::function<double(double)>& f, double slope) {
  double low = 0.0, f_low = f(0.0);
  if (!(f_low > 0.0)) return 0.0;
  double high = 0.5 * f_low / slope, f_high = f(high);
  for (int k = 0; k < 100 && f_high > 0.0; ++k) low = high, f_low = f_high, high *= 1.25, f_high = f(high);
  int side = 0;
  for (int k = 0; k < 100 && high - low > 1e-16 * high; ++k) {  // Illinois
    const double x = (low * f_high - high * f_low) / (f_high - f_low), f_x = f(x);
    if (f_x == 0.0 || x == low || x == high) return x;
    if (f_x > 0.0) {
      low = x, f_low = f_x;
      if (side > 0) f_high /= 2;
      side = 1;
    } else {
      high = x, f_high = f_x;
      if (side < 0) f_low /= 2;
      side = -1;
    }
  }
  return 0.5 * (low + high);
}

/// A bond as its particles stand.
struct PlainPose {
  Vec3d D, d, arm_i, arm_j, n[3], m[3];
  double length;
};
inline PlainPose pose_of(const PlainBond& b, const Vec3d& r_i, const Quatd& q_i, const Vec3d& r_j,
                         const Quatd& q_j) {
  PlainPose p;
  p.arm_i = b.R_i * rotate(q_i, b.points_i), p.arm_j = b.R_j * rotate(q_j, b.points_j);
  p.D = r_j - r_i + p.arm_j - p.arm_i;
  p.length = std::sqrt(dot(p.D, p.D));
  p.d = (1 / p.length) * p.D;
  for (int x = 0; x < 3; ++x) p.n[x] = rotate(q_i, b.axes_i[x]), p.m[x] = rotate(q_j, b.axes_j[x]);
  return p;
}
inline Vec3d part_across(const Vec3d& x, const Vec3d& d) {
  return x - dot(x, d) * d;
}
inline Vec3d unit(const Vec3d& x) {
  const double size = norm(x);
  return size > 0.0 ? (1 / size) * x : x;
}

inline double undamaged_force(const PlainBond& b, double length) {
  return axial_force(b.form, b.law.c[0], length - b.a - b.stretch - b.crept);
}
/// Elastic loads with damage; moments without the arms of the force.
inline PlainLoads loads_of(const PlainBond& b, const PlainPose& p) {
  const double N = undamaged_force(b, p.length), whole = 1.0 - b.damage;
  PlainLoads l = plain_loads(b.law, 0.0, p.D, p.n, p.m);
  l.F = whole * l.F + (N > 0.0 ? whole * N : N) * p.d;
  l.M_i = whole * l.M_i, l.M_j = whole * l.M_j;
  return l;
}

/// x as the shortest rotation turns it that turns `from` into `to`.
inline Vec3d carried(const Vec3d& x, const Vec3d& from, const Vec3d& to) {
  const Vec3d axis = cross(from, to);
  const double s = norm(axis);
  return s > 0.0 ? rotate(rotation_of(std::atan2(s, dot(from, to)) / s * axis), x) : x;
}

/// What a load dissipates that flows by x against a limit that grows.
inline double work_of(const PlainLimit& rule, double before, double x) {
  return (rule.limit + rule.isotropic * (before + 0.5 * x)) * x;
}

inline void flow_along(PlainBond& b, double length) {
  if (b.axial.limit == 0.0) return;
  const double c = b.law.c[0], back = b.axial.kinematic * b.stretch, over = undamaged_force(b, length) - back,
               sign = over > 0.0 ? 1.0 : -1.0;
  PlainLimit rule = b.axial;
  if (sign < 0.0) rule.limit = b.compression;
  // |N - back| - x (c + H) = limit + h (A + x): linear
  const double x =
      (std::abs(over) - rule.limit - rule.isotropic * b.flow[0]) / (c + rule.kinematic + rule.isotropic);
  if (!(x > 0.0)) return;
  b.lost[Loss::yield_axial] += work_of(rule, b.flow[0], x);
  b.stretch += sign * x, b.flow[0] += x;
}

inline void flow_across(PlainBond& b, const Quatd& q_i, const Quatd& q_j, const PlainPose& at) {
  if (b.shear.limit == 0.0 && b.bending.limit == 0.0 && b.torsion.limit == 0.0) return;
  const auto moment = [&](const PlainLoads& l) { return 0.5 * (l.M_i - l.M_j); };
  const PlainLoads first = plain_loads(b.law, 0.0, at.D, at.n, at.m);
  const Vec3d e_2 = unit(carried(at.n[1], at.n[0], at.d) + carried(at.m[1], -at.m[0], at.d));
  const Vec3d M = moment(first), e_3 = cross(at.d, e_2);
  const Vec3d shift = b.bending.kinematic * (b.bent_2 * e_2 + b.bent_3 * e_3);
  const double shift_t = b.torsion.kinematic * b.twisted;
  const Vec3d e_b = unit(part_across(M, at.d) - shift), e_v = unit(part_across(first.F, at.d));
  const double sign = dot(M, at.d) > shift_t ? 1.0 : -1.0;
  std::array<double, 3> x{};  // shear, bending, torsion
  PlainPose p = at;
  const auto turned = [&] {
    const Vec3d k = x[1] * e_b + (sign * x[2]) * at.d, s = (x[0] / at.length) * cross(at.d, e_v);
    const Quatd of_i = rotation_of(s + 0.5 * k), of_j = rotation_of(s - 0.5 * k);
    for (int n = 0; n < 3; ++n) p.n[n] = rotate(of_i, at.n[n]), p.m[n] = rotate(of_j, at.m[n]);
    return plain_loads(b.law, 0.0, p.D, p.n, p.m);
  };
  const PlainLimit* rules[] = {&b.shear, &b.bending, &b.torsion};
  const auto over = [&](int k) {
    const PlainLoads l = turned();
    const double load = k == 0   ? dot(l.F, e_v)
                        : k == 1 ? dot(moment(l) - shift, e_b)
                                 : sign * (dot(moment(l), at.d) - shift_t);
    const auto n = static_cast<std::size_t>(k);
    return load - rules[k]->limit - rules[k]->isotropic * (b.flow[n + 1] + x[n]) - rules[k]->kinematic * x[n];
  };
  for (int sweep = 0; sweep < 5000; ++sweep) {  // one after the other, until none changes
    double change = 0.0;
    for (int k = 0; k < 3; ++k) {
      if (rules[k]->limit == 0.0) continue;
      const auto n = static_cast<std::size_t>(k);
      const double before = x[n];
      const auto f = [&](double now) {
        x[n] = now;
        return over(k);
      };
      x[n] = root(f, b.law.c[n + 1] + rules[k]->isotropic + rules[k]->kinematic);
      change = std::max(change, std::abs(x[n] - before));
    }
    if (change < 1e-15) break;
  }
  if (x[0] + x[1] + x[2] == 0.0) return;
  turned();
  const Quatd back_i = conjugate(q_i), back_j = conjugate(q_j);
  for (int n = 0; n < 3; ++n) b.axes_i[n] = rotate(back_i, p.n[n]), b.axes_j[n] = rotate(back_j, p.m[n]);
  b.bent_2 += x[1] * dot(e_b, e_2), b.bent_3 += x[1] * dot(e_b, e_3), b.twisted += sign * x[2];
  for (std::size_t k = 0; k < 3; ++k) {
    b.lost[static_cast<Loss>(static_cast<std::size_t>(Loss::yield_shear) + k)] +=
        work_of(*rules[k], b.flow[k + 1], x[k]);
    b.flow[k + 1] += x[k];
  }
}

/// u' = creep |N|^n sign N while the length goes evenly from `before` to `now`: Runge and Kutta's method.
inline void creep_on(PlainBond& b, double before, double now, double dt) {
  if (b.creep == 0.0) return;
  const double c = b.law.c[0], N_0 = undamaged_force(b, before), N_1 = undamaged_force(b, now);
  double u = 0.0, lost = 0.0;
  const auto force = [&](double t, double flowed) { return N_0 + (N_1 - N_0) * t - c * flowed; };
  const auto speed = [&](double N) { return dt * b.creep * std::pow(std::abs(N), b.exponent - 1) * N; };
  constexpr int parts = 4;
  for (int k = 0; k < parts; ++k) {
    const double t = static_cast<double>(k) / parts, h = 1.0 / parts;
    const double k1 = speed(force(t, u)), k2 = speed(force(t + h / 2, u + h / 2 * k1)),
                 k3 = speed(force(t + h / 2, u + h / 2 * k2)), k4 = speed(force(t + h, u + h * k3));
    const double du = h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    lost += 0.5 * (force(t, u) + force(t + h, u + du)) * du;
    u += du;
  }
  b.crept += u;
  b.lost[Loss::creep] += lost;
}

inline void soften(PlainBond& b, double length) {
  if (b.N_c == 0.0) return;
  const double c = b.law.c[0], N_c = b.N_c * b.factor, u_f = b.u_f / b.factor, u = length - b.a;
  if (!(u > N_c / c)) return;
  const double N = u < u_f ? N_c * (u_f - u) / (u_f - N_c / c) : 0.0;
  b.damage = std::max(b.damage, 1.0 - N / (c * u));
}

/// All that a step of dt does, at whose end the bond stands like this and stretches at this speed.
inline void flow_on(PlainBond& b, const Vec3d& r_i, const Quatd& q_i, const Vec3d& r_j, const Quatd& q_j,
                    double speed, double dt) {
  const PlainPose p = pose_of(b, r_i, q_i, r_j, q_j);
  creep_on(b, p.length - dt * speed, p.length, dt);
  flow_along(b, p.length);
  flow_across(b, q_i, q_j, p);
  soften(b, p.length);
}

inline double utilisation_of(const PlainBond& b, const PlainPose& p, const PlainLoads& l) {
  std::array<double, 4> c = b.law.c;  // coefficients stay as a bond grows, and with them c_D a^2
  c[1] *= sq(b.law.a / b.a);
  return std::max(b.damage * (b.N_c > 0.0 ? 1.0 : 0.0),
                  plain_utilisation(b.criterion, b.limits, b.factor, c, plain_section(p.d, l.F, l.M_i, l.M_j),
                                    p.length / b.a - 1.0));
}

}  // namespace vbond::testing
