#include "vbond/statics/elastic_constants.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "vbond/statics/detail/dense.hpp"

namespace vbond {
namespace {

using Six = std::array<double, 6>;

/// The strain (a b + b a)/2 in Voigt's order, with engineering shear.
Six strain_of(const Vec3d& a, const Vec3d& b) {
  return {
      a.x * b.x, a.y * b.y, a.z * b.z, a.y * b.z + a.z * b.y, a.x * b.z + a.z * b.x, a.x * b.y + a.y * b.x};
}
/// The stress a_i b_j in this order, which has each shear once.
Six stress_of(const Vec3d& a, const Vec3d& b) {
  Six s = strain_of(a, b);
  for (std::size_t k = 3; k < 6; ++k) s[k] *= 0.5;
  return s;
}
double form(const Six& x, const Constants& A, const Six& y) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) sum += x[i] * A[i][j] * y[j];
  return sum;
}
/// Sums over the diagonal of stretches, beside it, and of shears.
struct Sums {
  double along, across, shear;
};
Sums sums_of(const Constants& A) {
  return {A[0][0] + A[1][1] + A[2][2], A[0][1] + A[1][2] + A[0][2], A[3][3] + A[4][4] + A[5][5]};
}
IsotropicConstants voigt_of(const Constants& C) {
  const auto [along, across, shear] = sums_of(C);
  return {(along + 2.0 * across) / 9.0, (along - across + 3.0 * shear) / 15.0};
}
/// 1/K and 1/G.
IsotropicConstants inverse_reuss_of(const Constants& S) {
  const auto [along, across, shear] = sums_of(S);
  return {along + 2.0 * across, (4.0 * along - 4.0 * across + 3.0 * shear) / 15.0};
}
Vec3d direction_of(const Vec3d& a) {
  if (!(is_finite(a) && norm(a) > 0.0))
    throw std::invalid_argument("elastic constants: a direction is zero or not finite");
  return normalised(a);
}
/// n is a unit vector.
Vec3d normal_to(const Vec3d& n, const Vec3d& b) {
  const Vec3d unit = direction_of(b), m = across(unit, n);
  if (!(norm(m) > 1e-8)) throw std::invalid_argument("elastic constants: two directions are the same");
  return normalised(m);
}
/// Any unit vector across the unit vector n.
Vec3d some_normal(const Vec3d& n) {
  return normal_to(n, std::abs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0});
}
/// Across the unit vector n, the directions in which f is least and largest: f(m) is quadratic in unit
/// vectors m, so at the angle t from e_1 it is a + b cos 2t + c sin 2t. Which ones does not matter where b =
/// c = 0.
template <class Quadratic>
std::pair<Vec3d, Vec3d> extremes_across(const Vec3d& n, const Quadratic& f) {
  const Vec3d e_1 = some_normal(n), e_2 = cross(n, e_1);
  const double f_1 = f(e_1), f_2 = f(e_2), b = 0.5 * (f_1 - f_2), c = f(e_1 + e_2) - 0.5 * (f_1 + f_2),
               t = 0.5 * std::atan2(c, b);
  const Vec3d largest = std::cos(t) * e_1 + std::sin(t) * e_2;
  return {cross(n, largest), largest};
}

}  // namespace

ElasticConstants::ElasticConstants(const Constants& C) : C_(C) {
  constexpr double rounding = 1e-6;
  double largest = 0.0;
  for (const Six& row : C)
    for (const double x : row) largest = std::isfinite(x) ? std::max(largest, std::abs(x)) : HUGE_VAL;
  DenseMatrix M(6, 6);
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      if (!(std::abs(C[i][j] - C[j][i]) <= rounding * largest))
        throw std::invalid_argument("elastic constants must be finite and symmetric");
      C_[i][j] = M(Eigen::Index(i), Eigen::Index(j)) = 0.5 * (C[i][j] + C[j][i]);
    }
  const DenseEigen e = dense_eigenpairs(M);
  if (!e.found || !(e.values[0] > epsilon * largest))
    throw std::invalid_argument("elastic constants must be positive definite: some strain has no stiffness");
  const DenseMatrix inverse = e.vectors * e.values.cwiseInverse().asDiagonal() * e.vectors.transpose();
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) S_[i][j] = inverse(Eigen::Index(i), Eigen::Index(j));
}

IsotropicConstants ElasticConstants::voigt() const {
  return voigt_of(C_);
}

IsotropicConstants ElasticConstants::reuss() const {
  const auto [K, G] = inverse_reuss_of(S_);
  return {1.0 / K, 1.0 / G};
}

IsotropicConstants ElasticConstants::hill() const {
  const IsotropicConstants v = voigt(), r = reuss();
  return {0.5 * (v.K + r.K), 0.5 * (v.G + r.G)};
}

/// dS = -S dC S; 1/K_R and 15/G_R are linear in S, as K_V and G_V are in C.
ElasticConstants::Change ElasticConstants::hill_change(const Constants& C) const {
  Constants change = C, S{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      change[i][j] = 0.5 * (C[i][j] + C[j][i]);
      for (std::size_t k = 0; k < 6; ++k)
        for (std::size_t l = 0; l < 6; ++l) S[i][j] -= S_[i][k] * 0.5 * (C[k][l] + C[l][k]) * S_[l][j];
    }
  const IsotropicConstants v = voigt_of(change), r = reuss(), h = hill();
  const auto [dK_inverse, dG_inverse] = inverse_reuss_of(S);
  const double dK = 0.5 * (v.K - r.K * r.K * dK_inverse), dG = 0.5 * (v.G - r.G * r.G * dG_inverse),
               E_K = h.E() / h.K - 3.0 * h.E() / (3.0 * h.K + h.G),
               E_G = h.E() / h.G - h.E() / (3.0 * h.K + h.G), d = 2.0 * (3.0 * h.K + h.G) * (3.0 * h.K + h.G);
  return {E_K * dK + E_G * dG, 9.0 * (h.G * dK - h.K * dG) / d};
}

double ElasticConstants::anisotropy() const {
  const IsotropicConstants v = voigt(), r = reuss();
  return 5.0 * v.G / r.G + v.K / r.K - 6.0;
}

double ElasticConstants::youngs_modulus(const Vec3d& along) const {
  const Vec3d n = direction_of(along);
  const Six s = stress_of(n, n);
  return 1.0 / form(s, S_, s);
}

double ElasticConstants::poissons_ratio(const Vec3d& along, const Vec3d& across) const {
  const Vec3d n = direction_of(along), m = normal_to(n, across);
  const Six s = stress_of(n, n);
  return -form(stress_of(m, m), S_, s) / form(s, S_, s);
}

double ElasticConstants::shear_modulus(const Vec3d& a, const Vec3d& b) const {
  const Vec3d n = direction_of(a), m = normal_to(n, b);
  const Six s = strain_of(n, m);  // the stress n m + m n, of size 1 in their plane
  Six stress = s;
  for (std::size_t k = 0; k < 3; ++k) stress[k] *= 2.0;
  return 1.0 / form(stress, S_, stress);
}

Extremes ElasticConstants::shear_moduli(const Vec3d& along) const {
  const Vec3d n = direction_of(along);
  const auto [stiff, soft] = extremes_across(n, [&](const Vec3d& m) { return 1.0 / shear_modulus(n, m); });
  return {{shear_modulus(n, soft), soft}, {shear_modulus(n, stiff), stiff}};
}

Extremes ElasticConstants::poissons_ratios(const Vec3d& along) const {
  const Vec3d n = direction_of(along);
  const auto [least, largest] = extremes_across(n, [&](const Vec3d& m) { return poissons_ratio(n, m); });
  return {{poissons_ratio(n, least), least}, {poissons_ratio(n, largest), largest}};
}

/// On half a sphere points of a spiral, which lie some 0.025 apart; from the best of them with ever smaller
/// steps across. The modulus is a smooth function of the fourth degree, whose extremes are farther apart.
Directed ElasticConstants::extreme(bool largest) const {
  constexpr int points = 10000;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const auto better = [largest](double x, double than) { return largest ? x > than : x < than; };
  Directed best;
  for (int k = 0; k < points; ++k) {
    const double z = (k + 0.5) / points, r = std::sqrt(1.0 - z * z);
    const Vec3d n{r * std::cos(golden * k), r * std::sin(golden * k), z};
    if (const double E = youngs_modulus(n); k == 0 || better(E, best.value)) best = {E, n};
  }
  for (double step = 0.02; step > 1e-9;) {
    const Vec3d a = some_normal(best.along), b = cross(best.along, a);
    Directed next = best;
    for (const Vec3d& way : {a, -a, b, -b}) {
      const Vec3d n = normalised(best.along + step * way);
      if (const double E = youngs_modulus(n); better(E, next.value)) next = {E, n};
    }
    if (next.value == best.value) step *= 0.5;
    best = next;
  }
  return best;
}

WaveSpeeds ElasticConstants::wave_speeds(const Vec3d& along, double density) const {
  if (!(density > 0.0)) throw std::invalid_argument("wave speeds: the density must be > 0");
  const Vec3d n = direction_of(along);
  const std::array<Vec3d, 3> axis{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  DenseMatrix acoustic(3, 3);  // of Christoffel: strains n e_i, with engineering shear
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      acoustic(Eigen::Index(i), Eigen::Index(j)) = form(strain_of(n, axis[i]), C_, strain_of(n, axis[j]));
  const DenseEigen e = dense_eigenpairs(acoustic);
  WaveSpeeds speeds;
  for (Eigen::Index k = 0; k < 3; ++k)
    speeds[std::size_t(k)] = {std::sqrt(e.values[k] / density),
                              {e.vectors(0, k), e.vectors(1, k), e.vectors(2, k)}};
  return speeds;
}

}  // namespace vbond
