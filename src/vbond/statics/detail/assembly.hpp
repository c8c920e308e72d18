#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/physics/tangent.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/unknowns.hpp"

namespace vbond {

/// Throws std::length_error if a matrix of so many entries has no room in SparseMatrix: 2^31 and more, some
/// 4.6 million particles of a lattice with six bonds each.
void check_room_for(std::int64_t entries);

/// Where pairs of particles stand in a sparse symmetric matrix over the unknowns. Rows of one particle follow
/// each other in every column, so one offset places a block of up to 6 x 6.
class Assembly {
 public:
  using Pair = std::pair<ParticleId, ParticleId>;
  /// Derivatives of the loads on i, then j, with the six degrees of freedom of i, then j, in their axes.
  using Block = Eigen::Matrix<double, 12, 12>;

  explicit Assembly(const Unknowns& unknowns) : unknowns_(unknowns) {}

  /// Lays out the matrix for these pairs of nodes of the unknowns; every node has its own block as well.
  /// Those of a rigid support that is free in part share one. Throws std::length_error if it would have more
  /// entries than the indices can count.
  void lay_out(const std::vector<Pair>& pairs);
  bool has(ParticleId i, ParticleId j) const {
    return move_as_one(i, j) || offsets_.count(key(unknowns_.carrier(i), unknowns_.carrier(j))) > 0;
  }
  /// Whether a rigid support carries both, or they are one: nothing changes between them, but between one
  /// and an image of the other.
  bool move_as_one(ParticleId i, ParticleId j) const { return unknowns_.carrier(i) == unknowns_.carrier(j); }
  /// Grows with every layout.
  int version() const { return version_; }

  /// A block over the world's axes in those of the particles, or of what carries them.
  Block in_axes(ParticleId i, ParticleId j, const Block& in_world) const;

  void clear();
  /// How what moves with the degrees of freedom of i and j moves along the world's axes; false: just so.
  bool axes(ParticleId i, ParticleId j, Block& T) const;
  /// Adds the rows and columns of free unknowns. Of particles that move as one, one being an image, all
  /// quarters go into their own block.
  void add(ParticleId i, ParticleId j, const Block& K);
  /// Derivatives with the components of a cell of the loads on a pair, in their axes, and the other way
  /// round: rows of the cell.
  using CellColumns = Eigen::Matrix<double, 12, 6>;
  using CellRows = Eigen::Matrix<double, 6, 12>;
  using CellBlock = Eigen::Matrix<double, 6, 6>;
  void add_cell(ParticleId i, ParticleId j, const CellColumns& columns, const CellRows& rows);
  void add_cell(const CellBlock& K);
  /// The same of one particle: the upper left quarter of a block.
  void add_own(ParticleId i, const Block& K) {
    const ParticleId c = unknowns_.carrier(i);
    add_block(c, c, own_offset_[c], K.topLeftCorner<6, 6>());
  }
  const SparseMatrix& matrix() const { return matrix_; }

  /// Where the block of a pair goes, both of which have all six degrees of freedom and are not carried by
  /// one: to be kept while the layout stays. Adds a symmetric block there, as add() does.
  struct Place {
    int first_i = -1, first_j = -1;  ///< unknowns; -1: of a pair that add() is for
    int own_i, own_j, i_in_j, j_in_i;
    bool is_there() const { return first_i >= 0; }
  };
  Place place_of(ParticleId i, ParticleId j) const;
  /// Columns of i alone, or of j: threads that have particles of their own add to these.
  struct Ends {
    bool i = true, j = true;
  };
  void add_symmetric(const Place& at, const double (&K)[12][12], Ends ends);

 private:
  struct Offsets {
    int j_in_i, i_in_j;  // of the first row of j in the columns of i, and the other way round
  };
  static std::uint64_t key(ParticleId i, ParticleId j) {
    return std::uint64_t{i < j ? i.value : j.value} << 32 | (i < j ? j.value : i.value);
  }
  template <class Quarter>
  void add_block(ParticleId row, ParticleId column, int offset, const Quarter& K) {
    for (int b = 0; b < 6; ++b) {
      const int c = unknowns_.of(column, b);
      if (c == Unknowns::held) continue;
      double* value = matrix_.valuePtr() + matrix_.outerIndexPtr()[c] + offset;
      for (int a = 0; a < 6; ++a)
        if (unknowns_.of(row, a) != Unknowns::held) *value++ += K(a, b);
    }
  }
  /// Of the first row of one node in the columns of another.
  int offset(ParticleId row, ParticleId column) const {
    if (row == column) return own_offset_[row];
    const Offsets& o = offsets_.at(key(row, column));
    return row < column ? o.i_in_j : o.j_in_i;
  }

  const Unknowns& unknowns_;
  SparseMatrix matrix_;
  PerParticle<int> own_offset_;
  std::unordered_map<std::uint64_t, Offsets> offsets_;  // i is the smaller number
  int version_ = 0;
};

/// Derivatives of minus the loads on i and j with their degrees of freedom along the world's axes, from those
/// with r_ij and turns; turns are multiplied by this length.
Assembly::Block block_of(const PairTangent<9>& t, double length);

}  // namespace vbond
