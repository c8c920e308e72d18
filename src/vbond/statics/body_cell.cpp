// The cell of a periodic body: how it moves, the stress that it gives way to, and what that is in the
// tangent.
//
// U depends on places, turns and F, the deformation gradient of the cell, which moves images only: r_ij has
// the part F w, where w is the image at the start. So P = dU/dF = sum of F_i (x) w over pairs with an image,
// and P F^T is the volume times Cauchy's stress, as where all is in balance r_ij (x) F_i sums up to over all
// pairs. F is a sum of its components times B_k, symmetric or of the upper triangle.
//
// What is out of balance on component k is
//
//     g_k = (T F^-T - P) . B_k,   T = volume * stress wanted,
//
// where T has the stress of now in the components that the stage holds or strains. With all six components
// wanted and no stress that is minus the derivative of U. It is zero for all free k where each free component
// of the stress is the one wanted, the others being whatever they are: P . B_k = 0 alone would not do, since
// F^-T mixes components, and what is held has a stress of its own. A stress that stays Cauchy's while the
// body strains has no potential, and the mixing has none: the tangent has an antisymmetric part, in
// proportion to strain and stress, which is treated as that of moments from outside is.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/core/images.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond {
namespace {

using Matrix3 = Eigen::Matrix3d;
using By = CellComponent::By;

Matrix3 matrix_of(const Tensor& t) {
  Matrix3 m;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) m(a, b) = component(t.row[static_cast<std::size_t>(a)], b);
  return m;
}
Tensor tensor_of(const Matrix3& m) {
  Tensor t;
  for (int a = 0; a < 3; ++a) t.row[static_cast<std::size_t>(a)] = {m(a, 0), m(a, 1), m(a, 2)};
  return t;
}
double double_dot(const Matrix3& a, const Matrix3& b) {
  return a.cwiseProduct(b).sum();
}

/// The symmetric tensor that has this component alone.
Matrix3 symmetric_unit(std::size_t k) {
  SymmetricParts x{};
  x[k] = 1.0;
  return matrix_of(cell_tensor(x, false));
}
/// A component of the symmetric part of a tensor.
double symmetric_component(const Matrix3& m, std::size_t k) {
  const auto [a, b] = cell_component_axes[k];
  return 0.5 * (m(a, b) + m(b, a));
}
Eigen::Index at(std::size_t k) {
  return static_cast<Eigen::Index>(k);
}

}  // namespace

void StaticBody::take_hold_of_cell() {
  if (moves_cell()) cell_found_ = cell_components_now();
}

bool StaticBody::has_collapsed() const {
  constexpr double least = 0.01;
  if (!moves_cell()) return false;
  const Matrix3 F = matrix_of(cell_gradient(model_.cell, state_.cell));
  return !(F(0, 0) > least && F.topLeftCorner<2, 2>().determinant() > least && F.determinant() > least);
}

/// Places are rounded to eps of themselves, so that of each bond that goes to an image so much of a force is
/// not known.
void StaticBody::note_rounding_of_cell() {
  if (!has_free_cell()) return;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  double sum = 0.0;
  for (const Bond& b : state_.bonds)
    if (!b.broken && !image_of_j(b).is_itself()) {
      const double way = norm(image_at_start(image_of_j(b)));
      sum += sq(b.law->stiffness(b).c_A * (norm(state_.r[b.i]) + way + b.a) * way);
    }
  rounding_of_force_ = std::max(rounding_of_force_, eps * std::sqrt(sum) / unknowns_.cell_length());
}

Tensor StaticBody::cell_basis(std::size_t component) const {
  SymmetricParts x{};
  x[component] = 1.0;
  return cell_tensor(x, model_.cell.triangular);
}

/// Of a component of F, per load factor.
double StaticBody::cell_rate(std::size_t component) const {
  const CellComponent& c = stage_.cell.component[component];
  return c.by == By::strain ? c.value : 0.0;
}

Vec3d StaticBody::image_at_start(const Image& n) const {
  const auto& [a, b, c] = model_.cell.edges;
  return double(n.a) * a + double(n.b) * b + double(n.c) * c;
}

/// What unknowns and load factor change F by.
Tensor StaticBody::cell_change(const Vector& x, double load_factor_change) const {
  SymmetricParts change{};
  for (std::size_t k = 0; k < 6; ++k) {
    const int unknown = unknowns_.of_cell(k);
    change[k] =
        unknown != Unknowns::held ? x[unknown] / unknowns_.cell_length() : load_factor_change * cell_rate(k);
  }
  return cell_tensor(change, model_.cell.triangular);
}

void StaticBody::carry_cell(const Vector& x, double new_load_factor) {
  SymmetricParts F = cell_components_now();
  for (std::size_t k = 0; k < 6; ++k) {
    const int unknown = unknowns_.of_cell(k);
    F[k] = unknown != Unknowns::held ? F[k] + x[unknown] / unknowns_.cell_length()
                                     : cell_found_[k] + (new_load_factor - held_at_) * cell_rate(k);
  }
  const Tensor gradient = cell_tensor(F, model_.cell.triangular);
  for (std::size_t k = 0; k < 3; ++k) state_.cell[k].along = times(gradient, model_.cell.edges[k]);
}

/// Of a pair whose second particle is an image: the force on the first.
void StaticBody::add_image(const Image& n, const Vec3d& force, LoadSum& to) const {
  if (moves_cell()) to.of_cell += dyad(force, image_at_start(n));
}

SymmetricParts StaticBody::wanted_stress(double load_factor) const {
  SymmetricParts wanted{};
  for (std::size_t k = 0; k < 6; ++k) {
    if (unknowns_.of_cell(k) == Unknowns::held) continue;
    const double start = stage_.cell_stress_at_start[k];
    wanted[k] = start + load_factor * (stage_.cell.component[k].value - start);
  }
  return wanted;
}

/// T F^-T.
Tensor StaticBody::load_on_cell(const Tensor& of_cell) const {
  const Matrix3 F = matrix_of(cell_gradient(model_.cell, state_.cell)),
                now = matrix_of(of_cell) * F.transpose();
  Matrix3 T = volume(state_.cell) * matrix_of(cell_tensor(wanted_stress(load_factor_), false));
  for (std::size_t k = 0; k < 6; ++k)
    if (unknowns_.of_cell(k) == Unknowns::held) T += symmetric_component(now, k) * symmetric_unit(k);
  return tensor_of(T * F.inverse().transpose());
}

void StaticBody::balance_cell(Loaded& l) const {
  const Tensor load = load_on_cell(l.of_cell);
  for (std::size_t k = 0; k < 6; ++k)
    if (const int unknown = unknowns_.of_cell(k); unknown != Unknowns::held) {
      const Tensor B = cell_basis(k);
      l.unbalanced[unknown] = (double_dot(load, B) - double_dot(l.of_cell, B)) / unknowns_.cell_length();
    }
  // what the stress is on one particle
  for (const double stress : wanted_stress(load_factor_))
    l.largest = larger(l.largest, std::abs(stress) * sq(unknowns_.length()));
}

/// With places and turns g_k changes by -dP . (B_k - N_k): T has the stress of held components, which are
/// those of P F^T.
void StaticBody::look_at_mixing() const {
  const Matrix3 F = matrix_of(cell_gradient(model_.cell, state_.cell)), F_inverse_T = F.inverse().transpose();
  for (std::size_t k = 0; k < 6; ++k) {
    const Matrix3 B = matrix_of(cell_basis(k));
    Matrix3 N = Matrix3::Zero();
    for (std::size_t c = 0; c < 6; ++c) {
      if (unknowns_.of_cell(c) != Unknowns::held) continue;
      const Matrix3 E = symmetric_unit(c);
      N += double_dot(E * F_inverse_T, B) / E.sum() * E * F;
    }
    cell_row_[k] = tensor_of(B - N);
  }
  stiffness_.skew = DenseMatrix::Zero(6, unknowns_.size());
}

/// What a pair with an image, whose block this is, has to do with the cell: the image moves with F w.
void StaticBody::add_image(ParticleId i, ParticleId j, const Image& n,
                           const Assembly::Block& in_world) const {
  const double L = unknowns_.cell_length();
  const Vec3d w = image_at_start(n);
  Assembly::CellColumns shift = Assembly::CellColumns::Zero(), sum = shift;
  Eigen::Matrix<double, 6, 1> rate;
  for (std::size_t k = 0; k < 6; ++k) {
    const Vec3d moved = times(cell_basis(k), w) / L, summed = times(cell_row_[k], w) / L;
    for (int a = 0; a < 3; ++a) shift(6 + a, at(k)) = component(moved, a);
    if (unknowns_.of_cell(k) != Unknowns::held)
      for (int a = 0; a < 3; ++a) sum(6 + a, at(k)) = component(summed, a);
    rate[at(k)] = L * cell_rate(k);
  }
  Assembly::CellColumns columns = in_world * shift;
  const Eigen::Matrix<double, 12, 1> pushed = -columns * rate;
  unknowns_.add_load(i, {{pushed[0], pushed[1], pushed[2]}, {pushed[3], pushed[4], pushed[5]}},
                     stiffness_.load_direction);
  unknowns_.add_load(j, {{pushed[6], pushed[7], pushed[8]}, {pushed[9], pushed[10], pushed[11]}},
                     stiffness_.load_direction);
  if (!has_free_cell()) return;
  add_of_cell(sum.transpose() * columns);
  Assembly::CellRows rows = sum.transpose() * in_world;
  if (Assembly::Block T; stiffness_.assembly.axes(i, j, T)) {
    columns = T.transpose() * columns;
    rows = rows * T;
  }
  const Assembly::CellColumns mean = 0.5 * (columns + rows.transpose());
  const Assembly::CellRows skew = 0.5 * (rows - columns.transpose());
  stiffness_.assembly.add_cell(i, j, mean, mean.transpose());
  if (flows()) stiffness_.full.add_cell(i, j, columns, rows);
  const ParticleId ends[2] = {unknowns_.carrier(i), unknowns_.carrier(j)};
  for (std::size_t k = 0; k < 6; ++k) {
    if (unknowns_.of_cell(k) == Unknowns::held) continue;
    for (int column = 0; column < 12; ++column)
      if (const int u = unknowns_.of(ends[column / 6], column % 6); u != Unknowns::held)
        stiffness_.skew(at(k), u) += skew(at(k), column);
  }
}

/// Adds derivatives of -g_k with all six components.
void StaticBody::add_of_cell(const Assembly::CellBlock& own) const {
  stiffness_.assembly.add_cell(0.5 * (own + own.transpose()));
  if (flows()) stiffness_.full.add_cell(own);
  for (std::size_t k = 0; k < 6; ++k) {
    const int row = unknowns_.of_cell(k);
    if (row == Unknowns::held) continue;
    for (std::size_t l = 0; l < 6; ++l) {
      stiffness_.load_direction[row] -= own(at(k), at(l)) * unknowns_.cell_length() * cell_rate(l);
      if (const int column = unknowns_.of_cell(l); column != Unknowns::held)
        stiffness_.skew(at(k), column) += 0.5 * (own(at(k), at(l)) - own(at(l), at(k)));
    }
  }
}

/// What T F^-T changes by with F itself, and with the load factor.
void StaticBody::add_own_of_cell() const {
  const double L = unknowns_.cell_length(), V = volume(state_.cell);
  const Tensor& of_cell = loads_at_hand().of_cell;
  const Matrix3 F_inverse = matrix_of(cell_gradient(model_.cell, state_.cell)).inverse(),
                P = matrix_of(of_cell), load = matrix_of(load_on_cell(of_cell)),
                wanted = matrix_of(cell_tensor(wanted_stress(load_factor_), false)),
                growing = matrix_of(cell_tensor(wanted_stress(1.0), false)) -
                          matrix_of(cell_tensor(wanted_stress(0.0), false));
  Assembly::CellBlock own = Assembly::CellBlock::Zero();
  for (std::size_t l = 0; l < 6; ++l) {
    const Matrix3 B_l = matrix_of(cell_basis(l)), turned = P * B_l.transpose();
    Matrix3 dT = V * (F_inverse * B_l).trace() * wanted;
    for (std::size_t c = 0; c < 6; ++c)
      if (unknowns_.of_cell(c) == Unknowns::held) dT += symmetric_component(turned, c) * symmetric_unit(c);
    const Matrix3 change = (dT - load * B_l.transpose()) * F_inverse.transpose();
    for (std::size_t k = 0; k < 6; ++k)
      if (unknowns_.of_cell(k) != Unknowns::held)
        own(at(k), at(l)) = -double_dot(change, matrix_of(cell_basis(k))) / sq(L);
  }
  add_of_cell(own);
  for (std::size_t k = 0; k < 6; ++k)
    if (const int row = unknowns_.of_cell(k); row != Unknowns::held)
      stiffness_.load_direction[row] +=
          V * double_dot(growing * F_inverse.transpose(), matrix_of(cell_basis(k))) / L;
}

void StaticBody::add_skew_of_cell(SparseMatrix& K) const {
  if (!has_free_cell()) return;
  const DenseMatrix& skew = stiffness_at_hand().skew;
  for (std::size_t k = 0; k < 6; ++k) {
    const int row = unknowns_.of_cell(k);
    if (row == Unknowns::held) continue;
    for (int u = 0; u < unknowns_.size(); ++u) {
      const double x = skew(at(k), u);
      if (x == 0.0) continue;
      K.coeffRef(row, u) += x;
      if (!unknowns_.is_of_cell(u)) K.coeffRef(u, row) -= x;
    }
  }
}

std::array<double, 6> StaticBody::forces_on_cell() const {
  std::array<double, 6> forces{};
  if (!moves_cell()) return forces;
  for (std::size_t k = 0; k < 6; ++k) forces[k] = double_dot(loads_at_hand().of_cell, cell_basis(k));
  return forces;
}

/// Of the stress wanted and of the relief, by their sizes here, on the way of the free components.
double StaticBody::work_on_cell(const Placement& from) const {
  const SymmetricParts before = cell_components(cell_gradient(model_.cell, from.cell)),
                       now = cell_components_now(), of_body = forces_on_cell();
  double work = 0.0;
  for (std::size_t k = 0; k < 6; ++k)
    if (const int unknown = unknowns_.of_cell(k); unknown != Unknowns::held)
      work += (of_body[k] + unknowns_.cell_length() * unbalanced()[unknown]) * (now[k] - before[k]);
  return work;
}

}  // namespace vbond
