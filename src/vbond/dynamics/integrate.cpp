#include "vbond/dynamics/integrate.hpp"

#include "vbond/dynamics/parallel.hpp"

namespace vbond {

void kick(const Model& model, const Loads& loads, double h, int threads, State& state) {
  for_each_index(state.r.size(), threads, [&](std::size_t k) {
    const ParticleId p{k};
    state.v[p] += (h / model.mass[p]) * loads.F[p];
    state.omega[p] += (h / model.inertia[p]) * loads.M[p];
  });
}

void drift(double h, int threads, State& state) {
  for_each_index(state.r.size(), threads, [&](std::size_t k) {
    const ParticleId p{k};
    state.r[p] += h * state.v[p];
    state.q[p] = normalised(rotation_of(h * state.omega[p]) * state.q[p]);
  });
}

}  // namespace vbond
