#include "vbond/dynamics/contacts.hpp"

#include <algorithm>
#include <cmath>

#include "vbond/dynamics/parallel.hpp"

namespace vbond {

Contacts::Contacts(const Model& model, const BondIndex& index) : model_(model), index_(index) {
  if (model.contact.law == ContactLaw::none || model.particles() == 0) return;
  const double R_max = *std::max_element(model.radius.begin(), model.radius.end());
  const double skin = 0.4 * R_max;  // a fifth of the reach: rebuilds are rare, lists stay short
  list_.emplace(
      2.0 * R_max, skin, [this](ParticleId i, ParticleId j) { return model_.radius[i] + model_.radius[j]; },
      [this](ParticleId i, ParticleId j) {
        return model_.contact.pairs == ContactPairs::unbonded && index_.bonded(i, j);
      });
}

void Contacts::refresh(const State& state) {
  if (list_) list_->refresh(state.r);
}

void Contacts::bonds_changed() {
  if (list_ && model_.contact.pairs == ContactPairs::unbonded) list_->invalidate();
}

void Contacts::add_loads(const State& state, int threads, Loads& loads) const {
  if (!list_) return;
  for_each_index(state.r.size(), threads, [&](std::size_t k) {
    const ParticleId i{k};
    for (const ParticleId j : list_->of(i)) {
      const Vec3d r_ij = state.r[j] - state.r[i];
      const double reach = model_.radius[i] + model_.radius[j], distance2 = norm2(r_ij);
      if (distance2 >= sq(reach)) continue;
      const double distance = std::sqrt(distance2);
      const double f =
          contact_force(contact_law(model_.contact, model_.radius[i], model_.radius[j]), reach - distance);
      loads.F[i] -= (f / distance) * r_ij;
    }
  });
}

double Contacts::energy(const State& state) const {
  double U = 0.0;
  if (list_)
    for (const ParticleId i : state.r.ids())
      for (const ParticleId j : list_->of(i))
        if (i < j) U += contact_pair_energy(model_, state, i, j);
  return U;
}

}  // namespace vbond
