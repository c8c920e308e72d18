#pragma once
#include <memory>

#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/unknowns.hpp"

namespace vbond {

/// Whether this build has multigrid.
bool has_multigrid();

/// A preconditioner by smoothed aggregation (PETSc's GAMG on one process). Its coarse spaces are made from
/// the six rigid motions of the body, which with bonds cost the least energy. In a build without PETSc the
/// constructor throws std::logic_error.
class Multigrid {
 public:
  Multigrid();
  ~Multigrid();

  /// For A + shift I, A the tangent over these unknowns with particles at r. Throws std::bad_alloc.
  void make(const SparseMatrix& A, double shift, const Unknowns& unknowns, const PerParticle<Vec3d>& r);
  bool at_hand() const;
  /// Roughly (A + shift I)^-1 b: a symmetric operator, definite if the matrix is.
  Vector solve(const Vector& b) const;

 private:
  struct Petsc;
  std::unique_ptr<Petsc> p_;
};

}  // namespace vbond
