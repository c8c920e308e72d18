#include "vbond/dynamics/stretch_lanes.hpp"

namespace vbond {

void stretch_energies(const Stretch& form, std::size_t count, const double* c_A, const double* a,
                      const double* D, double* U) {
  for (std::size_t k = 0; k < count; ++k) U[k] = stretched(form, c_A[k], a[k], D[k]).U;
}

void stretch_forces(const Stretch& form, std::size_t count, const double* c_A, const double* a,
                    const double* D, double* N) {
  for (std::size_t k = 0; k < count; ++k) N[k] = stretched(form, c_A[k], a[k], D[k]).N;
}

}  // namespace vbond
