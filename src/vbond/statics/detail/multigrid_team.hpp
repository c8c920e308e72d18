#pragma once
// Of builds with PETSc alone: for the sources that use it.
#include <functional>

#include "vbond/statics/detail/multigrid_part.hpp"

namespace vbond {

/// The parts of a preconditioner on all processes that begin_multigrid_ranks() has brought together, for the
/// first of them; else that of this process alone.
class MultigridTeam {
 public:
  MultigridTeam();
  /// The parts go, too.
  ~MultigridTeam();
  MultigridTeam(const MultigridTeam&) = delete;
  MultigridTeam& operator=(const MultigridTeam&) = delete;

  /// Rows of these blocks.
  using Rows = std::function<BlockRows(PetscInt first, PetscInt last)>;
  /// Asks for the rows of one part after the other. Throws std::bad_alloc if this process is alone.
  void make(PetscInt blocks, const Rows& rows);
  bool at_hand() const { return own_.at_hand(); }
  /// All rows.
  void apply(const double* b, double* x) const;

 private:
  int id_;
  PetscInt blocks_ = 0;
  MultigridPart own_;
};

}  // namespace vbond
