#pragma once
#include <cstddef>

#include "vbond/core/simd.hpp"
#include "vbond/physics/stretch.hpp"

/// Forms of stretching that branch, or need a logarithm, for packs: plain code for every machine, bond by
/// bond, since no kernel may contain a copy of the library's functions.
namespace vbond {

/// Energies or forces of `count` bonds: see stretched().
void stretch_energies(const Stretch& form, std::size_t count, const double* c_A, const double* a,
                      const double* D, double* U);
void stretch_forces(const Stretch& form, std::size_t count, const double* c_A, const double* a,
                    const double* D, double* N);

template <std::size_t W, class F>
VBOND_HD Pack<W> stretch_by_lanes(F f, const Stretch& form, const Pack<W>& c_A, const Pack<W>& a,
                                  const Pack<W>& D) {
  double c_A_of[W], a_of[W], D_of[W], result[W];
  c_A.store(c_A_of), a.store(a_of), D.store(D_of);
  f(form, W, c_A_of, a_of, D_of, result);
  return Pack<W>::load(result);
}
template <std::size_t W>
VBOND_HD Pack<W> stretch_energy(const Stretch& form, const Pack<W>& c_A, const Pack<W>& a, const Pack<W>& D) {
  return stretch_by_lanes(stretch_energies, form, c_A, a, D);
}
template <std::size_t W>
VBOND_HD Pack<W> tension(const Stretch& form, const Pack<W>& c_A, const Pack<W>& a, const Pack<W>& D) {
  return stretch_by_lanes(stretch_forces, form, c_A, a, D);
}

}  // namespace vbond
