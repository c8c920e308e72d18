#pragma once
// Of builds with PETSc alone: for the sources that use it.
#include <petscksp.h>

#include <vector>

#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// An object of PETSc that is destroyed with its owner.
template <class T, PetscErrorCode (*destroy)(T*)>
class Owned {
 public:
  Owned() = default;
  ~Owned() { destroy(&object_); }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  operator T() const { return object_; }
  /// For the function that makes a new one.
  T* fresh() {
    destroy(&object_);
    return &object_;
  }

 private:
  T object_ = nullptr;
};

/// Degrees of freedom of a particle, which stand in the matrix as one block of rows.
inline constexpr int multigrid_block = 6;

/// Rows of a symmetric matrix that follow each other, in whole blocks, compressed.
struct BlockRows {
  PetscInt all = 0;  ///< rows of the whole matrix
  std::vector<PetscInt> begin, column;
  std::vector<PetscScalar> value;
  DenseMatrix motions;  ///< these rows of the six motions of a rigid body, which are orthonormal
  PetscInt size() const { return static_cast<PetscInt>(begin.size()) - 1; }
};

/// What one of several processes has of a preconditioner: some rows. All of them call the same functions.
/// Alone, one has all rows.
class MultigridPart {
 public:
  /// Throws std::bad_alloc.
  void make(MPI_Comm processes, BlockRows rows);
  bool at_hand() const { return made_; }
  /// Own rows of the product with own rows of b, which are as many.
  void apply(const double* b, double* x) const;

 private:
  BlockRows rows_;
  Owned<Mat, MatDestroy> matrix_;
  Owned<PC, PCDestroy> preconditioner_;
  Owned<Vec, VecDestroy> b_, x_;
  bool made_ = false;
};

}  // namespace vbond
