#include "vbond/statics/detail/multigrid_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <utility>

namespace vbond {
namespace {

/// PETSc's error codes as exceptions.
void check(PetscErrorCode code) {
  if (code == 0) return;
  if (code == PETSC_ERR_MEM) throw std::bad_alloc();
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw std::runtime_error(
      fmt::format("PETSc: {} (error {})", text ? text : "unknown", static_cast<int>(code)));
}

/// PETSc for the rest of the process, without signal handlers and without the user's files of options. GAMG
/// takes its options by name; they have a prefix of their own.
void begin_petsc() {
  static const bool begun = [] {
    PetscBool others = PETSC_FALSE;
    check(PetscInitialized(&others));
    if (!others) {
      std::array<char, 6> name{"vbond"};
      std::array<char, 19> quiet{"-no_signal_handler"};
      std::array<char, 14> alone{"-skip_petscrc"};
      std::array<char*, 4> words{name.data(), quiet.data(), alone.data(), nullptr};
      int count = 3;
      char** arguments = words.data();
      check(PetscInitialize(&count, &arguments, nullptr, nullptr));
      check(PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr));
      std::atexit([] { PetscFinalize(); });
    }
    for (const auto& [key, value] :
         {std::pair{"-vbond_pc_type", "gamg"}, std::pair{"-vbond_pc_gamg_agg_nsmooths", "1"},
          std::pair{"-vbond_mg_levels_ksp_type", "chebyshev"}, std::pair{"-vbond_mg_levels_ksp_max_it", "2"},
          std::pair{"-vbond_mg_levels_pc_type", "jacobi"},
          std::pair{"-vbond_mg_levels_esteig_ksp_type", "cg"}}) {
      PetscBool given = PETSC_FALSE;
      check(PetscOptionsHasName(nullptr, nullptr, key, &given));
      if (!given) check(PetscOptionsSetValue(nullptr, key, value));
    }
    return true;
  }();
  (void)begun;
}

/// Calls use with the numbers of a vector that this process has.
template <class Use>
void change(Vec v, Use use) {
  PetscScalar* data = nullptr;
  check(VecGetArray(v, &data));
  use(data);
  check(VecRestoreArray(v, &data));
}

}  // namespace

void MultigridPart::make(MPI_Comm processes, BlockRows rows) {
  begin_petsc();
  made_ = false;
  preconditioner_.fresh();  // memory: the old one goes first
  matrix_.fresh();
  rows_ = std::move(rows);
  int count = 1;
  MPI_Comm_size(processes, &count);
  const PetscInt size = rows_.size();
  if (count == 1) {
    check(MatCreateSeqAIJWithArrays(processes, size, size, rows_.begin.data(), rows_.column.data(),
                                    rows_.value.data(), matrix_.fresh()));
  } else {  // with copies
    check(MatCreateMPIAIJWithArrays(processes, size, size, rows_.all, rows_.all, rows_.begin.data(),
                                    rows_.column.data(), rows_.value.data(), matrix_.fresh()));
    rows_.begin = {}, rows_.column = {}, rows_.value = {};
  }
  check(MatSetBlockSize(matrix_, multigrid_block));
  check(MatSetOption(matrix_, MAT_SYMMETRIC, PETSC_TRUE));
  check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));

  std::array<Vec, multigrid_block> motions{};
  for (int k = 0; k < multigrid_block; ++k) {
    Vec& v = motions[static_cast<std::size_t>(k)];
    check(MatCreateVecs(matrix_, &v, nullptr));
    change(v, [&](PetscScalar* to) { std::copy_n(rows_.motions.col(k).data(), size, to); });
  }
  rows_.motions = {};
  Owned<MatNullSpace, MatNullSpaceDestroy> space;
  check(MatNullSpaceCreate(processes, PETSC_FALSE, multigrid_block, motions.data(), space.fresh()));
  check(MatSetNearNullSpace(matrix_, space));
  for (Vec& v : motions) check(VecDestroy(&v));

  check(MatCreateVecs(matrix_, x_.fresh(), b_.fresh()));
  check(PCCreate(processes, preconditioner_.fresh()));
  check(PCSetOptionsPrefix(preconditioner_, "vbond_"));
  check(PCSetOperators(preconditioner_, matrix_, matrix_));
  check(PCSetFromOptions(preconditioner_));
  check(PCSetUp(preconditioner_));
  made_ = true;
}

void MultigridPart::apply(const double* b, double* x) const {
  PetscInt size = 0;
  check(VecGetLocalSize(b_, &size));
  change(b_, [&](PetscScalar* to) { std::copy_n(b, size, to); });
  check(PCApply(preconditioner_, b_, x_));
  const PetscScalar* found = nullptr;
  check(VecGetArrayRead(x_, &found));
  std::copy_n(found, size, x);
  check(VecRestoreArrayRead(x_, &found));
}

}  // namespace vbond
