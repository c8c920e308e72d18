#include "vbond/statics/detail/multigrid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "vbond/statics/detail/multigrid_team.hpp"

namespace vbond {
namespace {

constexpr int block = multigrid_block;

/// The tangent in whole blocks of 6 x 6: rows of held degrees of freedom are the identity times the mean
/// diagonal of their particle, so that every particle of which anything is free has six rows.
class Blocks {
 public:
  void number(const Unknowns& unknowns) {
    particles_.clear();
    first_.clear();
    row_of_.resize(static_cast<std::size_t>(unknowns.size()));
    for (int k = 0; k < unknowns.size(); ++k) {
      const Unknowns::Place p = unknowns.place(k);
      if (particles_.empty() || particles_.back() != p.particle)
        particles_.push_back(p.particle), first_.push_back(k);
      row_of_[static_cast<std::size_t>(k)] = block * (static_cast<int>(particles_.size()) - 1) + p.dof;
    }
    first_.push_back(unknowns.size());
  }

  const std::vector<ParticleId>& particles() const { return particles_; }  ///< of each block
  const std::vector<int>& row_of() const { return row_of_; }               ///< of each unknown
  PetscInt size() const { return static_cast<PetscInt>(particles_.size()); }
  PetscInt rows() const { return block * size(); }

  /// Those of blocks first .. last - 1, of A + shift I. motions: of all rows.
  BlockRows rows_of(PetscInt first, PetscInt last, const SparseMatrix& A, double shift,
                    const DenseMatrix& motions) const {
    BlockRows rows;
    rows.all = this->rows();
    lay_out(first, last, A, rows);
    const int begin = block * first;  // number of its first row
    for (int k = first_unknown(first); k < first_unknown(last); ++k) {
      auto at = static_cast<std::size_t>(rows.begin[static_cast<std::size_t>(row(k) - begin)]);
      for (SparseMatrix::InnerIterator it(A, k); it; ++it) {  // both are in order
        const int wanted = row(static_cast<int>(it.row()));
        while (rows.column[at] != wanted) ++at;
        rows.value[at] = it.value() + (it.row() == k ? shift : 0.0);
      }
    }
    hold(first, last, rows);
    rows.motions = motions.middleRows(begin, block * (last - first));
    return rows;
  }

 private:
  int row(int unknown) const { return row_of_[static_cast<std::size_t>(unknown)]; }
  int first_unknown(PetscInt of_block) const { return first_[static_cast<std::size_t>(of_block)]; }

  /// The blocks beside one in A, in order: unknowns of one particle stand beside the same particles.
  std::vector<int> beside(PetscInt of, const SparseMatrix& A) const {
    std::vector<int> blocks;
    for (SparseMatrix::InnerIterator it(A, first_unknown(of)); it; ++it) {
      const int b = row(static_cast<int>(it.row())) / block;
      if (blocks.empty() || blocks.back() != b) blocks.push_back(b);
    }
    return blocks;
  }
  void lay_out(PetscInt first, PetscInt last, const SparseMatrix& A, BlockRows& rows) const {
    std::size_t pairs = 0;
    for (PetscInt own = first; own < last; ++own) pairs += beside(own, A).size();
    rows.column.reserve(block * block * pairs);
    rows.begin.assign(1, 0);
    for (PetscInt own = first; own < last; ++own) {
      const std::vector<int> others = beside(own, A);
      for (int k = 0; k < block; ++k) {
        for (const int b : others)
          for (int c = 0; c < block; ++c) rows.column.push_back(block * b + c);
        rows.begin.push_back(static_cast<PetscInt>(rows.column.size()));
      }
    }
    rows.value.assign(rows.column.size(), 0.0);
  }
  static std::size_t diagonal(const BlockRows& rows, int local, int column) {
    const auto first = rows.column.begin() + rows.begin[static_cast<std::size_t>(local)];
    const auto end = rows.column.begin() + rows.begin[static_cast<std::size_t>(local) + 1];
    return static_cast<std::size_t>(std::lower_bound(first, end, column) - rows.column.begin());
  }
  void hold(PetscInt first, PetscInt last, BlockRows& rows) const {
    for (PetscInt own = first; own < last; ++own) {
      std::array<bool, block> is_free{};
      for (int k = first_unknown(own); k < first_unknown(own + 1); ++k)
        is_free[static_cast<std::size_t>(row(k) - block * own)] = true;
      double sum = 0.0;
      int free = 0;
      const auto value = [&](int dof) -> double& {
        return rows.value[diagonal(rows, block * (own - first) + dof, block * own + dof)];
      };
      for (int dof = 0; dof < block; ++dof)
        if (is_free[static_cast<std::size_t>(dof)]) sum += std::abs(value(dof)), ++free;
      for (int dof = 0; dof < block; ++dof)
        if (!is_free[static_cast<std::size_t>(dof)]) value(dof) = sum > 0.0 ? sum / free : 1.0;
    }
  }

  std::vector<ParticleId> particles_;
  std::vector<int> first_;  // unknown of each block, and how many there are
  std::vector<int> row_of_;
};

/// Orthonormal columns over the rows of the blocks, each along the axes of its particle: the six motions of
/// the body as a whole. Turns are unknowns times the length scale.
DenseMatrix rigid_motions(const Blocks& blocks, const PerParticle<Vec3d>& r, const Unknowns& unknowns) {
  DenseMatrix all = DenseMatrix::Zero(blocks.rows(), block);
  Vec3d middle{};
  for (const ParticleId p : blocks.particles()) middle = middle + r[p];
  middle = middle / static_cast<double>(blocks.size());
  for (std::size_t b = 0; b < blocks.particles().size(); ++b) {
    const auto row = static_cast<Eigen::Index>(block * b);
    const ParticleId p = blocks.particles()[b];
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

}  // namespace

struct Multigrid::Petsc {
  Blocks blocks;
  MultigridTeam team;
};

bool has_multigrid() {
  return true;
}

Multigrid::Multigrid() : p_(std::make_unique<Petsc>()) {}
Multigrid::~Multigrid() = default;

bool Multigrid::at_hand() const {
  return p_->team.at_hand();
}

void Multigrid::make(const SparseMatrix& A, double shift, const Unknowns& unknowns,
                     const PerParticle<Vec3d>& r) {
  Petsc& p = *p_;
  p.blocks.number(unknowns);
  const DenseMatrix motions = rigid_motions(p.blocks, r, unknowns);
  p.team.make(p.blocks.size(), [&](PetscInt first, PetscInt last) {
    return p.blocks.rows_of(first, last, A, shift, motions);
  });
}

Vector Multigrid::solve(const Vector& b) const {
  const std::vector<int>& row_of = p_->blocks.row_of();
  Vector in = Vector::Zero(p_->blocks.rows()), out(in.size()), x(b.size());
  for (std::size_t k = 0; k < row_of.size(); ++k) in[row_of[k]] = b[static_cast<Eigen::Index>(k)];
  p_->team.apply(in.data(), out.data());
  for (std::size_t k = 0; k < row_of.size(); ++k) x[static_cast<Eigen::Index>(k)] = out[row_of[k]];
  return x;
}

}  // namespace vbond
