#pragma once
#include <cmath>
#include <cstddef>

#include "vbond/physics/soften.hpp"
#include "vbond/physics/with_flow.hpp"

/// What a step does to the memory of a flowing bond: creep, yield, damage, in this order.
namespace vbond {

/// A slope of the tension that it has nowhere surpassed on the way from rest to D, if it bends one way only:
/// the larger one of those at rest and at D.  [force/length]
template <RuledLaw Law, Scalar T>
VBOND_HD T steepest_tension(const Law& m, const T& D) {
  const T at_rest = axial_stiffness(m);
  if constexpr (tension_is_linear<typename Law::Elastic>) return at_rest;
  const T d = T(1e-6) * m.a;  // the slope to 1e-10 of N/a by rounding, to d^2 of its curvature
  return larger(at_rest, (tension(m, D + d) - tension(m, D - d)) / (d + d));
}

/// The root y^(1/n), y >= 1, n from 1 to 8: by square roots and Halley's method, without branches on y. To
/// rounding up to y = 1e50; still to some per cent at 1e300.
template <Scalar T>
VBOND_HD T root_of(T y, std::size_t n) {
  using std::sqrt;
  for (; n % 2 == 0; n /= 2) y = sqrt(y);
  if (n == 1) return y;
  T root(1.0), power = y;  // eight binary digits of 1/n
  double left = 1.0 / static_cast<double>(n);
  for (double digit = 0.5; digit > 0.003; digit *= 0.5) {
    power = sqrt(power);
    if (left >= digit) root = root * power, left -= digit;
  }
  const T less(static_cast<double>(n - 1)), more(static_cast<double>(n + 1));
  for (int k = 0; k < 4; ++k) {
    T to_n = root;
    for (std::size_t m = 1; m < n; ++m) to_n = to_n * root;
    root = root * (less * to_n + more * y) / (more * to_n + less * y);
  }
  return root;
}

/// The factor on the rate of creep with which crept() takes a bond that relaxes to where it is at the end of
/// the step. x = c dt u'/N of now, n the exponent: N falls by z = (1 + (n-1) x)^(1/(n-1)), and crept() with X
/// lets it fall by 1 + X + X^2/2. The factor is X/x, at most 1.
template <Scalar T>
VBOND_HD T slower_creep(const T& x, std::size_t exponent) {
  using std::sqrt;
  const T one(1.0);
  if (exponent == 1) return one;
  const std::size_t n = exponent - 1;
  const T of_n(static_cast<double>(n)), z = root_of(one + of_n * x, n);
  T sum = one;  // 1 + z + .. + z^(n-1) = n x/(z - 1)
  for (std::size_t k = 1; k < n; ++k) sum = one + z * sum;
  const T fall = of_n * x / sum;  // z - 1, exact also where it is small
  return T(2.0) * of_n / (sum * (one + sqrt(one + T(2.0) * fall)));
}

/// Speed of creep over N.
template <Scalar T>
VBOND_HD T creep_per_force(const Creep& rule, const T& N) {
  const T size = larger(N, -N);
  T g(rule.rate);
  for (std::size_t k = 1; k < rule.exponent; ++k) g = g * size;
  return g;
}
/// Creep along the axis. What it dissipates is the mean tension times what it adds.
template <FlowingLaw Law, Scalar T>
VBOND_HD void creep(const Law& m, const T& D, const T& D_before, const T& dt, LawHistory<Law>& h) {
  const Creep& rule = m.rules->creep;
  const T half(0.5), c = steepest_tension(m.about(rest_length<Law, T>(m, h)), D),
                     N_0 = tension(m, D_before, h), N_trial = tension(m, D, h);
  // relaxation from here passes halfway what the tension has there, and is exact where nothing is driven
  const T g = creep_per_force(rule, half * (N_0 + N_trial));
  const T u = crept(g * slower_creep(g * c * dt, rule.exponent), c, N_0, N_trial, dt);
  add_to<Law>(h, memory::crept, u);
  add_to<Law>(h, memory::dissipated, half * (N_0 + tension(m, D, h)) * u);
}

/// Flow along the axis in a step: how much, such that the tension is at its limit.
template <FlowingLaw Law, Scalar T>
class FlowAlongAxis {
 public:
  VBOND_HD FlowAlongAxis(const Law& law, const T& D, const LawHistory<Law>& h)
      : flow(T(0.0), law.a), law_(law), D_(D), rule_(law.rules->yield), a_(rest_length<Law, T>(law, h)) {
    const T zero(0.0), one(1.0);
    const double grow = rule_.isotropic.axial, back = rule_.kinematic.axial;
    shift_ = T(back) * h.value[memory::stretch];
    const T over = tension(law.about(a_), D) - shift_;
    sign_ = where_greater(over, zero, one, -one);
    limit_ = where_greater(over, zero, T(rule_.limit.axial), T(rule_.compression)) +
             T(grow) * h.value[memory::axial];
    flow = FlowAmount<T>(axial_stiffness(law) + T(grow + back), law.a);
  }
  /// By how much the tension is over its limit.
  VBOND_HD T over() const {
    return sign_ * (tension(law_.about(a_ + sign_ * flow.x), D_) - shift_) - limit_ -
           T(rule_.isotropic.axial + rule_.kinematic.axial) * flow.x;
  }
  VBOND_HD void find() {
    const T within = T(flow_tolerance) * limit_;
    for (int k = 0; k < most_flow_corrections; ++k) {
      const T f = over();
      if (!any_greater(flow.off(f), within)) return;
      if constexpr (tension_is_linear<typename Law::Elastic>)
        flow.correct(f, within);
      else  // Newton's method
        flow.correct(f, within, slope());
    }
    flow.x = known_flow(flow.x, flow.off_by_more(over(), limit_, flow_lost));
  }
  VBOND_HD void keep(LawHistory<Law>& h) const {
    add_to<Law>(h, memory::stretch, sign_ * flow.x);
    add_to<Law>(h, memory::axial, flow.x);
    add_to<Law>(h, memory::dissipated, dissipated_by(limit_, rule_.isotropic.axial, flow.x));
  }

  FlowAmount<T> flow;

 private:
  /// How fast over() falls now.
  VBOND_HD T slope() const {
    const auto about = law_.about(a_ + sign_ * flow.x);
    const T d = T(1e-6) * law_.a;
    return (tension(about, D_ + d) - tension(about, D_ - d)) / (d + d) +
           T(rule_.isotropic.axial + rule_.kinematic.axial);
  }

  const Law& law_;
  T D_;
  const Yield& rule_;
  T a_, shift_, sign_, limit_;
};

/// Shear force, bending moment and torque at the middle of a bond, without damage.
template <Scalar T>
struct MiddleLoads {
  Vec3<T> V, M_b;
  T M_t;
};
template <FlowingLaw Law, Scalar T>
VBOND_HD MiddleLoads<T> middle_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                     const FlowTurns<T>& turns) {
  const BondLoads<T> l = undamaged_loads(m, b, axis, axis.D, turns);
  const Vec3<T> M = T(0.5) * (l.M_ij - l.M_ji);
  const T M_t = dot(M, axis.d);
  return {across(l.F, axis.d), M - M_t * axis.d, M_t};
}
/// a / |a|, or nothing of nothing.
template <Scalar T>
VBOND_HD Vec3<T> direction_of(const Vec3<T>& a) {
  using std::sqrt;
  const T zero(0.0), one(1.0), size2 = norm2(a);  // where it is zero its root would have no derivative
  return (one / sqrt(where_greater(size2, zero, size2, one))) * a;
}

/// x, at right angles to `from`, turned as the shortest way turns `from` into `to`; both of length one.
/// Nothing is added where these are opposite, which no bond reaches.
template <Scalar T>
VBOND_HD Vec3<T> carried(const Vec3<T>& x, const Vec3<T>& from, const Vec3<T>& to) {
  const T tiny(1e-12), one(1.0), s = one + dot(from, to);
  return x -
         (dot(x, to) * (where_greater(s, tiny, one / where_greater(s, tiny, s, one), T(0.0)))) * (from + to);
}

/// A rotation vector of the world, in these axes, by its own angle: at 0.3 rad to 1e-8 of it, and far better
/// if smaller, so that the plastic work is moment times angle.
template <Scalar T>
VBOND_HD Quat<T> small_turn(const Axes<T>& n, const Vec3<T>& turn) {
  const Vec3<T> quarter = T(0.25) * Vec3<T>{dot(n.x, turn), dot(n.y, turn), dot(n.z, turn)};
  const T t2 = norm2(quarter);  // tan t = t (1 + t^2/3 + 2 t^4/15 + ...)
  return rotation_by_quarter((T(1.0) + t2 * (T(1.0 / 3.0) + T(2.0 / 15.0) * t2)) * quarter);
}
/// Frames turned on by s + k/2 (i) and s - k/2 (j).
template <Scalar T>
VBOND_HD FlowTurns<T> turned_on(const BondPose<T>& b, const FlowTurns<T>& turns, const Vec3<T>& k,
                                const Vec3<T>& s) {
  const T half(0.5);
  return {small_turn(frame_of_i(b), s + half * k) * turns.i,
          small_turn(frame_of_j(b), s - half * k) * turns.j};
}

/// A way of flowing across the axis: its limit, and how much it flows.
template <Scalar T>
struct FlowChannel {
  bool flows;
  double grow, all;  ///< growth of the limit per flow, and with the shift
  T limit;
  FlowAmount<T> flow;

  VBOND_HD FlowChannel(double given, double isotropic, double kinematic, const T& amount, const T& slope,
                       const T& longest)
      : flows(given > 0.0),
        grow(isotropic),
        all(isotropic + kinematic),
        limit(T(given) + T(isotropic) * amount),
        flow(slope + T(isotropic + kinematic), longest) {}
  /// By how much the load is over its limit.
  VBOND_HD T over(const T& load) const { return load - limit - T(all) * flow.x; }
  VBOND_HD bool is_off(const T& f) const {
    return flows && any_greater(flow.off(f), T(flow_tolerance) * limit);
  }
  VBOND_HD void correct(const T& f) {
    if (flows) flow.correct(f, T(flow_tolerance) * limit);
  }
  VBOND_HD T dissipated() const { return dissipated_by(limit, grow, flow.x); }
  VBOND_HD T off_by_more(const T& f, double part) const {
    return flows ? flow.off_by_more(f, limit, part) : T(0.0);
  }
};

/// Puts a turn into the memory of those that flowed, or whose flow is lost.
template <FlowingLaw Law, Scalar T>
VBOND_HD void keep_turn(LawHistory<Law>& h, std::size_t k, const T& flow, const Quat<T>& q) {
  const T least(1e-300);  // asked first, so that a flow that is not a number takes the turn as well
  const Vec3<T> turn = quarter_of_rotation(q);
  h.value[k] = where_greater(least, flow, h.value[k], turn.x);
  h.value[k + 1] = where_greater(least, flow, h.value[k + 1], turn.y);
  h.value[k + 2] = where_greater(least, flow, h.value[k + 2], turn.z);
}

/// x with J x = f, by cofactors. Of a singular J anything: what x brings has to be looked at.
template <Scalar T>
VBOND_HD void solve_three(const T (&J)[3][3], const T (&f)[3], T (&x)[3]) {
  T minor[3][3];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      minor[r][c] = J[(r + 1) % 3][(c + 1) % 3] * J[(r + 2) % 3][(c + 2) % 3] -
                    J[(r + 1) % 3][(c + 2) % 3] * J[(r + 2) % 3][(c + 1) % 3];
  const T per_det = T(1.0) / (J[0][0] * minor[0][0] + J[0][1] * minor[0][1] + J[0][2] * minor[0][2]);
  for (int c = 0; c < 3; ++c) x[c] = per_det * (minor[0][c] * f[0] + minor[1][c] * f[1] + minor[2][c] * f[2]);
}

/// Flow in bending, torsion and shear in a step, each along the direction in which its load is over its limit
/// at first: how much, such that each load is at its limit.
template <FlowingLaw Law, Scalar T>
class FlowAcrossAxis {
 public:
  VBOND_HD FlowAcrossAxis(const Law& law, const BondPose<T>& b, const BondAxis<T>& axis,
                          const LawHistory<Law>& h)
      : FlowAcrossAxis(law, b, axis, h, stiffness(law), T(0.25)) {
    const Yield& rule = law.rules->yield;
    l_ = middle_loads(law, b, axis, before_);
    // moments that kinematic hardening has shifted the limits by; bending in axes that go with both particles
    const BondPose<T> turned = turned_pose(b, axis.D * axis.d, before_);
    e_2_ = direction_of(carried(turned.n_i[1], turned.n_i[0], axis.d) +
                        carried(turned.n_j[1], -turned.n_j[0], axis.d));
    e_3_ = cross(axis.d, e_2_);
    shift_b_ = T(rule.kinematic.bending) * (h.value[memory::bent] * e_2_ + h.value[memory::bent + 1] * e_3_);
    shift_t_ = T(rule.kinematic.torsion) * h.value[memory::twisted];
    e_b_ = direction_of(l_.M_b - shift_b_), e_v_ = direction_of(l_.V);
    sign_ = where_greater(l_.M_t, shift_t_, T(1.0), T(-1.0));
  }
  VBOND_HD T bending_over() const { return bend.over(dot(l_.M_b - shift_b_, e_b_)); }
  VBOND_HD T torsion_over() const { return twist.over(sign_ * (l_.M_t - shift_t_)); }
  VBOND_HD T shear_over() const { return slide.over(dot(l_.V, e_v_)); }

  /// The loads with what flows now.
  VBOND_HD void turn() {
    now_ = turned_on(b_, before_, bend.flow.x * e_b_ + (sign_ * twist.flow.x) * axis_.d,
                     (slide.flow.x * axis_.per_D) * cross(axis_.d, e_v_));
    l_ = middle_loads(law_, b_, axis_, now_);
  }
  VBOND_HD void find() {
    for (int k = 0; k < most_flow_corrections; ++k) {
      const T f_b = bending_over(), f_t = torsion_over(), f_v = shear_over();
      if (!bend.is_off(f_b) && !twist.is_off(f_t) && !slide.is_off(f_v)) return;
      bend.correct(f_b), twist.correct(f_t), slide.correct(f_v);
      turn();
    }
    find_together();
  }
  VBOND_HD void keep(LawHistory<Law>& h) const {
    const T x_b = bend.flow.x, x_t = twist.flow.x, x_v = slide.flow.x;
    keep_turn<Law>(h, memory::turn_i, x_b + x_t + x_v, now_.i);
    keep_turn<Law>(h, memory::turn_j, x_b + x_t + x_v, now_.j);
    add_to<Law>(h, memory::bending, x_b);
    add_to<Law>(h, memory::torsion, x_t);
    add_to<Law>(h, memory::shear, x_v);
    add_to<Law>(h, memory::bent, x_b * dot(e_b_, e_2_));
    add_to<Law>(h, memory::bent + 1, x_b * dot(e_b_, e_3_));
    add_to<Law>(h, memory::twisted, sign_ * x_t);
    add_to<Law>(h, memory::dissipated, bend.dissipated() + twist.dissipated() + slide.dissipated());
  }

  FlowChannel<T> bend, twist, slide;

 private:
  VBOND_HD T off_by_more(double part) const {
    return larger(bend.off_by_more(bending_over(), part),
                  larger(twist.off_by_more(torsion_over(), part), slide.off_by_more(shear_over(), part)));
  }

  /// Newton's method for all ways of flowing at once, by differences, of those lanes that are off by more
  /// than flow_apart. A round has four evaluations: each way goes a little farther in its turn, then all are
  /// corrected. One loop for all four: turn(), which is long, is then compiled once.
  VBOND_HD void find_together() {
    constexpr double little = 1e-7;
    FlowChannel<T>* const way[3] = {&bend, &twist, &slide};
    const T zero(0.0);
    T f[3] = {bending_over(), torsion_over(), shear_over()}, J[3][3];
    T off = off_by_more(flow_apart);
    for (int n = 0; n < 4 * most_joint_corrections && any_greater(off, zero); ++n) {
      const int tried = n % 4;
      T before(0.0), farther(0.0);
      if (tried < 3) {
        before = way[tried]->flow.x, farther = T(little) * way[tried]->flow.longest();
        way[tried]->flow.x = before + farther;
      } else {
        for (int r = 0; r < 3; ++r) {  // what does not flow stays
          const T flows = way[r]->flows ? larger(way[r]->flow.x, f[r]) : zero;
          f[r] = where_greater(flows, zero, f[r], zero);
          for (int c = 0; c < 3; ++c) {
            const T alone = T(c == r ? 1.0 : 0.0);
            J[r][c] = where_greater(flows, zero, J[r][c], alone);
            J[c][r] = where_greater(flows, zero, J[c][r], alone);
          }
        }
        T back[3];
        solve_three(J, f, back);
        for (int c = 0; c < 3; ++c) {
          FlowAmount<T>& flow = way[c]->flow;
          const T bounded = larger(-flow.longest(), -larger(back[c], -flow.longest()));
          flow.x = where_greater(off, zero, larger(flow.x + bounded, zero), flow.x);
        }
      }
      turn();
      const T g[3] = {bending_over(), torsion_over(), shear_over()};
      if (tried < 3) {
        for (int r = 0; r < 3; ++r) J[r][tried] = (g[r] - f[r]) / farther;
        way[tried]->flow.x = before;
      } else {
        for (int r = 0; r < 3; ++r) f[r] = g[r];
        off = off_by_more(flow_apart);
      }
    }
    const T lost = off_by_more(flow_lost);
    for (FlowChannel<T>* w : way) w->flow.x = known_flow(w->flow.x, lost);
    turn();
  }

  /// quarter: the most by which a turn changes in a correction  [rad]
  VBOND_HD FlowAcrossAxis(const Law& law, const BondPose<T>& b, const BondAxis<T>& axis,
                          const LawHistory<Law>& h, const BondStiffness<T>& c, const T& quarter)
      : bend(law.rules->yield.limit.bending, law.rules->yield.isotropic.bending,
             law.rules->yield.kinematic.bending, h.value[memory::bending], c.c_B, quarter),
        twist(law.rules->yield.limit.torsion, law.rules->yield.isotropic.torsion,
              law.rules->yield.kinematic.torsion, h.value[memory::torsion], c.c_T, quarter),
        slide(law.rules->yield.limit.shear, law.rules->yield.isotropic.shear, 0.0, h.value[memory::shear],
              c.c_D, quarter * axis.D),
        law_(law),
        b_(b),
        axis_(axis),
        before_(turns_of<Law>(h)),
        now_(before_) {}

  const Law& law_;
  const BondPose<T>& b_;
  const BondAxis<T>& axis_;
  FlowTurns<T> before_, now_;
  MiddleLoads<T> l_;
  Vec3<T> e_2_, e_3_, shift_b_, e_b_, e_v_;
  T shift_t_, sign_;
};

template <FlowingLaw Law, Scalar T>
VBOND_HD LawHistory<Law> advance(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const BondRates<T>& rates, const T& dt, const LawHistory<Law>& before) {
  LawHistory<Law> h = before;
  const BondRules& rules = *m.rules;
  if (rules.creep.rate > 0.0)
    creep(m, axis.D, axis.D - dt * section_rates(b, m.R_i, m.R_j, axis, rates).v_n, dt, h);
  if (rules.yield.stretches()) {
    FlowAlongAxis<Law, T> flow(m, axis.D, h);
    flow.find();
    flow.keep(h);
  }
  if (rules.yield.turns()) {
    FlowAcrossAxis<Law, T> flow(m, b, axis, h);
    flow.find();
    flow.keep(h);
  }
  if (rules.softening.any()) soften(m, b, axis, rates, dt, h);
  return h;
}

}  // namespace vbond
