#pragma once
#include <cmath>
#include <numbers>

#include "vbond/core/scalar.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/physics/hertz.hpp"
#include "vbond/physics/touch_forms.hpp"

// What two bodies that touch do to each other: normal force with damping and adhesion, friction, resistance
// to rolling and twisting. Formulas and sources: docs/contacts.md.
namespace vbond {

/// Radius a of the contact and normal force of an overlap, repulsion positive.
template <Scalar T>
struct NormalForce {
  T a, F;
  T secant;  ///< F/d of the repulsion alone, by which damping goes  [force/length]
};

/// a of JKR: a^2/R - sqrt(2 pi w a/E*) = d, the larger root, down to the least d that has one. Newton's
/// method for sqrt(a), from above: it falls monotonically.
template <Scalar T>
VBOND_HD T jkr_radius(const T& E, const T& w, const T& R, const T& d) {
  using std::sqrt;
  const T c = sqrt(T(2.0 * std::numbers::pi) * w / E), zero(0.0);
  // s^4/R - c s = d is exceeded at a^2 = 2 R max(d, 0) + (2 c^2 R^2)^(2/3)-like bounds; this one is safe:
  const T a_0 = sqrt(T(2.0) * R * larger(d, zero));
  const T a_w = sqrt(sqrt(T(4.0) * R * R * c * c * (a_0 + R)));
  T s = sqrt(a_0 + a_w);
  for (int k = 0; k < 40; ++k) {
    const T s3 = s * s * s;
    const T slope = T(4.0) * s3 / R - c, value = s3 * s / R - c * s - d;
    s = where_greater(slope, zero, s - larger(value, zero) / where_greater(slope, zero, slope, T(1.0)), s);
  }
  return s * s;
}

namespace detail {

/// 1/x, or 0 for x = 0.
template <Scalar T>
VBOND_HD T inverse(const T& x) {
  const T zero(0.0);
  return where_greater(x, zero, T(1.0) / where_greater(x, zero, x, T(1.0)), zero);
}

}  // namespace detail

/// How far apart, beyond d = 0, JKR still holds bodies together that have touched: until d' = 0, at
/// a^3 = pi w R^2/(8 E*), where d = -3 a^2/R.  [length]
inline double reach_of_adhesion(double E, double w, double R) {
  return 3.0 * sq(std::cbrt(0.125 * std::numbers::pi * w * sq(R) / E)) / R;
}

template <Scalar T>
VBOND_HD NormalForce<T> normal_force(const TouchForms& f, const TouchNumbers<T>& c, const T& R, const T& d) {
  using std::sqrt;
  const T positive = larger(d, T(0.0));
  if (f.normal == NormalForm::linear) return {T(1.0), c.stiffness * d, c.stiffness};
  if (f.normal == NormalForm::one_hertz) {
    const HertzContact<T> h{c.stiffness};
    return {sqrt(R) * sqrt(positive), contact_force(h, positive), contact_secant(h, positive)};
  }
  if (f.adhesion == AdhesionForm::jkr) {
    const T a = jkr_radius(c.stiffness, c.work, R, d), a3 = a * a * a;
    return {a,
            T(4.0 / 3.0) * c.stiffness * a3 / R - sqrt(T(8.0 * std::numbers::pi) * c.work * c.stiffness * a3),
            hertz_secant(c.stiffness, a)};
  }
  const T a = sqrt(R * positive), secant = hertz_secant(c.stiffness, a);
  T F = secant * positive;
  if (f.adhesion == AdhesionForm::dmt) F = F - T(2.0 * std::numbers::pi) * c.work * R;
  return {a, F, secant};
}

/// Energy of the normal force, zero for bodies that do not touch.
template <Scalar T>
VBOND_HD T normal_energy(const TouchForms& f, const TouchNumbers<T>& c, const T& R, const T& d) {
  const NormalForce<T> n = normal_force(f, c, R, d);
  if (f.normal == NormalForm::linear) return T(0.5) * n.F * d;
  if (f.adhesion == AdhesionForm::jkr) {  // K a^5/(15 R^2) + F^2/(3 K a) - pi w a^2, K = 4/3 E*
    const T a2 = n.a * n.a, K = T(4.0 / 3.0) * c.stiffness;
    return K * a2 * a2 * n.a / (T(15.0) * R * R) + n.F * n.F * detail::inverse(T(3.0) * K * n.a) -
           T(std::numbers::pi) * c.work * a2;
  }
  T U = energy_of_secant(n.secant, d);
  if (f.adhesion == AdhesionForm::dmt) U = U - T(2.0 * std::numbers::pi) * c.work * R * d;
  return U;
}

/// Stiffness of slip of a contact of radius a.  [force/length]
template <Scalar T>
VBOND_HD T tangential_stiffness(const TouchForms& f, const TouchNumbers<T>& c, const T& a) {
  return is_mindlin(f.tangential) ? c.tangential * a : c.tangential;
}

namespace detail {

/// By what a vector of this size is multiplied so that it is not larger than the limit.
template <Scalar T>
VBOND_HD T scale_to(const T& size, const T& limit) {
  if (!any_greater(size, limit)) return T(1.0);
  return where_greater(size, limit, limit * inverse(size), T(1.0));
}

/// x at right angles to n, as long as before: what turns with the contact.
template <Scalar T>
VBOND_HD Vec3<T> turned_with(const Vec3<T>& x, const Vec3<T>& n, const T& spin) {
  using std::sqrt;
  const Vec3<T> y = across(x + spin * cross(n, x), n);
  return sqrt(norm2(x) * inverse(norm2(y))) * y;
}

}  // namespace detail

/// Energy that slip has stored, and what rolling and twisting have.
template <Scalar T>
VBOND_HD T slip_energy(const TouchForms& f, const TouchNumbers<T>& c, const TouchHistory<T>& h) {
  if (f.tangential == TangentialForm::none) return T(0.0);
  return T(0.5) * norm2(h.F_t) * detail::inverse(tangential_stiffness(f, c, h.a));
}
template <Scalar T>
VBOND_HD T rolling_energy(const TouchForms& f, const TouchHistory<T>& h) {
  if (f.rolling != RollingForm::spring) return T(0.0);
  return T(0.5) * (norm2(h.M_r) + sq(h.M_t)) * detail::inverse(h.k_r);
}
template <Scalar T>
VBOND_HD T history_energy(const TouchForms& f, const TouchNumbers<T>& c, const TouchHistory<T>& h) {
  return slip_energy(f, c, h) + rolling_energy(f, h);
}

/// What friction goes by: the force that presses the bodies together, without what adhesion takes from it.
template <Scalar T>
VBOND_HD T pressing_force(const TouchForms& f, const TouchNumbers<T>& c, const T& R, const T& elastic,
                          const T& damped) {
  const T zero(0.0), pull = T(std::numbers::pi) * c.work * R;
  if (f.adhesion == AdhesionForm::jkr)
    return larger(elastic + T(3.0) * pull, zero);  // twice the pull-off force
  if (f.adhesion == AdhesionForm::dmt) return larger(elastic + T(2.0) * pull, zero);
  return larger(damped, zero);
}

namespace detail {

/// What is left of the force across the contact when its stiffness has changed.
template <Scalar T>
VBOND_HD T left_of_slip(TangentialForm form, const T& k_before, const T& k) {
  const T one(1.0);
  if (form == TangentialForm::mindlin_force) return one;
  const T with_stiffness = k * inverse(k_before);
  if (form == TangentialForm::mindlin_displacement) return with_stiffness;
  return where_greater(k_before, k, with_stiffness, one);
}

}  // namespace detail

/// What friction does in a step: its elastic and its damping part on i, and what it takes.
template <Scalar T>
struct Slip {
  Vec3<T> F_t, F_d;  ///< [force]
  T lost;            ///< [energy]
};

/// Slip over u = v_t dt: the force of a spring that turns with the contact, falls with its stiffness and
/// slides at the limit, and damping as long as it sticks. F_n: the damping part of the normal force.
template <Scalar T>
VBOND_HD Slip<T> slip(const TouchForms& f, const TouchNumbers<T>& c, const Vec3<T>& n, const Vec3<T>& v_t,
                      const T& c_n, const Vec3<T>& F_n, const T& limit, const T& spin, const T& dt,
                      const T& a, const TouchHistory<T>& before) {
  const T half(0.5), one(1.0), zero(0.0);
  const Vec3<T> u = dt * v_t;
  const T k_t = tangential_stiffness(f, c, a), k_before = tangential_stiffness(f, c, before.a);
  const Vec3<T> turned = detail::turned_with(before.F_t, n, spin);
  const Vec3<T> trial = detail::left_of_slip(f.tangential, k_before, k_t) * turned + k_t * u;
  const T size = norm(trial);
  const Vec3<T> F_t = where_greater(dt, zero, detail::scale_to(size, limit), one) * trial;
  const Vec3<T> damped = F_t + (c.tangential_damping * c_n) * v_t;
  const Vec3<T> sticking = detail::scale_to(norm(damped), limit) * damped - F_t;
  return {F_t, F_n + where_greater(size, limit, zero, one) * sticking,
          half * dot(turned + F_t, u) +
              half * (norm2(before.F_t) * detail::inverse(k_before) - norm2(F_t) * detail::inverse(k_t))};
}

/// What resistance to rolling and twisting does in a step, and what it takes.
template <Scalar T>
struct Rolling {
  Vec3<T> M_r;  ///< on i  [force*length]
  T M_t;        ///< on i, about n  [force*length]
  T k_r;        ///< [force*length]
  T lost;       ///< [energy]
};

/// Rolling at w = w_j - w_i: moments against its parts across the normal and along it.
template <Scalar T>
VBOND_HD Rolling<T> roll(const TouchForms& f, const TouchNumbers<T>& c, const Touching<T>& p,
                         const T& pressing, const T& spin, const T& dt, const T& a,
                         const TouchHistory<T>& before) {
  const T half(0.5), one(1.0), zero(0.0);
  const Vec3<T> w = p.w_j - p.w_i;
  const T w_n = dot(w, p.n), limit_r = c.rolling * p.R * pressing, limit_t = c.twisting * p.R * pressing;
  const Vec3<T> rolling = across(w, p.n);
  if (f.rolling == RollingForm::constant) {
    const T stop = p.Theta / where_greater(dt, zero, dt, one);  // per angular velocity: stops within the step
    const Vec3<T> M = detail::scale_to(stop * norm(rolling), limit_r) * (stop * rolling);
    const T M_n = stop * w_n, M_t = detail::scale_to(larger(M_n, -M_n), limit_t) * M_n;
    const auto in_step = [&](const T& now, const T& then) { return where_greater(dt, zero, now, then); };
    const Vec3<T> M_r{in_step(M.x, before.M_r.x), in_step(M.y, before.M_r.y), in_step(M.z, before.M_r.z)};
    const T twist = in_step(M_t, before.M_t);
    return {M_r, twist, zero, half * dt * (dot(before.M_r + M_r, rolling) + (before.M_t + twist) * w_n)};
  }
  const T k_r =
      where_greater(c.rolling_stiffness, zero, c.rolling_stiffness, tangential_stiffness(f, c, a) * sq(p.R));
  const T relief = where_greater(before.k_r, k_r, k_r * detail::inverse(before.k_r), one);
  const Vec3<T> turned = detail::turned_with(before.M_r, p.n, spin);
  const Vec3<T> trial = relief * turned + (k_r * dt) * rolling;
  const Vec3<T> M_r = where_greater(dt, zero, detail::scale_to(norm(trial), limit_r), one) * trial;
  const T twist = relief * before.M_t + k_r * dt * w_n;
  const T M_t = where_greater(dt, zero, detail::scale_to(larger(twist, -twist), limit_t), one) * twist;
  return {M_r, M_t, k_r,
          half * dt * (dot(turned + M_r, rolling) + (before.M_t + M_t) * w_n) +
              half * ((norm2(before.M_r) + sq(before.M_t)) * detail::inverse(before.k_r) -
                      (norm2(M_r) + sq(M_t)) * detail::inverse(k_r))};
}

/// One step of a contact: from what the bodies remember of the step before, and their motion of the half step
/// between, to the loads now and what is to be remembered. dt = 0: the loads as the bodies stand; nothing
/// slides, so that nothing is lost. The history's forces turn with the contact: with its normal, and by the
/// mean spin about it. Nothing a contact does makes energy (tests), but for forms that can_make_energy().
template <Scalar T>
VBOND_HD TouchLoads<T> touch(const TouchForms& f, const TouchNumbers<T>& c, const Touching<T>& p, const T& dt,
                             const TouchHistory<T>& before) {
  using std::sqrt;
  const T zero(0.0), half(0.5);
  const Vec3<T> nothing{zero, zero, zero};
  const NormalForce<T> N = normal_force(f, c, p.R, p.overlap);
  const T v_n = dot(p.v, p.n), c_n = c.viscous + c.damping * sqrt(p.m * N.secant);
  T F_n = N.F - c_n * v_n;
  if (!f.attraction && f.adhesion == AdhesionForm::none) F_n = larger(F_n, zero);
  const T pressing = pressing_force(f, c, p.R, N.F, F_n);

  const Vec3<T> v = p.v - cross(p.l_i * p.w_i + p.l_j * p.w_j, p.n);  // of j's surface against i's
  const T spin = half * dt * dot(p.w_i + p.w_j, p.n);
  const Vec3<T> damped = (N.F - F_n) * p.n;
  const Slip<T> s = f.tangential == TangentialForm::none ? Slip<T>{nothing, damped, zero}
                                                         : slip(f, c, p.n, across(v, p.n), c_n, damped,
                                                                c.friction * pressing, spin, dt, N.a, before);
  const Rolling<T> r = f.rolling == RollingForm::none ? Rolling<T>{nothing, zero, zero, zero}
                                                      : roll(f, c, p, pressing, spin, dt, N.a, before);
  T adhesion = zero;
  if (f.adhesion != AdhesionForm::none) {  // what surfaces gain as they meet does not come back
    const T gained = normal_energy(f, c, p.R, p.overlap) + half * N.F * v_n * dt;
    adhesion = where_greater(before.a, zero, zero, larger(-gained, zero));  // what is made is no loss below 0
  }
  return {s.F_t + s.F_d - N.F * p.n,
          r.M_r + r.M_t * p.n,
          {s.F_t, N.a, s.F_d, r.k_r, r.M_r, r.M_t},
          {half * dt * dot(before.F_d + s.F_d, v), s.lost, r.lost, adhesion}};
}

/// The least restitution that damping_of_restitution() takes: what is stiffer damped hardly moves any more.
inline constexpr double least_restitution = 0.01;

/// The damping g of c_n = g sqrt(m* F/d) that gives a head-on impact the restitution e, least_restitution <=
/// e <= 1, exactly and at every speed. With attraction: g = -f ln e / sqrt(pi^2 + ln^2 e), f = 2 for the
/// linear form and sqrt 5 for Hertz's (Antypov & Elliott 2011). Without it contact ends when its force is
/// zero, at t_c = (pi - atan2(2 b w, 1 - 2 b^2))/w, w = sqrt(1 - b^2), and e = exp(-b t_c) (Schwager &
/// Poeschel 2007), for both forms at the same ratio b = g/f.
inline double damping_of_restitution(NormalForm form, bool attraction, double e) {
  const double factor = form == NormalForm::linear ? 2.0 : std::sqrt(5.0);
  if (e >= 1.0) return 0.0;
  const double log_e = std::log(e);
  const double with_attraction = -log_e / std::hypot(std::numbers::pi, log_e);
  if (attraction) return factor * with_attraction;
  const auto log_of = [](double b) {  // -b t_c
    if (b < 1.0) {
      const double w = std::sqrt(1.0 - b * b);
      return -b * (std::numbers::pi - std::atan2(2.0 * b * w, 1.0 - 2.0 * b * b)) / w;
    }
    const double w = std::sqrt(b * b - 1.0);
    return w == 0.0 ? -2.0 : -b * std::log((b + w) / (b - w)) / w;
  };
  double low = 0.0, high = 1.0;
  while (log_of(high) > log_e) high *= 2.0;
  for (int k = 0; k < 200 && low < high; ++k) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (log_of(middle) > log_e ? low : high) = middle;
  }
  return factor * 0.5 * (low + high);
}

/// 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2.  [force/area]
constexpr double effective_modulus(double E_1, double nu_1, double E_2, double nu_2) {
  return 1.0 / ((1.0 - nu_1 * nu_1) / E_1 + (1.0 - nu_2 * nu_2) / E_2);
}
/// 8 G*, 1/G* = (2 - nu_1)/G_1 + (2 - nu_2)/G_2, G = E/(2 (1 + nu)).  [force/area]
constexpr double mindlin_modulus(double E_1, double nu_1, double E_2, double nu_2) {
  return 8.0 / ((2.0 - nu_1) * 2.0 * (1.0 + nu_1) / E_1 + (2.0 - nu_2) * 2.0 * (1.0 + nu_2) / E_2);
}

}  // namespace vbond
