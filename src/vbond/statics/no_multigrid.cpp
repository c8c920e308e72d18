#include <stdexcept>

#include "vbond/statics/detail/multigrid.hpp"

/// What a build without PETSc has of multigrid: the answer that there is none.
namespace vbond {

struct Multigrid::Petsc {};

bool has_multigrid() {
  return false;
}

Multigrid::Multigrid() {
  throw std::logic_error("Multigrid: this build has none (VBOND_PETSC=OFF)");
}

Multigrid::~Multigrid() = default;
void Multigrid::make(const SparseMatrix&, double, const Unknowns&, const PerParticle<Vec3d>&) {}
bool Multigrid::at_hand() const {
  return false;
}
Vector Multigrid::solve(const Vector& b) const {
  return b;
}
}  // namespace vbond
