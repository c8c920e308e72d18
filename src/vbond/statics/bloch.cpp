#include "vbond/statics/detail/bloch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "vbond/core/images.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {
namespace {

using Complex = std::complex<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr double full_turn = 2.0 * std::numbers::pi;

SparseMatrix assembled(Eigen::Index size, const Triplets& entries) {
  SparseMatrix A(size, size);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

}  // namespace

Wave wave_of(const WaveVectors& waves, std::size_t k, const CellEdges& cell, const Periodic& periodic) {
  const Vec3d& given = waves.q[k];
  Wave wave;
  if (!waves.of_edges) {
    wave.q = given;
    for (int e = 0; e < 3; ++e) {
      const auto edge = static_cast<std::size_t>(e);
      component(wave.edges, e) = periodic[edge] ? dot(given, cell[edge].along) / full_turn : 0.0;
    }
    return wave;
  }
  wave.edges = given;
  const Vec3d &a = cell[0].along, &b = cell[1].along, &c = cell[2].along;
  wave.q =
      (full_turn / volume(cell)) * (given.x * cross(b, c) + given.y * cross(c, a) + given.z * cross(a, b));
  return wave;
}

std::complex<double> phase_of(const Wave& wave, const Image& n) {
  constexpr double rounding = 8.0 * epsilon;
  const double parts[3] = {wave.edges.x * n.a, wave.edges.y * n.b, wave.edges.z * n.c};
  double sum = 0.0, size = 1.0;
  for (const double x : parts) sum += x, size += std::abs(x);
  const double quarters = 4.0 * (sum - std::round(sum)), nearest = std::round(quarters);
  if (std::abs(quarters - nearest) <= 4.0 * rounding * size) {
    constexpr Complex exact[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    return exact[(static_cast<int>(nearest) + 4) % 4];
  }
  return {std::cos(0.25 * full_turn * quarters), std::sin(0.25 * full_turn * quarters)};
}

bool repeats_with_cell(const Wave& wave, const Periodic& periodic) {
  for (const Image& n : {Image{1, 0, 0}, Image{0, 1, 0}, Image{0, 0, 1}})
    if ((n.a == 0 || periodic[0]) && (n.b == 0 || periodic[1]) && (n.c == 0 || periodic[2]) &&
        phase_of(wave, n) != 1.0)
      return false;
  return true;
}

BlochTangent bloch_tangent(const StaticBody& body, const Wave& wave) {
  const Unknowns& unknowns = body.unknowns();
  Triplets real, imaginary;
  const auto add = [&](ParticleId i, ParticleId j, const Eigen::Matrix<double, 6, 6>& K, Complex factor) {
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 6; ++column) {
        const int r = unknowns.of(i, row), c = unknowns.of(j, column);
        if (r == Unknowns::held || c == Unknowns::held || K(row, column) == 0.0) continue;
        real.emplace_back(r, c, (factor.real() - 1.0) * K(row, column));
        if (factor.imag() != 0.0) imaginary.emplace_back(r, c, factor.imag() * K(row, column));
      }
  };
  body.for_image_blocks([&](ParticleId i, ParticleId j, const Image& n, const Assembly::Block& K) {
    const Complex e = phase_of(wave, n);
    if (e == 1.0) return;
    add(i, j, K.topRightCorner<6, 6>(), e);
    add(j, i, K.bottomLeftCorner<6, 6>(), std::conj(e));
  });
  const SparseMatrix& K = body.tangent();
  return {K + assembled(K.rows(), real), assembled(K.rows(), imaginary)};
}

SparseMatrix doubled(const SparseMatrix& real, const SparseMatrix& imaginary) {
  const int n = static_cast<int>(real.rows());
  Triplets entries;
  entries.reserve(static_cast<std::size_t>(2 * (real.nonZeros() + imaginary.nonZeros())));
  for (int k = 0; k < n; ++k) {
    for (SparseMatrix::InnerIterator it(real, k); it; ++it)
      for (const int at : {0, n}) entries.emplace_back(at + static_cast<int>(it.row()), at + k, it.value());
    for (SparseMatrix::InnerIterator it(imaginary, k); it; ++it) {
      entries.emplace_back(n + static_cast<int>(it.row()), k, it.value());
      entries.emplace_back(static_cast<int>(it.row()), n + k, -it.value());
    }
  }
  return assembled(2 * n, entries);
}

SparseMatrix doubled_columns(const Eigen::MatrixXcd& X) {
  DenseMatrix columns(2 * X.rows(), 2 * X.cols());
  columns << X.real(), -X.imag(), X.imag(), X.real();
  return columns.sparseView();
}

// Columns of whole eigenspaces: what is left of one that depends on those before is rounding.
Eigen::MatrixXcd independent_waves(const DenseMatrix& columns, Eigen::Index count) {
  constexpr double depends = 1e-3;
  const Eigen::Index n = columns.rows() / 2;
  Eigen::MatrixXcd found(n, 0);
  for (Eigen::Index k = 0; k < columns.cols() && found.cols() < count; ++k) {
    Eigen::VectorXcd x = columns.col(k).head(n) + Complex(0, 1) * columns.col(k).tail(n);
    for (int pass = 0; pass < 2; ++pass) x -= found * (found.adjoint() * x);
    const double left = x.norm();
    if (left < depends) continue;
    found.conservativeResize(Eigen::NoChange, found.cols() + 1);
    found.col(found.cols() - 1) = x / left;
  }
  return found;
}

// Where the unwrapped part, each particle by the image that hangs together with the first one, moves as a
// rigid body the particles themselves are behind by their image's phase.
Eigen::MatrixXcd motions_in_phase(const StaticBody& body, const SparseMatrix& motions, const Wave& wave) {
  const PartImages parts = images_of_parts(body.model(), body.state(), body.unknowns());
  std::vector<bool> in_phase;
  for (const std::vector<Image>& loops : parts.loops)
    in_phase.push_back(
        std::all_of(loops.begin(), loops.end(), [&](const Image& n) { return phase_of(wave, n) == 1.0; }));
  Eigen::MatrixXcd found(motions.rows(), 0);
  for (int k = 0; k < motions.cols(); ++k) {
    Eigen::VectorXcd x = Eigen::VectorXcd::Zero(motions.rows());
    bool goes_on = true;
    for (SparseMatrix::InnerIterator it(motions, k); it; ++it) {
      const ParticleId p = body.unknowns().place(static_cast<int>(it.row())).particle;
      goes_on = goes_on && in_phase[parts.part[p]];
      x[it.row()] = it.value() * std::conj(phase_of(wave, parts.image[p]));
    }
    if (!goes_on) continue;
    found.conservativeResize(Eigen::NoChange, found.cols() + 1);
    found.col(found.cols() - 1) = x;
  }
  return found;
}

WaveShape wave_shape(const Unknowns& unknowns, const Eigen::VectorXcd& x) {
  Eigen::Index at = 0;
  x.cwiseAbs().maxCoeff(&at);
  const Eigen::VectorXcd turned = x * (std::conj(x[at]) / std::abs(x[at]));
  return unknowns.shape(Vector(turned.real()), Vector(turned.imag()));
}

}  // namespace vbond
