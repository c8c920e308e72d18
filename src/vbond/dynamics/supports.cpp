#include "vbond/dynamics/supports.hpp"

#include "vbond/dynamics/parallel.hpp"

namespace vbond {
namespace {

/// Calls f(rate, inertia, load, prescribed) for every held degree of freedom of the stage: rate is the
/// velocity or angular velocity component, which f may change; prescribed is at factor 1.
template <class F>
void for_each_held(const Model& model, const Support& s, const Loads* loads, State& state, F f) {
  for (const ParticleId p : s.particles)
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      if (s.held[axis])
        f(component(state.v[p], k), model.mass[p], loads ? component(loads->F[p], k) : 0.0,
          component(s.velocity, k));
      if (s.held[axis + 3])
        f(component(state.omega[p], k), model.inertia[p], loads ? component(loads->M[p], k) : 0.0,
          component(s.angular_velocity, k));
    }
}

}  // namespace

void hold_velocities(const Model& model, const Stage& stage, double t, State& state) {
  for (const Support& s : stage.supports) {
    const double factor = s.factor(t);
    for_each_held(model, s, nullptr, state, [&](double& rate, double m, double, double prescribed) {
      const double given = factor * prescribed;
      state.books.work_supports += 0.5 * m * (given * given - rate * rate);
      rate = given;
    });
  }
}

void hold_velocities_after_kick(const Model& model, const Stage& stage, const Loads& loads, double t,
                                double h, State& state) {
  for (const Support& s : stage.supports) {
    const double before = s.factor(t), after = s.factor(t + h);
    for_each_held(model, s, &loads, state, [&](double& rate, double m, double load, double prescribed) {
      const double impulse = m * (after - before) * prescribed - h * load;
      state.books.work_supports += impulse * 0.5 * (before + after) * prescribed;
      rate = after * prescribed;
    });
  }
}

void add_applied_loads(const Model& model, const Stage& stage, double t, Loads& loads) {
  for (const PointLoad& l : stage.loads) {
    const double factor = l.factor(t);
    for (const ParticleId p : l.particles) {
      loads.F[p] += factor * l.force;
      loads.M[p] += factor * l.moment;
    }
  }
  if (stage.gravity == Vec3d{}) return;
  for (const ParticleId p : loads.F.ids()) loads.F[p] += model.mass[p] * stage.gravity;
}

void book_applied_work(const Model& model, const Stage& stage, double t, double h, int threads,
                       State& state) {
  double& work = state.books.work_loads;
  for (const PointLoad& l : stage.loads) {
    const double mean = 0.5 * (l.factor(t) + l.factor(t + h));
    for (const ParticleId p : l.particles)
      work += mean * h * (dot(l.force, state.v[p]) + dot(l.moment, state.omega[p]));
  }
  if (stage.gravity == Vec3d{}) return;
  work += h * sum_over(state.v.size(), threads, [&](std::size_t k) {
            const ParticleId p{k};
            return model.mass[p] * dot(stage.gravity, state.v[p]);
          });
}

}  // namespace vbond
