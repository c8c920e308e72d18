#include "vbond/statics/detail/multigrid.hpp"

#include <fmt/format.h>
#include <petscksp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <new>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "vbond/statics/detail/one_blas_thread.hpp"

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

/// PETSc for the rest of the process, without signal handlers and without the user's files of options.
/// GAMG takes its options by name; they have a prefix of their own.
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

constexpr int block = 6;

/// The tangent in whole blocks of 6 x 6: rows of held degrees of freedom are the identity times the mean
/// diagonal of their particle, so that every particle of which anything is free has six rows.
struct Blocks {
  std::vector<ParticleId> particles;  // of each block
  std::vector<int> row_of;            // of each unknown
  std::vector<PetscInt> begin, column;
  std::vector<PetscScalar> value;

  PetscInt rows() const { return static_cast<PetscInt>(block * particles.size()); }

  void fill(const SparseMatrix& A, double shift, const Unknowns& unknowns) {
    number(unknowns);
    lay_out(A);
    for (int k = 0; k < A.cols(); ++k) {
      const auto row = static_cast<std::size_t>(row_of[static_cast<std::size_t>(k)]);
      auto at = static_cast<std::size_t>(begin[row]);
      for (SparseMatrix::InnerIterator it(A, k); it; ++it) {  // both are in order
        const int wanted = row_of[static_cast<std::size_t>(it.row())];
        while (column[at] != wanted) ++at;
        value[at] = it.value() + (it.row() == k ? shift : 0.0);
      }
    }
    hold();
  }

 private:
  void number(const Unknowns& unknowns) {
    particles.clear();
    row_of.resize(static_cast<std::size_t>(unknowns.size()));
    for (int k = 0; k < unknowns.size(); ++k) {
      const Unknowns::Place p = unknowns.place(k);
      if (particles.empty() || particles.back() != p.particle) particles.push_back(p.particle);
      row_of[static_cast<std::size_t>(k)] = block * (static_cast<int>(particles.size()) - 1) + p.dof;
    }
  }
  void lay_out(const SparseMatrix& A) {
    std::vector<std::vector<int>> others(particles.size());  // blocks beside each, in order
    for (int k = 0; k < A.cols(); ++k) {
      std::vector<int>& list = others[static_cast<std::size_t>(row_of[static_cast<std::size_t>(k)] / block)];
      if (!list.empty()) continue;  // unknowns of one particle stand beside the same particles
      for (SparseMatrix::InnerIterator it(A, k); it; ++it) {
        const int b = row_of[static_cast<std::size_t>(it.row())] / block;
        if (list.empty() || list.back() != b) list.push_back(b);
      }
    }
    begin.assign(1, 0);
    column.clear();
    for (const std::vector<int>& list : others)
      for (int row = 0; row < block; ++row) {
        for (const int b : list)
          for (int c = 0; c < block; ++c) column.push_back(block * b + c);
        begin.push_back(static_cast<PetscInt>(column.size()));
      }
    value.assign(column.size(), 0.0);
  }
  std::size_t diagonal(PetscInt row) const {
    const auto first = column.begin() + begin[static_cast<std::size_t>(row)];
    const auto end = column.begin() + begin[static_cast<std::size_t>(row) + 1];
    return static_cast<std::size_t>(std::lower_bound(first, end, row) - column.begin());
  }
  void hold() {
    std::vector<char> is_free(static_cast<std::size_t>(rows()), 0);
    for (const int row : row_of) is_free[static_cast<std::size_t>(row)] = 1;
    for (PetscInt first = 0; first < rows(); first += block) {
      double sum = 0.0;
      int free = 0;
      for (PetscInt row = first; row < first + block; ++row)
        if (is_free[static_cast<std::size_t>(row)]) sum += std::abs(value[diagonal(row)]), ++free;
      for (PetscInt row = first; row < first + block; ++row)
        if (!is_free[static_cast<std::size_t>(row)]) value[diagonal(row)] = sum > 0.0 ? sum / free : 1.0;
    }
  }
};

/// Orthonormal columns over the rows of the blocks, each along the axes of its particle: the six motions of
/// the body as a whole. Turns are unknowns times the length scale.
DenseMatrix rigid_motions(const Blocks& blocks, const PerParticle<Vec3d>& r, const Unknowns& unknowns) {
  DenseMatrix all = DenseMatrix::Zero(blocks.rows(), block);
  Vec3d middle{};
  for (const ParticleId p : blocks.particles) middle = middle + r[p];
  middle = middle / static_cast<double>(blocks.particles.size());
  for (std::size_t b = 0; b < blocks.particles.size(); ++b) {
    const auto row = static_cast<Eigen::Index>(block * b);
    const ParticleId p = blocks.particles[b];
    for (int k = 0; k < 3; ++k) {
      const Vec3d& axis = world_axes[static_cast<std::size_t>(k)];
      const Movement shifted{axis, {}}, turned{cross(axis, r[p] - middle), unknowns.length() * axis};
      for (int dof = 0; dof < 6; ++dof) {
        all(row + dof, k) = unknowns.along(p, dof, shifted);
        all(row + dof, 3 + k) = unknowns.along(p, dof, turned);
      }
    }
  }
  for (int twice = 0; twice < 2; ++twice)
    for (int k = 0; k < block; ++k) {
      for (int j = 0; j < k; ++j) all.col(k) -= all.col(j).dot(all.col(k)) * all.col(j);
      all.col(k).normalize();
    }
  return all;
}

/// A vector of PETSc as one of Eigen, without a copy.
class View {
 public:
  explicit View(Vec v) : v_(v) {
    check(VecGetArray(v_, &data_));
    check(VecGetLocalSize(v_, &size_));
  }
  ~View() { VecRestoreArray(v_, &data_); }
  View(const View&) = delete;
  View& operator=(const View&) = delete;
  Eigen::Map<Vector> operator*() const { return {data_, size_}; }

 private:
  Vec v_;
  PetscScalar* data_ = nullptr;
  PetscInt size_ = 0;
};

/// The same of one that is only read: PETSc locks those.
class ReadView {
 public:
  explicit ReadView(Vec v) : v_(v) {
    check(VecGetArrayRead(v_, &data_));
    check(VecGetLocalSize(v_, &size_));
  }
  ~ReadView() { VecRestoreArrayRead(v_, &data_); }
  ReadView(const ReadView&) = delete;
  ReadView& operator=(const ReadView&) = delete;
  Eigen::Map<const Vector> operator*() const { return {data_, size_}; }

 private:
  Vec v_;
  const PetscScalar* data_ = nullptr;
  PetscInt size_ = 0;
};

}  // namespace

struct Multigrid::Petsc {
  Blocks blocks;
  Owned<Mat, MatDestroy> matrix;
  Owned<PC, PCDestroy> preconditioner;
  Owned<Vec, VecDestroy> b, x;
  bool made = false;

  void give_rigid_motions(const PerParticle<Vec3d>& r, const Unknowns& unknowns) {
    const DenseMatrix motions = rigid_motions(blocks, r, unknowns);
    std::array<Vec, block> columns{};
    for (int k = 0; k < block; ++k) {
      check(MatCreateVecs(matrix, &columns[static_cast<std::size_t>(k)], nullptr));
      *View(columns[static_cast<std::size_t>(k)]) = motions.col(k);
    }
    Owned<MatNullSpace, MatNullSpaceDestroy> space;
    check(MatNullSpaceCreate(PETSC_COMM_SELF, PETSC_FALSE, block, columns.data(), space.fresh()));
    check(MatSetNearNullSpace(matrix, space));
    for (Vec& v : columns) check(VecDestroy(&v));
  }

  void solve(const double* from, double* to) const {
    {
      const View in(b);
      (*in).setZero();
      for (std::size_t k = 0; k < blocks.row_of.size(); ++k) (*in)[blocks.row_of[k]] = from[k];
    }
    check(PCApply(preconditioner, b, x));
    const ReadView out(x);
    for (std::size_t k = 0; k < blocks.row_of.size(); ++k) to[k] = (*out)[blocks.row_of[k]];
  }
};

bool has_multigrid() {
  return true;
}

Multigrid::Multigrid() {
  begin_petsc();
  p_ = std::make_unique<Petsc>();
}
Multigrid::~Multigrid() = default;

bool Multigrid::at_hand() const {
  return p_->made;
}

void Multigrid::make(const SparseMatrix& A, double shift, const Unknowns& unknowns,
                     const PerParticle<Vec3d>& r) {
  const OneBlasThread alone;
  Petsc& p = *p_;
  p.made = false;
  p.preconditioner.fresh();  // memory: the old one goes first
  p.matrix.fresh();
  p.blocks.fill(A, shift, unknowns);
  check(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, p.blocks.rows(), p.blocks.rows(), p.blocks.begin.data(),
                                  p.blocks.column.data(), p.blocks.value.data(), p.matrix.fresh()));
  check(MatSetBlockSize(p.matrix, block));
  check(MatSetOption(p.matrix, MAT_SYMMETRIC, PETSC_TRUE));
  check(MatSetOption(p.matrix, MAT_SPD, PETSC_TRUE));
  p.give_rigid_motions(r, unknowns);
  check(MatCreateVecs(p.matrix, p.x.fresh(), p.b.fresh()));
  check(PCCreate(PETSC_COMM_SELF, p.preconditioner.fresh()));
  check(PCSetOptionsPrefix(p.preconditioner, "vbond_"));
  check(PCSetOperators(p.preconditioner, p.matrix, p.matrix));
  check(PCSetFromOptions(p.preconditioner));
  check(PCSetUp(p.preconditioner));
  p.made = true;
}

Vector Multigrid::solve(const Vector& b) const {
  const OneBlasThread alone;
  Vector x(b.size());
  p_->solve(b.data(), x.data());
  return x;
}

}  // namespace vbond
