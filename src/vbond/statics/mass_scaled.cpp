#include "vbond/statics/detail/mass_scaled.hpp"

#include <cmath>

namespace vbond {

Vector roots_of_mass(const Model& model, const Unknowns& unknowns) {
  Vector roots(unknowns.size());
  for (int k = 0; k < unknowns.size(); ++k) {
    const ParticleId p = unknowns.place(k).particle;
    roots[k] =
        unknowns.is_turn(k) ? std::sqrt(model.inertia[p]) / unknowns.length() : std::sqrt(model.mass[p]);
  }
  return roots;
}

SparseMatrix mass_scaled(const SparseMatrix& K, const Vector& roots_of_mass) {
  const Vector scale = roots_of_mass.cwiseInverse();
  return scale.asDiagonal() * K * scale.asDiagonal();
}

}  // namespace vbond
