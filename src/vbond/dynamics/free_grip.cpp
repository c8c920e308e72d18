#include "vbond/dynamics/free_grip.hpp"

#include <cmath>

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
  add_lever(m, arm, theta, inertia);
  add_lever(b_translation, arm, b_rotation, drag);
}

FreeGrip::FreeGrip(const HeldDofs& held, const GripMass& mass, double half) : held_(held), mass_(mass.mass) {
  for (std::size_t k = 0; k < 3; ++k) free_[k] = !held[k];
  const int held_turns = held[3] + held[4] + held[5];
  turns_ = held_turns == 3 ? Turns::held : held_turns == 2 ? Turns::about_axis : Turns::freely;
  decay_ = std::exp(-half * mass.drag_translation / mass.mass);
  const Matrix I = of_symmetric(mass.inertia), D = of_symmetric(mass.drag);
  drag_ = mass.drag_translation, drag_of_turns_ = D;
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

double FreeGrip::drag_power(const Quatd& turn, const Vec3d& velocity, const Vec3d& omega) const {
  const Vec3d w = rotate(conjugate(turn), omega);
  return drag_ * norm2(velocity) + dot(w, times(drag_of_turns_, w));
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

double FreeGrip::slow_down(const Quatd& turn, Vec3d& velocity, Vec3d& spin) const {
  const double before = energy(turn, velocity, spin);
  velocity = decay_ * velocity;
  if (turns_ == Turns::about_axis) spin = decay_about_axis_ * spin;
  if (turns_ == Turns::freely) {
    const Vec3d omega = times(decay_of_turns_, rotate(conjugate(turn), rate(turn, spin)));
    spin = angular_momentum(inertia_.moments, turn * inertia_.axes, rotate(turn, omega));
  }
  return before - energy(turn, velocity, spin);
}

}  // namespace vbond
