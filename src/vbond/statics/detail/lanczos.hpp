#pragma once
#include <functional>
#include <initializer_list>
#include <optional>

#include "vbond/statics/detail/matrix.hpp"

/// Lanczos iteration (Spectra) for some eigenpairs of an operator that is given as a function. Spectra's
/// templates are compiled in lanczos.cpp and nowhere else.
namespace vbond {

/// y = (operator) x, of as many unknowns as the matrix has.
using Operator = std::function<void(const double* x, double* y)>;

/// Which eigenvalues are wanted: the largest algebraically, or the largest in size.
enum class Largest { value, size };

struct LanczosPairs {
  Vector values;
  DenseMatrix vectors;
};

/// Of vectors, as a part of the eigenvalue; eigenvalues are good to its square.
inline constexpr double tolerance_of_vectors = 1e-11;

/// `count` eigenpairs of a symmetric operator of n unknowns. Throws NoConvergence if not all are found.
LanczosPairs lanczos(Eigen::Index n, const Operator& op, Largest which, int count,
                     double tolerance = tolerance_of_vectors);

/// The eigenvector of the largest eigenvalue, of length 1, to the first of these tolerances that is reached
/// within 200 restarts; nothing if none is.
std::optional<Vector> lanczos_largest(Eigen::Index n, const Operator& op,
                                      std::initializer_list<double> tolerances);

}  // namespace vbond
