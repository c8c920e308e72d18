// The loops of a step. This file is compiled once per instruction set, with its own namespace VBOND_KERNEL,
// the number of lanes VBOND_LANES, of packs worked out together VBOND_PACKS_TOGETHER, and VBOND_HD forcing
// the physics inline. It must define nothing but that namespace's table of functions: an inline function
// emitted here would be compiled for a machine on which the rest of the program may not be running.
#include "vbond/dynamics/kernel.hpp"

#include "vbond/dynamics/bond_loops.hpp"
#include "vbond/dynamics/kernel_rows.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

// ---- particles --------------------------------------------------------------------------------------

template <bool damped>
VBOND_HD double kick_rows(RowRange rows, double h, const InverseInertia* inverse, const LoadRow* load,
                          MotionRow* motion, const LoadRow* damping, double& twice_power) {
  const Real step(h);
  Real sum[2][8 / lanes], power[2][8 / lanes];  // the sum of all loads: not finite if one of them is not
  for (std::size_t n = 0; n < 2; ++n)
    for (std::size_t part = 0; part < 8 / lanes; ++part) sum[n][part] = power[n][part] = Real(0.0);
  for (std::size_t k = rows.first; k < rows.last; k += 2)  // two at once: a shorter chain of waiting
    for (std::size_t n = 0; n < 2; ++n)
      for (std::size_t part = 0; part < 8; part += lanes) {
        const Real F = Real::load(numbers(load + k + n) + part);
        double* v = numbers(motion + k + n) + part;
        const Real per_inertia = halves_of(inverse[k + n].per_m, inverse[k + n].per_Theta, part);
        const Real before = Real::load(v), after = before + step * per_inertia * F;
        after.store(v);
        sum[n][part / lanes] = sum[n][part / lanes] + F;
        if constexpr (damped)
          power[n][part / lanes] =
              power[n][part / lanes] + Real::load(numbers(damping + k + n) + part) * (before + after);
      }
  for (std::size_t part = 0; part < 8 / lanes; ++part) {
    sum[0][part] = sum[0][part] + sum[1][part];
    power[0][part] = power[0][part] + power[1][part];
  }
  if constexpr (damped) twice_power = sum_of_row(power[0]);
  return 0.0 * sum_of_row(sum[0]);
}

double kick(RowRange rows, double h, const InverseInertia* inverse, const LoadRow* load, MotionRow* motion) {
  double none = 0.0;
  return kick_rows<false>(rows, h, inverse, load, motion, nullptr, none);
}

double kick_damped(RowRange rows, double h, const InverseInertia* inverse, const LoadRow* load,
                   MotionRow* motion, const LoadRow* damping, double& twice_power) {
  return kick_rows<true>(rows, h, inverse, load, motion, damping, twice_power);
}

/// The largest square of each component of v and omega in these rows. A NaN counts as a small number: it
/// stays one whatever is done with it.
VBOND_HD MotionRow largest_squares(RowRange rows, const MotionRow* motion) {
  Real largest[8 / lanes];  // square of each number of a row
  for (Real& x : largest) x = Real(0.0);
  for (std::size_t k = rows.first; k < rows.last; k += 2)  // two at once: a shorter chain of waiting
    for (std::size_t part = 0; part < 8; part += lanes) {
      const Real first = Real::load(numbers(motion + k) + part),
                 second = Real::load(numbers(motion + k + 1) + part);
      Real& most = largest[part / lanes];
      most = larger(most, larger(first * first, second * second));
    }
  MotionRow squares;
  for (std::size_t part = 0; part < 8; part += lanes) largest[part / lanes].store(numbers(&squares) + part);
  return squares;
}

VBOND_HD double sum_of(const Vec3d& x) {
  return x.x + x.y + x.z;
}

/// Moves G times `lanes` rows by small rotations: turns first, for they wait for one another the longest.
template <std::size_t G>
VBOND_HD void move(std::size_t k, double h, const MotionRow* motion, PoseRow* pose) {
  const Real step(h);
  Quat<Real> turn[G];
  for (std::size_t g = 0; g < G; ++g) {
    Halves omega;
    load_columns(motion + k + g * lanes, one_after_another, Half::second, omega);
    turn[g] = small_rotation(step * Vec3<Real>{omega[0], omega[1], omega[2]});
  }
  for (std::size_t g = 0; g < G; ++g) {
    PoseRow* const rows = pose + k + g * lanes;
    Halves r, v;
    load_halves(motion + k + g * lanes, one_after_another, Half::first, v);
    load_halves(rows, one_after_another, Half::first, r);
    for (std::size_t n = 0; n < 4; ++n) r[n] = r[n] + step * v[n];
    const Quat<Real> turned = renormalised(turn[g] * load_quats(rows, one_after_another));
    Halves q = {turned.w, turned.x, turned.y, turned.z};
    transpose_halves(q);
    for (std::size_t l = 0; l < lanes; ++l) store_row(r, q, l, numbers(rows + l));
  }
}

double drift(RowRange rows, double h, const MotionRow* motion, PoseRow* pose) {
  const MotionRow most = largest_squares(rows, motion);
  const double way2 = h * h * sum_of(most.v);
  if (!(h * h * sum_of(most.omega) < small_rotation_limit2)) {  // too much for small_rotation, or nearly so
    drift_by_any_angle(rows, h, motion, pose);
    return way2;
  }
  std::size_t k = rows.first;
  for (; k + lanes < rows.last; k += 2 * lanes) move<2>(k, h, motion, pose);
  for (; k < rows.last; k += lanes) move<1>(k, h, motion, pose);
  return way2;
}

double slow_down(RowRange rows, const Decay* decay, MotionRow* motion) {
  Real lost[8 / lanes];
  for (Real& e : lost) e = Real(0.0);
  for (std::size_t k = rows.first; k < rows.last; ++k)
    for (std::size_t part = 0; part < 8; part += lanes) {
      double* v = numbers(motion + k) + part;
      const Real rate = Real::load(v);
      lost[part / lanes] =
          lost[part / lanes] + halves_of(decay[k].of_v, decay[k].of_omega, part) * (rate * rate);
      (halves_of(decay[k].v, decay[k].omega, part) * rate).store(v);
    }
  return sum_of_row(lost);
}

double power(RowRange rows, const LoadRow* load, const MotionRow* motion) {
  constexpr std::size_t sums = 4;  // side by side, so that no addition waits for the one before
  Real sum[sums][8 / lanes];
  for (auto& row : sum)
    for (Real& x : row) x = Real(0.0);
  for (std::size_t k = rows.first; k < rows.last; k += sums)
    for (std::size_t n = 0; n < sums; ++n)
      for (std::size_t part = 0; part < 8; part += lanes) {
        const Real v = Real::load(numbers(motion + k + n) + part);
        sum[n][part / lanes] = sum[n][part / lanes] + Real::load(numbers(load + k + n) + part) * v;
      }
  for (std::size_t n = 1; n < sums; ++n)
    for (std::size_t part = 0; part < 8 / lanes; ++part) sum[0][part] = sum[0][part] + sum[n][part];
  return sum_of_row(sum[0]);
}

void add_rows(RowRange rows, const LoadRow* from, LoadRow* to) {
  for (std::size_t k = rows.first; k < rows.last; ++k)
    for (std::size_t part = 0; part < 8; part += lanes)
      (Real::load(numbers(to + k) + part) + Real::load(numbers(from + k) + part))
          .store(numbers(to + k) + part);
}

}  // namespace

ContactLoop add_contact_loads;  // contact_kernel.cpp
TouchLoop touch_pairs;          // touch_kernel.cpp
AddTouches add_touches;

namespace {

template <class Laws>
struct LoopsOf;
template <template <class> class... Laws>
struct LoopsOf<LawList<Laws...>> {
  static constexpr BondLoops loops[] = {loops_of_law<Laws>...};
};

}  // namespace

extern const StepKernel kernel;
const StepKernel kernel{VBOND_KERNEL_NAME, LoopsOf<BondLaws>::loops, kick,        kick_damped, drift,
                        slow_down,         add_contact_loads,        touch_pairs, add_touches, power,
                        add_rows};

}  // namespace vbond::VBOND_KERNEL
