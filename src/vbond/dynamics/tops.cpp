#include "vbond/dynamics/tops.hpp"

#include <algorithm>
#include <cmath>

namespace vbond {

Tops::Tops(const Model& model, const Order& order) {
  for (const Row k : order.particle.ids()) {
    const ParticleId p = order.particle[k];
    if (k.value < order.own && model.is_top(p))
      tops_.push_back({.row = k.value, .inertia = model.principal[p], .L = {}, .q = {}, .omega = {}});
  }
  for (const ParticleId p : model.principal.ids()) any_in_body_ = any_in_body_ || model.is_top(p);
  if (tops_.empty()) return;
  top_of_row_.assign(filled_up(order.particle.size()), 0);
  for (std::size_t k = 0; k < tops_.size(); ++k)
    top_of_row_[tops_[k].row] = static_cast<std::uint32_t>(k + 1);
}

void Tops::hold(std::size_t row, const HeldDofs& held) {
  if (!has(row)) return;
  Top& top = tops_[top_of_row_[row] - 1];
  for (std::size_t k = 0; k < 3; ++k) top.held[k] |= held[k + 3];
}

void Tops::hold(const std::vector<Support>& supports, const Order& order) {
  for (const Support& s : supports)
    for (const ParticleId p : s.particles) hold(order.row[p].value, s.held);
}

void Tops::read(const State& state, const Order& order) {
  for (Top& top : tops_) {
    const ParticleId p = order.particle[Row{top.row}];
    const Vec3d& omega = state.omega[p];
    if (!state.spin.empty()) top.L = state.spin[p];
    if (state.spin.empty() || top.omega_at(state.q[p]) != omega)
      top.L = angular_momentum(top.inertia.moments, top.principal(state.q[p]), omega);
  }
}

void Tops::write(State& state, const Order& order) const {
  if (!any_in_body_) return;  // all parts have the column
  state.spin = order.column<Vec3d>();
  for (const Top& top : tops_) {
    const ParticleId p = order.particle[Row{top.row}];
    state.spin[p] = top.turns() == Turns::freely
                        ? top.L
                        : angular_momentum(top.inertia.moments, top.principal(state.q[p]), state.omega[p]);
  }
}

template <class SomeTops, class F>
void Tops::for_each(SomeTops& tops, RowRange rows, F f) {
  if (tops.empty()) return;
  const auto before = [](const Top& t, std::size_t row) { return t.row < row; };
  for (auto t = std::lower_bound(tops.begin(), tops.end(), rows.first, before);
       t != tops.end() && t->row < rows.last; ++t)
    f(*t);
}

void Tops::kick(RowRange rows, double h, const LargeArray<LoadRow>& load, const Rows& bodies) {
  for_each(tops_, rows, [&](Top& top) {
    const Quatd& q = bodies.pose[top.row].q;
    Vec3d& omega = bodies.motion[top.row].omega;
    const Vec3d& M = load[top.row].M;
    switch (top.turns()) {
      case Turns::freely:
        top.L += h * M;
        omega = top.omega_at(q);
        break;
      case Turns::about_one_axis: {
        const Vec3d axis = top.free_axis();
        omega += h * dot(M, axis) / moment_about(top.inertia.moments, top.principal(q), axis) * axis;
        break;
      }
      case Turns::as_held: break;
    }
  });
}

double Tops::slow_down(RowRange rows, double h, double b, const Rows& bodies) {
  double lost = 0.0;
  if (b == 0.0) return lost;
  for_each(tops_, rows, [&](Top& top) {
    const Quatd& q = bodies.pose[top.row].q;
    Vec3d& omega = bodies.motion[top.row].omega;
    const Quatd principal = top.principal(q);
    const Vec3d& I = top.inertia.moments;
    const double before = rotation_energy(I, principal, omega);
    switch (top.turns()) {
      case Turns::freely: {
        const Vec3d decay{std::exp(-h * b / I.x), std::exp(-h * b / I.y), std::exp(-h * b / I.z)};
        top.L = rotate(principal, each_times(decay, rotate(conjugate(principal), top.L)));
        omega = top.omega_at(q);
        break;
      }
      case Turns::about_one_axis:
        omega = std::exp(-h * b / moment_about(I, principal, top.free_axis())) * omega;
        break;
      case Turns::as_held: omega = std::exp(-h * b / largest_of(I)) * omega; break;  // put back at once
    }
    lost += before - rotation_energy(I, principal, omega);
  });
  return lost;
}

void Tops::turn(RowRange rows, double h, const Rows& bodies) {
  for_each(tops_, rows, [&](Top& top) {
    if (top.turns() != Turns::freely) return;
    const Quatd turned = turned_freely(top.inertia.moments, top.principal(bodies.pose[top.row].q), top.L, h);
    top.q = renormalised(turned * conjugate(top.inertia.axes));
    top.omega = top.omega_at(top.q);
  });
}

void Tops::put_turned(RowRange rows, const Rows& bodies) const {
  for_each(tops_, rows, [&](const Top& top) {
    if (top.turns() != Turns::freely) return;
    bodies.pose[top.row].q = top.q;
    bodies.motion[top.row].omega = top.omega;
  });
}

void Tops::turn_about_free_axes(RowRange rows, const Rows& bodies) const {
  for_each(tops_, rows, [&](const Top& top) {
    Vec3d& omega = bodies.motion[top.row].omega;
    const Vec3d axis = top.free_axis(), about = dot(omega, axis) * axis;
    if (top.turns() != Turns::about_one_axis || omega == about) return;
    const Quatd principal = top.principal(bodies.pose[top.row].q);
    const double L = dot(angular_momentum(top.inertia.moments, principal, omega), axis);
    omega = L / moment_about(top.inertia.moments, principal, axis) * axis;
  });
}

double Tops::energy_with(std::size_t row, const PoseRow& pose, const Vec3d& omega) const {
  const Top& top = tops_[top_of_row_[row] - 1];
  return rotation_energy(top.inertia.moments, top.principal(pose.q), omega);
}

double Tops::energy(RowRange rows, Turns least, const LargeArray<PoseRow>& pose,
                    const LargeArray<MotionRow>& motion) const {
  double sum = 0.0;
  for_each(tops_, rows, [&](const Top& top) {
    if (top.turns() >= least)
      sum += rotation_energy(top.inertia.moments, top.principal(pose[top.row].q), motion[top.row].omega);
  });
  return sum;
}

}  // namespace vbond
