#include "vbond/dynamics/free_grip.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vbond {
namespace {

using Matrix = std::array<Vec3d, 3>;  // rows

Matrix of_symmetric(const std::array<double, 6>& s) {
  return {Vec3d{s[0], s[3], s[4]}, Vec3d{s[3], s[1], s[5]}, Vec3d{s[4], s[5], s[2]}};
}
Matrix sum(const Matrix& a, double factor, const Matrix& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
Vec3d times(const Matrix& a, const Vec3d& x) {
  return {dot(a[0], x), dot(a[1], x), dot(a[2], x)};
}
/// a^-1 b by Cramer's rule.
Matrix solved(const Matrix& a, const Matrix& b) {
  const double det = dot(a[0], cross(a[1], a[2]));
  // columns of the inverse are cross products of rows
  const Vec3d c[3] = {cross(a[1], a[2]) / det, cross(a[2], a[0]) / det, cross(a[0], a[1]) / det};
  Matrix x;
  for (int k = 0; k < 3; ++k)
    x[static_cast<std::size_t>(k)] =
        component(c[0], k) * b[0] + component(c[1], k) * b[1] + component(c[2], k) * b[2];
  return x;
}

/// Degrees of freedom of a grip at most; one more for what drives them.
constexpr std::size_t free_most = 6;
using FreeColumn = std::array<double, free_most + 1>;
using FreeSquare = std::array<FreeColumn, free_most + 1>;

FreeSquare product(const FreeSquare& a, const FreeSquare& b) {
  FreeSquare c{};
  for (std::size_t i = 0; i <= free_most; ++i)
    for (std::size_t k = 0; k <= free_most; ++k)
      for (std::size_t j = 0; j <= free_most; ++j) c[i][j] += a[i][k] * b[k][j];
  return c;
}

/// By scaling and squaring of the Taylor series.
FreeSquare exponential_of(FreeSquare a) {
  double size = 0.0;
  for (const FreeColumn& row : a) {
    double sum = 0.0;
    for (const double x : row) sum += std::abs(x);
    size = std::max(size, sum);
  }
  int halved = 0;
  for (; size > 0.5; size *= 0.5) ++halved;
  for (FreeColumn& row : a)
    for (double& x : row) x = std::ldexp(x, -halved);
  FreeSquare power{}, sum{};
  for (std::size_t k = 0; k <= free_most; ++k) power[k][k] = sum[k][k] = 1.0;
  for (int n = 1; n <= 14; ++n) {  // 0.5^15 / 15! is below rounding
    power = product(power, a);
    for (std::size_t i = 0; i <= free_most; ++i)
      for (std::size_t j = 0; j <= free_most; ++j) sum[i][j] += (power[i][j] /= n);
  }
  for (; halved > 0; --halved) sum = product(sum, sum);
  return sum;
}

void add_lever(double weight, const Vec3d& a, double own, std::array<double, 6>& to) {
  const double a2 = norm2(a);
  to[0] += weight * (a2 - a.x * a.x) + own, to[1] += weight * (a2 - a.y * a.y) + own;
  to[2] += weight * (a2 - a.z * a.z) + own;
  to[3] -= weight * a.x * a.y, to[4] -= weight * a.x * a.z, to[5] -= weight * a.y * a.z;
}

}  // namespace

void GripMass::add(const Vec3d& arm, double m, double theta, double b_translation, double b_rotation) {
  mass += m;
  drag_translation += b_translation;
  drag_lever += b_translation * arm;
  add_lever(m, arm, theta, inertia);
  add_lever(b_translation, arm, b_rotation, drag);
}

FreeGrip::FreeGrip(const HeldDofs& held, const GripMass& mass, double half)
    : held_(held), mass_(mass.mass), half_(half), drag_lever_(mass.drag_lever) {
  for (std::size_t k = 0; k < 3; ++k) free_[k] = !held[k];
  const int held_turns = held[3] + held[4] + held[5];
  turns_ = held_turns == 3 ? Turns::held : held_turns == 2 ? Turns::about_axis : Turns::freely;
  decay_ = std::exp(-half * mass.drag_translation / mass.mass);
  const Matrix I = of_symmetric(mass.inertia), D = of_symmetric(mass.drag);
  drag_ = mass.drag_translation, drag_of_turns_ = D;
  const double largest2 = drag_ * (D[0].x + D[1].y + D[2].z);  // of a lever, squared
  coupled_ = norm2(drag_lever_) > sq(1e-12) * largest2;        // beyond rounding
  inertia_ = principal_inertia({mass.inertia[0], mass.inertia[1], mass.inertia[2], mass.inertia[3],
                                mass.inertia[4], mass.inertia[5]})
                 .value();
  if (turns_ == Turns::about_axis) {
    about_axis_ = dot(axis(), times(I, axis()));
    decay_about_axis_ = std::exp(-half * dot(axis(), times(D, axis())) / about_axis_);
  }
  // the implicit midpoint rule: I (omega' - omega) = -half D (omega + omega')/2
  decay_of_turns_ = solved(sum(I, 0.5 * half, D), sum(I, -0.5 * half, D));
}

GripRates FreeGrip::drag_of(const Quatd& turn, const GripRates& rates) const {
  const Vec3d lever = rotate(turn, drag_lever_);
  const Vec3d of_turn = rotate(turn, times(drag_of_turns_, rotate(conjugate(turn), rates.omega)));
  return {drag_ * rates.v + cross(rates.omega, lever), cross(lever, rates.v) + of_turn};
}

Vec3d FreeGrip::axis() const {
  return {held_[3] ? 0.0 : 1.0, held_[4] ? 0.0 : 1.0, held_[5] ? 0.0 : 1.0};
}

Vec3d FreeGrip::free_part(const Vec3d& v) const {
  return {free_[0] ? v.x : 0.0, free_[1] ? v.y : 0.0, free_[2] ? v.z : 0.0};
}

Vec3d FreeGrip::free_turn(const Vec3d& v) const {
  if (turns_ == Turns::held) return {};
  return turns_ == Turns::freely ? v : dot(v, axis()) * axis();
}

Vec3d FreeGrip::rate(const Quatd& turn, const Vec3d& spin) const {
  switch (turns_) {
    case Turns::held: break;
    case Turns::about_axis: return spin / about_axis_;
    case Turns::freely: return angular_velocity(inertia_.moments, turn * inertia_.axes, spin);
  }
  return {};
}

Quatd FreeGrip::turned(const Quatd& turn, const Vec3d& spin, double time) const {
  switch (turns_) {
    case Turns::held: break;
    case Turns::about_axis: return renormalised(rotation_of(time / about_axis_ * spin) * turn);
    case Turns::freely:
      return renormalised(turned_freely(inertia_.moments, turn * inertia_.axes, spin, time) *
                          conjugate(inertia_.axes));
  }
  return turn;
}

double FreeGrip::energy(const Quatd& turn, const Vec3d& velocity, const Vec3d& spin) const {
  return 0.5 * mass_ * norm2(velocity) + 0.5 * dot(spin, rate(turn, spin));
}

GripDrag FreeGrip::slow_down(const Quatd& turn, const GripRates& prescribed, Vec3d& velocity,
                             Vec3d& spin) const {
  if (coupled_) return slow_down_coupled(turn, prescribed, velocity, spin);
  const double before = energy(turn, velocity, spin);
  velocity = decay_ * velocity;
  if (turns_ == Turns::about_axis) spin = decay_about_axis_ * spin;
  if (turns_ == Turns::freely) {
    const Vec3d omega = times(decay_of_turns_, rotate(conjugate(turn), rate(turn, spin)));
    spin = angular_momentum(inertia_.moments, turn * inertia_.axes, rotate(turn, omega));
  }
  const GripRates drag = drag_of(turn, prescribed);
  return {before - energy(turn, velocity, spin),
          half_ * (dot(drag.v, prescribed.v) + dot(drag.omega, prescribed.omega))};
}

/// Free rates u along directions with a mass each, m u' = -C (u + prescribed): with 1 as a last unknown that
/// is a linear system, whose exponential is exact.
GripDrag FreeGrip::slow_down_coupled(const Quatd& turn, const GripRates& prescribed, Vec3d& velocity,
                                     Vec3d& spin) const {
  struct Direction {
    GripRates along;
    double mass;
  };
  std::array<Direction, free_most> directions;
  std::size_t n = 0;
  const auto unit = [](int k) {
    Vec3d e;
    component(e, k) = 1.0;
    return e;
  };
  for (int k = 0; k < 3; ++k)
    if (free_[static_cast<std::size_t>(k)]) directions[n++] = {{unit(k), {}}, mass_};
  if (turns_ == Turns::about_axis) directions[n++] = {{{}, axis()}, about_axis_};
  if (turns_ == Turns::freely)
    for (int k = 0; k < 3; ++k)
      directions[n++] = {{{}, rotate(turn * inertia_.axes, unit(k))}, component(inertia_.moments, k)};

  const auto along = [](const GripRates& a, const GripRates& b) {
    return dot(a.v, b.v) + dot(a.omega, b.omega);
  };
  const GripRates now{velocity, rate(turn, spin)};
  const GripRates against = drag_of(turn, prescribed);
  FreeSquare rate_of_change{};
  FreeColumn u{};
  for (std::size_t k = 0; k < n; ++k) {
    const Direction& d = directions[k];
    for (std::size_t j = 0; j < n; ++j)
      rate_of_change[k][j] = -half_ / d.mass * along(d.along, drag_of(turn, directions[j].along));
    rate_of_change[k][free_most] = -half_ / d.mass * along(d.along, against);
    u[k] = along(d.along, now);
  }
  u[free_most] = 1.0;
  const FreeSquare exponential = exponential_of(rate_of_change);
  GripRates then;
  double lost = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    double x = 0.0;
    for (std::size_t j = 0; j <= free_most; ++j) x += exponential[k][j] * u[j];
    then.v += x * directions[k].along.v, then.omega += x * directions[k].along.omega;
    lost += 0.5 * directions[k].mass * (u[k] - x) * (u[k] + x);
  }
  velocity = then.v;
  if (turns_ == Turns::about_axis) spin = about_axis_ * then.omega;
  if (turns_ == Turns::freely) spin = angular_momentum(inertia_.moments, turn * inertia_.axes, then.omega);
  const GripRates mean = drag_of(
      turn, {prescribed.v + 0.5 * (now.v + then.v), prescribed.omega + 0.5 * (now.omega + then.omega)});
  return {lost, half_ * along(mean, prescribed)};
}

}  // namespace vbond
