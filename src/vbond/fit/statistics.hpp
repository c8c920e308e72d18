#pragma once
#include <cstddef>
#include <span>
#include <vector>

/// What a fit says of the values it found: pure functions of the Jacobian and the residuals, without runs.
namespace vbond::fit {

/// t with P(T <= t) = probability, of Student's distribution. 0 < probability < 1; dof > 0, infinite: the
/// normal distribution. By the incomplete beta function (Abramowitz and Stegun, 26.5.8, 26.7.1) and
/// bisection: to 1e-11 with few degrees of freedom; with very many, logarithms of the gamma function lose
/// digits.
double student_quantile(double probability, double dof);

/// A linear least-squares estimate around the values found.
struct Statistics {
  std::size_t points = 0;     ///< residuals
  std::size_t rank = 0;       ///< singular values above the criterion
  double criterion = 0;       ///< as it was given
  double sum_of_squares = 0;  ///< of the weighted residuals
  double dof = 0;             ///< points - rank
  double deviation = 0;       ///< sqrt(sum_of_squares / dof); NaN without any dof
  double quantile = 0;        ///< by how many standard errors an interval of 95 % reaches; NaN likewise
  std::vector<double> standard_error;   ///< of each value; NaN of one that is held or not determined
  std::vector<double> correlation;      ///< values x values of all, rows one after the other; NaN likewise
  std::vector<double> singular_values;  ///< of the free columns, each of length 1; descending
  std::vector<std::size_t> no_effect;   ///< values on which no point depends
  /// Sets of values that the points do not tell apart: one for each singular value below the criterion.
  std::vector<std::vector<std::size_t>> not_told_apart;
};

/// A singular value below this part of the largest counts as zero: two columns that are one differ by the
/// error of derivatives by differences. Ten times that error for steps of `difference` (SearchOptions): h^2
/// of central differences, but no less than 1e-6, and h where one side alone could be run.
double criterion_of(double difference, bool one_sided);

/// jacobian: points x values, d (curve / sigma) / d value, rows one after the other. residuals: (curve -
/// data) / sigma. held: of each value whether it is at a bound, and so no unknown. sigma_known: whether the
/// data came with standard deviations; if not they are all `deviation` times the sigma that was taken.
/// criterion: see criterion_of. negligible: a column no longer than this has no effect. Throws
/// std::invalid_argument if sizes do not fit.
///
/// The covariance is (J^T J)^-1, times deviation^2 if sigma is not known, over the directions whose singular
/// value is above the criterion. A value with a part of more than 1e-3 in another direction has no standard
/// error, which would be one of the regularisation.
Statistics statistics(std::span<const double> jacobian, std::span<const double> residuals,
                      const std::vector<char>& held, bool sigma_known, double criterion = 1e-5,
                      double negligible = 0);

}  // namespace vbond::fit
