#pragma once
#include <cstddef>
#include <limits>
#include <numbers>

#include "vbond/core/quat.hpp"
#include "vbond/core/scalar.hpp"
#include "vbond/physics/stiffness.hpp"

namespace vbond {

/// One number for each kind of deformation.
struct FlowLimits {
  double axial = 0, shear = 0;      ///< of a force  [force], or its growth [force/length]
  double bending = 0, torsion = 0;  ///< of a moment  [force*length], or its growth [force*length/rad]

  friend constexpr bool operator==(const FlowLimits&, const FlowLimits&) = default;
};

/// Loads at which a bond flows at once: |N|, |V|, |M_b| and |M_t| at its middle stay within limits, each for
/// itself. 0: it does not flow in this way.
struct Yield {
  FlowLimits limit;        ///< >= 0; axial: in tension
  double compression = 0;  ///< limit of -N  [force], > 0 if limit.axial is
  FlowLimits isotropic;    ///< the limit grows by this per amount of flow, >= 0
  FlowLimits kinematic;    ///< the middle between the limits moves by this times the flow, >= 0; shear: none

  bool stretches() const { return limit.axial > 0.0; }
  bool turns() const { return limit.shear > 0.0 || limit.bending > 0.0 || limit.torsion > 0.0; }
  friend constexpr bool operator==(const Yield&, const Yield&) = default;
};

/// Flow along the axis in time: u' = rate |N|^exponent, in the direction of N. Maxwell's body has exponent 1
/// and the rate 1/viscosity.
struct Creep {
  double rate = 0;           ///< [length/(time*force^exponent)], >= 0; 0: no creep
  std::size_t exponent = 1;  ///< 1 to 9

  friend constexpr bool operator==(const Creep&, const Creep&) = default;
};

/// Damage by stretching: N rises to `force`, then falls linearly, to zero at the elongation `length`. That
/// takes up force * length / 2 for good. Not together with yield or creep.
struct Softening {
  double force = 0;   ///< N_c, > 0; 0: no softening
  double length = 0;  ///< u_f = 2 G_f A/N_c, above N_c/c_A  [length]

  bool any() const { return force > 0.0; }
  friend constexpr bool operator==(const Softening&, const Softening&) = default;
};

// ---- a circular section of a perfectly plastic material ---------------------------------------------------

/// Loads at which a full circle of diameter d flows all over, each alone.
constexpr FlowLimits plastic_loads_of_circle(double d, double yield_stress, double yield_shear) {
  const double A = circle(d).A;
  return {A * yield_stress, A * yield_shear, yield_stress * d * d * d / 6.0,
          yield_shear * std::numbers::pi * d * d * d / 12.0};
}
/// Loads at which the outermost fibre of a section begins to flow, each alone; shear as if it were uniform.
constexpr FlowLimits first_yield_loads(const Section& s, double yield_stress, double yield_shear) {
  return {s.A * yield_stress, s.A * yield_shear, yield_stress * s.J / s.r, yield_shear * s.J_p / s.r};
}

// ---- what the laws are made of -----------------------------------------------------------------------

/// A rotation as tan(angle/4) times its axis (modified Rodrigues parameters): three numbers, zero for none.
/// Of the two such vectors of a rotation the shorter one, so that any angle is well represented.
template <Scalar T>
VBOND_HD Quat<T> rotation_by_quarter(const Vec3<T>& p) {
  const T one(1.0), p2 = norm2(p), s = one / (one + p2), s2 = s + s;
  return {(one - p2) * s, s2 * p.x, s2 * p.y, s2 * p.z};
}
template <Scalar T>
VBOND_HD Vec3<T> quarter_of_rotation(const Quat<T>& q) {
  const T zero(0.0), one(1.0), sign = where_greater(zero, q.w, -one, one), s = sign / (one + sign * q.w);
  return {s * q.x, s * q.y, s * q.z};
}

/// How far from its limit a load may stay, as a part of the limit, and corrections of each way of flowing for
/// itself. Two or three do unless the limit is close to the largest moment that the law has, or flow in one
/// way takes much from another.
inline constexpr double flow_tolerance = 1e-12;
inline constexpr int most_flow_corrections = 30;
/// If a load is farther off than `apart` then, all are corrected together; five do. If one is farther off
/// than `lost` even then, its flow is not a number: a run stops, and a load step is made shorter, rather than
/// go on with wrong loads. Rounding, a part of the load of elastic bonds, counts neither way.
inline constexpr double flow_apart = 1e-9, flow_lost = 1e-6, flow_rounding = 1e-12;
inline constexpr int most_joint_corrections = 10;
/// How often an elongation is corrected at which a tension that is no straight line meets one.
inline constexpr int most_meetings = 60;
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// x, or not a number where it is lost.
template <Scalar T>
VBOND_HD T known_flow(const T& x, const T& lost) {
  return where_greater(lost, T(0.0), T(not_a_number), x);
}

/// How much a channel flows in a step: x >= 0 such that the load is above its limit by f(x) = 0, where f
/// falls with x; or x = 0 if f(0) < 0. By secants, without branches: a lane that is done does not change any
/// more, whatever the others do.
template <Scalar T>
class FlowAmount {
 public:
  /// guess: how fast f falls, about; longest: the most by which x may change in a correction.
  VBOND_HD FlowAmount(const T& guess, const T& longest)
      : x(T(0.0)), guess_(guess), longest_(longest), last_x_(T(0.0)), last_f_(T(0.0)) {}

  /// By how much f(x) is off.
  VBOND_HD T off(const T& f) const {
    const T zero(0.0);
    return larger(f, where_greater(x, zero, -f, zero));
  }
  /// A better x, unless f(x) is off by no more than `within`.
  VBOND_HD void correct(const T& f, const T& within) {
    const T zero(0.0), one(1.0), off_by = off(f), dx = x - last_x_, dx2 = dx * dx;
    const T secant = (last_f_ - f) / where_greater(dx2, zero, dx, one);
    const T bounded = larger(T(0.0625) * guess_, -larger(-secant, T(-4.0) * guess_));
    const T step = f / where_greater(dx2, zero, bounded, guess_);
    last_x_ = where_greater(off_by, within, x, last_x_);
    last_f_ = where_greater(off_by, within, f, last_f_);
    go(step, f, within);
  }
  /// The same, where it is known that f falls by `slope` here.
  VBOND_HD void correct(const T& f, const T& within, const T& slope) { go(f / slope, f, within); }

  /// By how much f(x) is farther off than this part of the limit, and than rounding leaves.
  VBOND_HD T off_by_more(const T& f, const T& limit, double part) const {
    return off(f) - (T(part) * limit + T(flow_rounding) * guess_ * longest_);
  }
  VBOND_HD const T& longest() const { return longest_; }

  T x;

 private:
  VBOND_HD void go(const T& step, const T& f, const T& within) {
    const T next = larger(x - larger(-step, -longest_), T(0.0));
    x = where_greater(off(f), within, next, x);
  }

  T guess_, longest_, last_x_, last_f_;
};

/// What is dissipated by an amount x of flow: the mean of a limit, which grows by `growth` per flow, times x.
template <Scalar T>
VBOND_HD T dissipated_by(const T& limit, double growth, const T& x) {
  return (limit + T(0.5 * growth) * x) * x;
}

/// What creep does in a step by a linear law u' = g N: the elongation that is added, exact to second order
/// and without oscillation for any step. N_0: at the start of the step; N_trial: at its end if nothing
/// flowed; c: dN/du.
template <Scalar T>
VBOND_HD T crept(const T& g, const T& c, const T& N_0, const T& N_trial, const T& dt) {
  const T one(1.0), half(0.5), x = g * c * dt;
  const T mean = (N_0 * (one + half * x) + half * (N_trial - N_0) * (one + x)) / (one + x + half * sq(x));
  return dt * g * mean;
}

}  // namespace vbond
