#pragma once
#include <complex>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/results.hpp"

/// Waves in a periodic body (Bloch's theorem): the image at a distance w of a particle moves as the particle
/// times exp(i q . w), so that all of the body moves as the particles of one cell say.
namespace vbond {

/// Number k of a stage's wave vectors, in the cell as it stands.
Wave wave_of(const WaveVectors& waves, std::size_t k, const CellEdges& cell, const Periodic& periodic);

/// exp(i q . w) of the way w to an image. Where its phase is a multiple of a quarter turn but for the last
/// bits, it is exactly 1, i, -1 or -i.
std::complex<double> phase_of(const Wave& wave, const Image& image);

/// Whether the images move as the particles themselves.
bool repeats_with_cell(const Wave& wave, const Periodic& periodic);

/// The tangent of such motions, a Hermitian matrix over the unknowns. The imaginary part is empty where it is
/// zero.
struct BlochTangent {
  SparseMatrix real, imaginary;
  bool is_real() const { return imaginary.nonZeros() == 0; }
};
BlochTangent bloch_tangent(const StaticBody& body, const Wave& wave);

/// [[R, -I], [I, R]], symmetric: each eigenvalue of R + i I twice, with the vectors (re x, im x) and (-im x,
/// re x).
SparseMatrix doubled(const SparseMatrix& real, const SparseMatrix& imaginary);

/// The same of complex columns: pairs (re x, im x) and (-im x, re x).
SparseMatrix doubled_columns(const Eigen::MatrixXcd& X);

/// The first `count` columns that do not depend on those before, of columns (re x, im x) as complex vectors
/// of length 1.
Eigen::MatrixXcd independent_waves(const DenseMatrix& columns, Eigen::Index count);

/// Of orthonormal motions of parts (real columns, each of one part): those that go on as this wave, which are
/// motions of parts that hang together with none of their images, or with such as are in phase.
Eigen::MatrixXcd motions_in_phase(const StaticBody& body, const SparseMatrix& motions, const Wave& wave);

/// A motion of the unknowns as a shape, turned in phase such that its largest component is real.
WaveShape wave_shape(const Unknowns& unknowns, const Eigen::VectorXcd& x);

}  // namespace vbond
