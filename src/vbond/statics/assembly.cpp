#include "vbond/statics/detail/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace vbond {

void check_room_for(std::int64_t entries) {
  if (entries > std::numeric_limits<SparseMatrix::StorageIndex>::max())
    throw std::length_error(fmt::format(
        "the tangent stiffness would have {} entries, and 2^31 - 1 can be counted: use fewer particles",
        entries));
}

void Assembly::lay_out(const std::vector<Pair>& pairs) {
  const std::size_t particles = unknowns_.nodes();
  PerParticle<std::vector<ParticleId>> near(particles);
  for (const ParticleId p : near.ids()) near[p].push_back(p);
  for (const auto& [p, q] : pairs) {
    const ParticleId i = unknowns_.carrier(p), j = unknowns_.carrier(q);
    near[i].push_back(j), near[j].push_back(i);
  }
  for (auto& n : near) {
    std::sort(n.begin(), n.end());
    n.erase(std::unique(n.begin(), n.end()), n.end());
  }

  PerParticle<int> first(particles, 0), free(particles, 0);
  for (int k = unknowns_.size(); k-- > 0;) {
    const ParticleId p = unknowns_.place(k).particle;
    first[p] = k;
    ++free[p];
  }
  own_offset_.assign(particles, 0);
  offsets_.clear();
  Eigen::VectorXi rows(unknowns_.size());
  std::int64_t entries = 0;
  for (const ParticleId q : near.ids()) {
    int height = 0;
    for (const ParticleId p : near[q]) {
      if (p == q) own_offset_[q] = height;
      if (p < q) offsets_[key(p, q)].i_in_j = height;
      if (p > q) offsets_[key(q, p)].j_in_i = height;
      height += free[p];
    }
    for (int k = 0; k < free[q]; ++k) rows[first[q] + k] = height;
    entries += std::int64_t{free[q]} * height;
  }
  check_room_for(entries);

  matrix_.resize(unknowns_.size(), unknowns_.size());
  matrix_.resizeNonZeros(static_cast<Eigen::Index>(entries));
  ++version_;
  if (unknowns_.size() == 0) return;
  std::partial_sum(rows.begin(), rows.end(), matrix_.outerIndexPtr() + 1);
  for (const ParticleId q : near.ids())
    for (int c = first[q]; c < first[q] + free[q]; ++c) {
      int* row = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[c];
      for (const ParticleId p : near[q])
        for (int r = first[p]; r < first[p] + free[p]; ++r) *row++ = r;
    }
  clear();
}

void Assembly::clear() {
  std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
}

bool Assembly::axes(ParticleId i, ParticleId j, Block& T) const {
  const auto as_world = [this](ParticleId p) { return !unknowns_.axes(p) && !unknowns_.arm(p); };
  if (as_world(i) && as_world(j)) return false;
  T = Block::Zero();
  for (int column = 0; column < 12; ++column)
    for (int k = 0; k < 3; ++k)
      T(column / 3 * 3 + k, column) = component(unknowns_.axis(column < 6 ? i : j, column % 6), k);
  for (const int at : {0, 6})
    if (const Vec3d* arm = unknowns_.arm(at == 0 ? i : j)) {  // how turns about the pivot shift the particle
      const Vec3d d = *arm / unknowns_.length();
      T.block<3, 3>(at, at + 3) << 0.0, d.z, -d.y, -d.z, 0.0, d.x, d.y, -d.x, 0.0;
    }
  return true;
}

Assembly::Block Assembly::in_axes(ParticleId i, ParticleId j, const Block& in_world) const {
  Block T;
  if (!axes(i, j, T)) return in_world;
  return T.transpose() * in_world * T;
}

namespace {

/// The first unknown of a particle whose degrees of freedom are all free, which follow one another.
int first_of_six(const Unknowns& unknowns, ParticleId p) {
  for (int dof = 1; dof < 6; ++dof)
    if (unknowns.of(p, dof) == Unknowns::held) return Unknowns::held;
  return unknowns.of(p, 0);
}

}  // namespace

void Assembly::add(ParticleId p, ParticleId q, const Block& K) {
  const ParticleId i = unknowns_.carrier(p), j = unknowns_.carrier(q);
  if (i == j) {
    const int own = own_offset_[i];
    for (const int row : {0, 6})
      for (const int column : {0, 6}) add_block(i, i, own, K.block<6, 6>(row, column));
    return;
  }
  const Offsets& o = offsets_.at(key(i, j));
  const int first_i = first_of_six(unknowns_, i), first_j = first_of_six(unknowns_, j);
  if (first_i != Unknowns::held && first_j != Unknowns::held) {  // nearly all: without asking entry by entry
    const auto add_six = [this](int column, int offset, const auto& quarter) {
      for (int b = 0; b < 6; ++b)
        Eigen::Map<Eigen::Matrix<double, 6, 1>>(matrix_.valuePtr() + matrix_.outerIndexPtr()[column + b] +
                                                offset) += quarter.col(b);
    };
    add_six(first_i, own_offset_[i], K.topLeftCorner<6, 6>());
    add_six(first_j, own_offset_[j], K.bottomRightCorner<6, 6>());
    add_six(first_j, i < j ? o.i_in_j : o.j_in_i, K.topRightCorner<6, 6>());
    add_six(first_i, i < j ? o.j_in_i : o.i_in_j, K.bottomLeftCorner<6, 6>());
    return;
  }
  add_block(i, i, own_offset_[i], K.topLeftCorner<6, 6>());
  add_block(j, j, own_offset_[j], K.bottomRightCorner<6, 6>());
  add_block(i, j, i < j ? o.i_in_j : o.j_in_i, K.topRightCorner<6, 6>());
  add_block(j, i, i < j ? o.j_in_i : o.i_in_j, K.bottomLeftCorner<6, 6>());
}

Assembly::Place Assembly::place_of(ParticleId p, ParticleId q) const {
  const ParticleId i = unknowns_.carrier(p), j = unknowns_.carrier(q);
  if (i == j) return {};
  const int first_i = first_of_six(unknowns_, i), first_j = first_of_six(unknowns_, j);
  if (first_i == Unknowns::held || first_j == Unknowns::held) return {};
  return {first_i, first_j, own_offset_[i], own_offset_[j], offset(i, j), offset(j, i)};
}

void Assembly::add_symmetric(const Place& at, const double (&K)[12][12], Ends ends) {
  double* const values = matrix_.valuePtr();
  const int* const columns = matrix_.outerIndexPtr();
  const auto add_six = [](const double* from, double* to) {
    for (int a = 0; a < 6; ++a) to[a] += from[a];
  };
  for (int b = 0; ends.i && b < 6; ++b) {
    double* column = values + columns[at.first_i + b];
    add_six(K[b], column + at.own_i);
    add_six(K[b] + 6, column + at.j_in_i);
  }
  for (int b = 0; ends.j && b < 6; ++b) {
    double* column = values + columns[at.first_j + b];
    add_six(K[6 + b], column + at.i_in_j);
    add_six(K[6 + b] + 6, column + at.own_j);
  }
}

void Assembly::add_cell(ParticleId p, ParticleId q, const CellColumns& columns, const CellRows& rows) {
  const ParticleId i = unknowns_.carrier(p), j = unknowns_.carrier(q), cell = unknowns_.cell_node();
  add_block(i, cell, offset(i, cell), columns.topRows<6>());
  add_block(j, cell, offset(j, cell), columns.bottomRows<6>());
  add_block(cell, i, offset(cell, i), rows.leftCols<6>());
  add_block(cell, j, offset(cell, j), rows.rightCols<6>());
}

void Assembly::add_cell(const CellBlock& K) {
  const ParticleId cell = unknowns_.cell_node();
  add_block(cell, cell, own_offset_[cell], K);
}

}  // namespace vbond
