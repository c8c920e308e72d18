#include "vbond/statics/detail/lanczos.hpp"

#include <Spectra/SymEigsSolver.h>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

constexpr int most_restarts = 1000;

int basis_size(int count, Eigen::Index n) {
  return static_cast<int>(std::min<Eigen::Index>(n, std::max(2 * count + 20, 40)));
}

Spectra::SortRule rule_of(Largest which) {
  return which == Largest::value ? Spectra::SortRule::LargestAlge : Spectra::SortRule::LargestMagn;
}

/// An operator as Spectra calls it.
struct Applied {
  using Scalar = double;
  Eigen::Index rows() const { return n; }
  Eigen::Index cols() const { return n; }
  void perform_op(const double* in, double* out) const { op(in, out); }
  Eigen::Index n;
  const Operator& op;
};

template <class Solver>
LanczosPairs iterate(Solver& solver, Largest which, int count, Eigen::Index n, double tolerance) {
  int converged = 0;
  try {
    solver.init();
    converged = static_cast<int>(solver.compute(rule_of(which), most_restarts, tolerance));
  } catch (const std::exception& e) {  // Spectra's: of vectors of length 0, or of numbers that are not finite
    throw NoConvergence(fmt::format("eigenvalues of a matrix of {} unknowns: {}", n, e.what()));
  }
  if (converged < count)
    throw NoConvergence(
        fmt::format("eigenvalues of a matrix of {} unknowns: {} of {} converged within {} restarts", n,
                    converged, count, most_restarts));
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

LanczosPairs lanczos(Eigen::Index n, const Operator& op, Largest which, int count, double tolerance) {
  Applied applied{n, op};
  Spectra::SymEigsSolver<Applied> solver(applied, count, basis_size(count, n));
  return iterate(solver, which, count, n, tolerance);
}

std::optional<Vector> lanczos_largest(Eigen::Index n, const Operator& op,
                                      std::initializer_list<double> tolerances) {
  Applied applied{n, op};
  Spectra::SymEigsSolver<Applied> solver(applied, 1, basis_size(1, n));
  solver.init();
  for (const double tolerance : tolerances)
    if (solver.compute(Spectra::SortRule::LargestAlge, 200, tolerance) == 1)
      return Vector(solver.eigenvectors().col(0).normalized());
  return {};
}

}  // namespace vbond
