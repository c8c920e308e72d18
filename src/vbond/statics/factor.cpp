#include "vbond/statics/detail/factor.hpp"

#include <cholmod.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

#include "vbond/statics/detail/blocked_factor.hpp"
#include "vbond/statics/detail/lost_pivot.hpp"
#include "vbond/statics/detail/pulse.hpp"
#include "vbond/statics/detail/without_threads.hpp"

namespace vbond {
namespace {

/// A matrix as CHOLMOD sees it: the same arrays, of which it reads the lower triangle.
cholmod_sparse view(const SparseMatrix& A) {
  cholmod_sparse v{};
  v.nrow = static_cast<std::size_t>(A.rows());
  v.ncol = static_cast<std::size_t>(A.cols());
  v.nzmax = static_cast<std::size_t>(A.data().size());
  v.p = const_cast<int*>(A.outerIndexPtr());
  v.i = const_cast<int*>(A.innerIndexPtr());
  v.x = const_cast<double*>(A.valuePtr());
  v.nz = const_cast<int*>(A.innerNonZeroPtr());
  v.stype = -1;
  v.itype = CHOLMOD_INT;
  v.xtype = CHOLMOD_REAL;
  v.dtype = CHOLMOD_DOUBLE;
  v.sorted = 1;
  v.packed = A.isCompressed() ? 1 : 0;
  return v;
}

cholmod_dense view(const Eigen::Ref<const DenseMatrix>& b) {
  cholmod_dense v{};
  v.nrow = v.d = static_cast<std::size_t>(b.rows());
  v.ncol = static_cast<std::size_t>(b.cols());
  v.nzmax = static_cast<std::size_t>(b.size());
  v.x = const_cast<double*>(b.data());
  v.xtype = CHOLMOD_REAL;
  v.dtype = CHOLMOD_DOUBLE;
  return v;
}

/// The columns of a simplicial L D L^T: D first in each, then L below it.
class Columns {
 public:
  explicit Columns(const cholmod_factor& L)
      : n_(static_cast<int>(L.n)),
        p_(static_cast<const int*>(L.p)),
        nz_(static_cast<const int*>(L.nz)),
        i_(static_cast<const int*>(L.i)),
        x_(static_cast<const double*>(L.x)) {}
  int columns() const { return n_; }
  double d(int j) const { return x_[p_[j]]; }
  /// Calls f(row, value) for what is below the diagonal.
  template <class F>
  void below(int j, F&& f) const {
    for (int at = p_[j] + 1; at < p_[j] + nz_[j]; ++at) f(i_[at], x_[at]);
  }

 private:
  int n_;
  const int *p_, *nz_, *i_;
  const double* x_;
};

/// The blocks of a supernodal analysis.
FactorBlocks blocks_of(const cholmod_factor& L) {
  const auto list = [](const void* from, std::size_t number) {
    const int* begin = static_cast<const int*>(from);
    return std::vector<int>(begin, begin + number);
  };
  return {list(L.super, L.nsuper + 1), list(L.pi, L.nsuper + 1), list(L.s, L.ssize), list(L.Perm, L.n)};
}

}  // namespace

struct Factor::Cholmod {
  enum class Kind { none, definite, indefinite };

  struct FreeFactor {
    cholmod_common* common;
    void operator()(cholmod_factor* L) const { cholmod_free_factor(&L, common); }
  };
  using FactorPointer = std::unique_ptr<cholmod_factor, FreeFactor>;

  Cholmod() {
    cholmod_start(&common);
    common.print = 0;
    common.quick_return_if_not_posdef = 1;
  }
  ~Cholmod() {
    symbolic.reset();
    numeric.reset();
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  FactorPointer own(cholmod_factor* L) { return {L, FreeFactor{&common}}; }

  void check(const char* doing) const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (common.status == CHOLMOD_TOO_LARGE)
      throw std::length_error("CHOLMOD: the factor has more than 2^31 entries");
    if (common.status < 0)
      throw std::runtime_error(fmt::format("CHOLMOD: error {} while {}", common.status, doing));
  }

  /// Makes `numeric` ready to hold a factor of this kind. Only one is kept: factors are large.
  void prepare(Kind wanted) {
    if (!symbolic) throw std::length_error("CHOLMOD: the factor has more than 2^31 entries");
    common.final_ll = wanted == Kind::definite;
    if (kind == wanted && (numeric || blocked)) return;
    kind = Kind::none;
    numeric.reset();
    blocked.reset();
    if (wanted == Kind::indefinite && symbolic->is_super) {
      blocked = std::make_unique<BlockedFactor>(blocks_of(*symbolic));
      kind = wanted;
      return;
    }
    numeric = own(cholmod_copy_factor(symbolic.get(), &common));
    check("copying the analysis");
    if (wanted == Kind::indefinite)
      cholmod_change_factor(CHOLMOD_PATTERN, 0, 0, 1, 1, numeric.get(), &common);
    check("changing the analysis");
    kind = wanted;
  }

  void factorize(const SparseMatrix& A, double shift) {
    cholmod_sparse a = view(A);
    const WithoutThreads alone;
    ++made;
    double beta[2] = {shift, 0.0};
    common.status = CHOLMOD_OK;
    cholmod_factorize_p(&a, beta, nullptr, 0, numeric.get(), &common);
    check("factoring");
  }

  int original(int k) const { return static_cast<const int*>(symbolic->Perm)[k]; }

  /// Of L D L^T; nothing if an entry of D is zero to rounding, and `singular` is its unknown.
  template <class L>
  std::optional<int> negative_pivots(const L& columns) {
    if (const int k = lost_pivot(columns); k >= 0) {
      singular = original(k);
      return std::nullopt;
    }
    int negative = 0;
    for (int j = 0; j < columns.columns(); ++j) negative += columns.d(j) < 0.0;
    return negative;
  }

  std::optional<int> factorize_blocked(const SparseMatrix& A, double shift) {
    ++made;
    if (blocked->factorize(A, shift)) return negative_pivots(*blocked);
    singular = original(blocked->zero_pivot());
    return std::nullopt;
  }

  std::optional<int> factorize_simplicial(const SparseMatrix& A, double shift) {
    factorize(A, shift);
    if (numeric->minor == numeric->n) return negative_pivots(Columns(*numeric));
    singular = original(static_cast<int>(numeric->minor));  // an exact zero
    return std::nullopt;
  }

  DenseMatrix solve_once(const Eigen::Ref<const DenseMatrix>& b, int system = CHOLMOD_A) {
    if (blocked) return blocked->solve(b);
    const WithoutThreads alone;
    cholmod_dense rhs = view(b);
    cholmod_dense* x = cholmod_solve(system, numeric.get(), &rhs, &common);
    check("solving");
    DenseMatrix result = Eigen::Map<const DenseMatrix>(static_cast<const double*>(x->x), b.rows(), b.cols());
    cholmod_free_dense(&x, &common);
    return result;
  }

  cholmod_common common{};
  Kind kind = Kind::none;
  FactorPointer symbolic{nullptr, FreeFactor{&common}};
  FactorPointer numeric{nullptr, FreeFactor{&common}};
  std::unique_ptr<BlockedFactor> blocked;  // instead of `numeric`: indefinite, of a supernodal analysis
  double bytes = 0;
  bool empty = false;  // no unknowns
  int made = 0;        // factors
  int singular = -1;
  SparseMatrix kept_A;  // indefinite: for the residual of the refinement
  double kept_shift = 0;
};

Factor::Factor() : c_(std::make_unique<Cholmod>()) {}
Factor::~Factor() = default;
Factor::Factor(Factor&&) noexcept = default;
Factor& Factor::operator=(Factor&&) noexcept = default;

void Factor::analyse(const SparseMatrix& A) {
  Cholmod& c = *c_;
  c.numeric.reset();
  c.blocked.reset();
  c.symbolic.reset();
  c.kind = Cholmod::Kind::none;
  c.empty = A.rows() == 0;
  c.bytes = 0;
  if (c.empty) return;  // CHOLMOD refuses it
  cholmod_sparse a = view(A);
  c.common.status = CHOLMOD_OK;
  c.symbolic = c.own(cholmod_analyze(&a, &c.common));
  if (c.common.status == CHOLMOD_TOO_LARGE) {
    c.symbolic.reset();
    c.bytes = std::numeric_limits<double>::infinity();
    return;
  }
  c.check("analysing the pattern");
  const double simplicial = c.common.lnz * (sizeof(double) + sizeof(int));
  const double supernodal = static_cast<double>(c.symbolic->xsize) * sizeof(double);
  c.bytes = std::max(simplicial, supernodal);
}

void Factor::analyse_as(const Factor& other) {
  const Cholmod& from = *other.c_;
  *this = Factor();
  Cholmod& c = *c_;
  c.empty = from.empty, c.bytes = from.bytes;
  c.common.lnz = from.common.lnz, c.common.fl = from.common.fl;
  if (!from.symbolic) return;
  c.symbolic = c.own(cholmod_copy_factor(from.symbolic.get(), &c.common));
  c.check("copying the analysis");
}

Factor analysed(const SparseMatrix& A, const Factor* of_same_pattern) {
  Factor factor;
  if (of_same_pattern)
    factor.analyse_as(*of_same_pattern);
  else
    factor.analyse(A);
  return factor;
}

double Factor::bytes() const {
  return c_->bytes;
}

bool Factor::factor_definite(const SparseMatrix& A, double shift) {
  Cholmod& c = *c_;
  if (c.empty) return true;
  Pulse::factor();
  c.prepare(Cholmod::Kind::definite);
  c.factorize(A, shift);
  // A pivot below rounding of the largest may be a zero that came out positive by chance.
  return c.common.status == CHOLMOD_OK && c.numeric->minor == c.numeric->n &&
         cholmod_rcond(c.numeric.get(), &c.common) > epsilon;
}

std::optional<int> Factor::factor_indefinite(const SparseMatrix& A, double shift) {
  Cholmod& c = *c_;
  if (c.empty) return 0;
  Pulse::factor();
  c.prepare(Cholmod::Kind::indefinite);
  c.singular = -1;
  const std::optional<int> negative =
      c.blocked ? c.factorize_blocked(A, shift) : c.factorize_simplicial(A, shift);
  if (!negative) return std::nullopt;
  c.kept_A = A;
  c.kept_shift = shift;
  return negative;
}

double Factor::cost_in_solutions() const {
  return c_->common.fl / (35.0 * std::max(1.0, c_->common.lnz));
}

double Factor::operations() const {
  return c_->common.fl;
}

int Factor::made() const {
  return c_->made;
}

int Factor::singular_unknown() const {
  return c_->singular;
}

Vector Factor::solve(const Vector& b) const {
  Cholmod& c = *c_;
  if (c.empty) return b;
  Pulse::solution();
  Vector x = c.solve_once(b);
  if (c.kind == Cholmod::Kind::indefinite) {
    const Vector left = b - c.kept_A.selfadjointView<Eigen::Lower>() * x - c.kept_shift * x;
    x += c.solve_once(left);
  }
  return x;
}

Vector Factor::half_solve(const Vector& b) const {
  return c_->empty ? b : Vector(c_->solve_once(c_->solve_once(b, CHOLMOD_P), CHOLMOD_L));
}

Vector Factor::other_half_solve(const Vector& y) const {
  return c_->empty ? y : Vector(c_->solve_once(c_->solve_once(y, CHOLMOD_Lt), CHOLMOD_Pt));
}

DenseMatrix Factor::solve_columns(const DenseMatrix& B) const {
  Pulse::solution();
  return c_->empty ? B : c_->solve_once(B);
}

bool Factor::copy_to(SingleFactor& single) const {
  if (c_->kind != Cholmod::Kind::definite || !c_->numeric || !c_->numeric->is_super) return false;
  const cholmod_factor& L = *c_->numeric;
  const int* from = static_cast<const int*>(L.px);
  single.take(blocks_of(L), {from, from + L.nsuper}, static_cast<const double*>(L.x));
  return true;
}

}  // namespace vbond
