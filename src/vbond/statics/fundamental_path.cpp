#include "vbond/statics/detail/fundamental_path.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/softest.hpp"

namespace vbond {
namespace {

/// The largest change of a bond in one step: a linear step is then off by about a tenth of itself.
constexpr double largest_bond_step = 0.1;

/// Of the stiffness of a smooth mode of length 1: entries are rounded to eps, and a tenth of that is left of
/// the sum over many (measured: columns of 20 to 320 bonds).
double rounding_of_stiffness(const SparseMatrix& K) {
  return 0.1 * std::numeric_limits<double>::epsilon() * Vector(K.diagonal()).cwiseAbs().maxCoeff();
}

}  // namespace

const Crossing* PathSample::crossing(int k) const {
  const std::vector<Crossing>& side = k < unstable ? behind : ahead;
  const auto n = static_cast<std::size_t>(k < unstable ? unstable - 1 - k : k - unstable);
  return n < side.size() ? &side[n] : nullptr;
}

PathSample FundamentalPath::begin(int count) {
  refuse_moments();
  const std::string& name = body_.stage().name;
  const std::optional<int> unstable = solver_.factor(body_);
  if (solver_.iterative())
    throw NoEquilibrium(name, "critical loads need the factors of the tangent, which are not made here",
                        "use solver = \"direct\", with memory enough, or a coarser body");
  if (unstable != 0)
    throw NoEquilibrium(
        name,
        fmt::format("at load factor 0, without the proportional loads, {}, first of all in: {}",
                    unstable ? "the body is not stable" : "the tangent stiffness is singular",
                    softest_names(body_, unstable.value_or(0))),
        "hold it, or find a stable balance by an equilibrium stage before this one");
  PathSample s{body_.placement(), 0, {}, {}};
  const Vector rate = solver_.solve(body_.load_direction());
  result_.smallest_eigenvalue = eigenpairs_near_zero(body_.tangent(), 1).values[0];
  if (body_.largest_bond_change(rate) == 0.0) return s;
  const SparseMatrix K = body_.tangent();
  const EigenPairs found = critical_factors(K, tangent_rate(rate), count);
  for (Eigen::Index k = 0; k < found.values.size(); ++k)
    s.ahead.push_back({found.values[k], 0.0, found.vectors.col(k)});
  return s;
}

std::optional<PathSample> FundamentalPath::look(const PathSample& from, double load_factor, int wanted) {
  body_.restore(from.at);
  if (!go_to(load_factor)) return std::nullopt;
  std::optional<int> unstable = solver_.factor(body_);
  if (!unstable) {  // singular to rounding: look from beside it
    if (!go_to(load_factor * (1 + 1e-6))) return std::nullopt;
    unstable = solver_.factor(body_);
  }
  refuse_moments();
  const Vector rate = solver_.solve(body_.load_direction());
  PathSample s{body_.placement(), unstable.value_or(0), {}, {}};
  for (Crossing& c : crossings(rate, wanted)) (c.change < 0.0 ? s.behind : s.ahead).push_back(std::move(c));
  std::reverse(s.behind.begin(), s.behind.end());
  return s;
}

void FundamentalPath::refuse_moments() const {
  if (body_.has_moment_part())
    throw NoEquilibrium(body_.stage().name,
                        fmt::format("at load factor {:.6g} a moment from outside acts on particles that are "
                                    "free to turn, by a load or by a support that holds some of their turns",
                                    body_.load_factor()),
                        "such a moment has no potential, and its critical value is not found by this stage: "
                        "apply a couple of forces, or follow the balance by kind = \"path\"");
}

bool FundamentalPath::go_to(double load_factor) {
  while (body_.load_factor() != load_factor) {
    if (hooks_.interrupted && hooks_.interrupted()) return false;
    solver_.factor(body_);
    const Vector rate = solver_.solve(body_.load_direction());
    const double change = load_factor - body_.load_factor();
    const double most = largest_bond_step / body_.largest_bond_change(rate);
    step(rate, std::abs(change) > most ? std::copysign(most, change) : change);
  }
  return true;
}

/// One step along the path's tangent, corrected; shorter if the correction is no small part of it, which
/// would be a jump to another balance.
void FundamentalPath::step(const Vector& rate, double change) {
  const double length = body_.unknowns().length();
  const Placement from = body_.placement();
  const double target = from.load_factor + change;
  for (double share = 1.0; share > 1e-4; share *= 0.5) {
    const double to = share == 1.0 ? target : from.load_factor + share * change;
    body_.move((to - from.load_factor) * rate, to);
    const Placement predicted = body_.placement();
    const NewtonOutcome corrected = correct(body_, solver_, body_.stage().newton);
    result_.iterations += corrected.iterations();
    const double moved = distance(from, predicted, length);
    if (corrected.converged && distance(predicted, body_.placement(), length) < 0.5 * moved + 1e-6 * length)
      return;
    body_.restore(from);
  }
  lost(rate, change);
}

/// The derivative of the tangent along the path, by a central difference over +-h. With 1/s the load factor
/// that would change a bond by 1, K' is about s K and its third derivative s^3 K: truncation is h^2 s^3 K /
/// 6, rounding eps K / h, and their sum is least near h = eps^(1/3) / s, where both are eps^(2/3) = 4e-11 of
/// K'.
SparseMatrix FundamentalPath::tangent_rate(const Vector& rate) {
  const double h = std::cbrt(std::numeric_limits<double>::epsilon()) / body_.largest_bond_change(rate);
  const Placement here = body_.placement();
  const auto tangent_at = [&](double change) {
    body_.restore(here);
    body_.move(change * rate, here.load_factor + change);
    return body_.tangent();
  };
  const SparseMatrix above = tangent_at(h), below = tangent_at(-h);
  body_.restore(here);
  return (above - below) / (2 * h);
}

/// The crossings at which stability is lost with growing load, in increasing order. Near one of them the
/// eigenvectors of the tangent for eigenvalues near zero hold all that matters of its mode.
std::vector<Crossing> FundamentalPath::crossings(const Vector& rate, int wanted) {
  const DenseMatrix soft =
      eigenpairs_near_zero(body_.tangent(), std::min(wanted, body_.unknowns().size())).vectors;
  // not the eigenvalues: of smooth modes they are small beside the rounding of the largest
  const DenseMatrix A = soft.transpose() * (body_.tangent() * soft);
  const DenseMatrix B = -soft.transpose() * (tangent_rate(rate) * soft);
  // neither A nor B is definite: the general form, whose result may be complex where there is no crossing
  const Eigen::GeneralizedEigenSolver<DenseMatrix> pencil(A, B);
  const double rounding = rounding_of_stiffness(body_.tangent());
  std::vector<Crossing> found;
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    const std::complex<double> alpha = pencil.alphas()[k];
    if (std::abs(alpha.imag()) > 1e-6 * std::abs(alpha) || pencil.betas()[k] == 0.0) continue;
    const Vector x = pencil.eigenvectors().col(k).real();
    const double softening = x.dot(B * x) / x.squaredNorm();
    if (softening <= 0.0) continue;  // stability comes back
    found.push_back({alpha.real() / pencil.betas()[k], rounding / softening, soft * x});
  }
  std::sort(found.begin(), found.end(),
            [](const Crossing& a, const Crossing& b) { return a.change < b.change; });
  return found;
}

/// Towards a limit point the rate r grows without bound along the mode whose stiffness vanishes there as the
/// square root of the load that is left: -(r.K r) / (r.K' r) is then twice that.
void FundamentalPath::lost(const Vector& rate, double change) {
  const double left = -0.5 * rate.dot(body_.tangent() * rate) / rate.dot(tangent_rate(rate) * rate);
  const std::string& name = body_.stage().name;
  if (left / change > 0.0 && left / change < 0.01)
    throw NoEquilibrium(
        name, fmt::format("the path has a limit point near load factor {:.6g}", body_.load_factor() + left),
        "use kind = \"path\"");
  throw NoEquilibrium(
      name, fmt::format("no balance was found next to that at load factor {:.6g}", body_.load_factor()),
      "use kind = \"path\" to see where the balance goes");
}

}  // namespace vbond
