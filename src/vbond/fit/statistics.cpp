#include "vbond/fit/statistics.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace vbond::fit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// The continued fraction of the incomplete beta function, by the modified method of Lentz.
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  const auto away_from_zero = [](double v) { return std::abs(v) < tiny ? tiny : v; };
  double c = 1, d = 1 / away_from_zero(1 - (a + b) * x / (a + 1)), sum = d;
  for (int m = 1; m < 1000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                 odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double factor = 1;
    for (const double step : {even, odd}) {
      d = 1 / away_from_zero(1 + step * d);
      c = away_from_zero(1 + step / c);
      factor = c * d;
      sum *= factor;
    }
    if (std::abs(factor - 1) < 1e-16) break;
  }
  return sum;
}

/// The regularised incomplete beta function.
double incomplete_beta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a
                                   : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

/// P(T > t), t >= 0.
double upper_tail(double t, double dof) {
  if (std::isinf(dof)) return 0.5 * std::erfc(t / std::sqrt(2.0));
  return 0.5 * incomplete_beta(0.5 * dof, 0.5, dof / (dof + t * t));
}

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The free columns that have an effect, each of length 1.
struct Scaled {
  std::vector<std::size_t> column;  ///< which values they belong to
  std::vector<double> length;
  Matrix J;
};

Scaled scaled_columns(const Eigen::Map<const Matrix>& J, const std::vector<char>& held, double negligible,
                      Statistics& s) {
  Scaled free;
  for (std::size_t j = 0; j < held.size(); ++j) {
    if (held[j] != 0) continue;
    const double length = J.col(static_cast<Eigen::Index>(j)).norm();
    if (length <= negligible) {
      s.no_effect.push_back(j);
      continue;
    }
    free.column.push_back(j), free.length.push_back(length);
  }
  free.J.resize(J.rows(), static_cast<Eigen::Index>(free.column.size()));
  for (std::size_t k = 0; k < free.column.size(); ++k)
    free.J.col(static_cast<Eigen::Index>(k)) =
        J.col(static_cast<Eigen::Index>(free.column[k])) / free.length[k];
  return free;
}

}  // namespace

double student_quantile(double probability, double dof) {
  if (!(probability > 0 && probability < 1) || !(dof > 0))
    throw std::invalid_argument("a quantile takes 0 < probability < 1 and dof > 0");
  if (probability < 0.5) return -student_quantile(1 - probability, dof);
  const double tail = 1 - probability;
  double low = 0, high = 1;
  while (upper_tail(high, dof) > tail && high < 1e300) low = high, high *= 2;
  for (int k = 0; k < 200 && high - low > 1e-13 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (upper_tail(middle, dof) > tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double criterion_of(double difference, bool one_sided) {
  return one_sided ? 10 * difference : std::max(1e-5, 10 * difference * difference);
}

Statistics statistics(std::span<const double> jacobian, std::span<const double> residuals,
                      const std::vector<char>& held, bool sigma_known, double criterion, double negligible) {
  const std::size_t n = held.size(), m = residuals.size();
  if (jacobian.size() != m * n) throw std::invalid_argument("a Jacobian has a row for each residual");
  Statistics s;
  s.points = m, s.criterion = criterion;
  for (const double r : residuals) s.sum_of_squares += r * r;
  const auto count_dof = [&] {
    s.dof = static_cast<double>(m) - static_cast<double>(s.rank);
    s.deviation = s.dof > 0 ? std::sqrt(s.sum_of_squares / s.dof) : none;
    const double of_quantile = sigma_known ? std::numeric_limits<double>::infinity() : s.dof;
    s.quantile = of_quantile > 0 ? student_quantile(0.975, of_quantile) : none;
  };
  count_dof();
  s.standard_error.assign(n, none), s.correlation.assign(n * n, none);
  const Eigen::Map<const Matrix> J(jacobian.data(), static_cast<Eigen::Index>(m),
                                   static_cast<Eigen::Index>(n));
  const Scaled free = scaled_columns(J, held, negligible, s);
  const auto k = static_cast<Eigen::Index>(free.column.size());
  if (k == 0 || m == 0) return s;

  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(free.J, Eigen::ComputeThinU | Eigen::ComputeFullV);
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(k);  // fewer points than values: the others are zero
  sigma.head(svd.singularValues().size()) = svd.singularValues();
  s.singular_values.assign(sigma.data(), sigma.data() + k);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(k, k);
  Eigen::VectorXd lost = Eigen::VectorXd::Zero(k);
  for (Eigen::Index d = 0; d < k; ++d) {
    const Eigen::VectorXd v = svd.matrixV().col(d);
    if (sigma[d] > criterion * sigma[0]) {
      ++s.rank;
      covariance += v * v.transpose() / (sigma[d] * sigma[d]);
      continue;
    }
    std::vector<std::size_t> together;
    for (Eigen::Index j = 0; j < k; ++j) {
      lost[j] = std::max(lost[j], std::abs(v[j]));
      if (std::abs(v[j]) > 1e-3) together.push_back(free.column[static_cast<std::size_t>(j)]);
    }
    s.not_told_apart.push_back(std::move(together));
  }
  count_dof();
  const auto known = [&](Eigen::Index j) { return lost[j] <= 1e-3; };
  for (Eigen::Index i = 0; i < k; ++i)
    for (Eigen::Index j = 0; j < k; ++j) {
      if (!known(i) || !known(j)) continue;
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      s.correlation[free.column[a] * n + free.column[b]] =
          i == j ? 1 : covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
      if (i == j)
        s.standard_error[free.column[a]] =
            std::sqrt(covariance(i, i)) / free.length[a] * (sigma_known ? 1.0 : s.deviation);
    }
  return s;
}

}  // namespace vbond::fit
