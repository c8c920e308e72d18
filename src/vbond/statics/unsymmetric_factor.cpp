#include "vbond/statics/detail/unsymmetric_factor.hpp"

#include <fmt/format.h>
#include <umfpack.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <stdexcept>

#include "vbond/statics/detail/one_blas_thread.hpp"

namespace vbond {
namespace {

bool same_pattern(const SparseMatrix& A, const SparseMatrix& B) {
  return A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

}  // namespace

struct UnsymmetricFactor::Umfpack {
  Umfpack() { umfpack_di_defaults(control.data()); }
  ~Umfpack() { drop(true); }
  Umfpack(const Umfpack&) = delete;
  Umfpack& operator=(const Umfpack&) = delete;

  void drop(bool symbolic_too) {
    sign = 0;
    if (numeric != nullptr) umfpack_di_free_numeric(&numeric);
    if (symbolic_too && symbolic != nullptr) umfpack_di_free_symbolic(&symbolic);
  }
  static void check(int status, const char* doing) {
    if (status == UMFPACK_ERROR_out_of_memory) throw std::bad_alloc();
    if (status < 0) throw std::runtime_error(fmt::format("UMFPACK: error {} while {}", status, doing));
  }

  std::array<double, UMFPACK_CONTROL> control{};
  std::array<double, UMFPACK_INFO> info{};
  SparseMatrix A;
  void* symbolic = nullptr;
  void* numeric = nullptr;
  int sign = 0, made = 0;
};

UnsymmetricFactor::UnsymmetricFactor() : u_(std::make_unique<Umfpack>()) {}
UnsymmetricFactor::~UnsymmetricFactor() = default;
UnsymmetricFactor::UnsymmetricFactor(UnsymmetricFactor&&) noexcept = default;
UnsymmetricFactor& UnsymmetricFactor::operator=(UnsymmetricFactor&&) noexcept = default;

bool UnsymmetricFactor::factor(const SparseMatrix& A) {
  Umfpack& u = *u_;
  const OneBlasThread alone;
  SparseMatrix next = A;
  next.makeCompressed();
  const bool known = u.symbolic != nullptr && same_pattern(u.A, next);
  u.drop(!known);
  u.A = std::move(next);
  ++u.made;
  const int n = static_cast<int>(u.A.rows());
  if (n == 0) return true;
  const int *p = u.A.outerIndexPtr(), *i = u.A.innerIndexPtr();
  const double* x = u.A.valuePtr();
  if (!std::all_of(x, x + u.A.nonZeros(), [](double entry) { return std::isfinite(entry); })) return false;
  if (!known)
    Umfpack::check(umfpack_di_symbolic(n, n, p, i, x, &u.symbolic, u.control.data(), u.info.data()),
                   "analysing the pattern");
  const int status = umfpack_di_numeric(p, i, x, u.symbolic, &u.numeric, u.control.data(), u.info.data());
  Umfpack::check(status, "factoring");
  // a pivot near rounding of the largest may be a zero that came out otherwise by chance
  if (status == UMFPACK_WARNING_singular_matrix || !(u.info[UMFPACK_RCOND] > 16.0 * epsilon)) return false;
  double mantissa = 0.0, exponent = 0.0;
  Umfpack::check(umfpack_di_get_determinant(&mantissa, &exponent, u.numeric, u.info.data()),
                 "taking the determinant");
  u.sign = mantissa < 0.0 ? -1 : 1;
  return true;
}

int UnsymmetricFactor::sign() const {
  return u_->sign;
}

int UnsymmetricFactor::made() const {
  return u_->made;
}

Vector UnsymmetricFactor::solve(const Vector& b) const {
  Umfpack& u = *u_;
  if (u.A.rows() == 0) return b;
  const OneBlasThread alone;
  Vector x(b.size());
  std::array<double, UMFPACK_INFO> info{};
  const int status = umfpack_di_solve(UMFPACK_A, u.A.outerIndexPtr(), u.A.innerIndexPtr(), u.A.valuePtr(),
                                      x.data(), b.data(), u.numeric, u.control.data(), info.data());
  Umfpack::check(status, "solving");
  return x;
}

}  // namespace vbond
