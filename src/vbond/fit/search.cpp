#include "vbond/fit/search.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>

#include "vbond/fit/residuals.hpp"

namespace vbond::fit {
namespace {

/// The residuals over some of the unknowns, with the others held, as the solver takes them.
class FreeResiduals final : public ceres::CostFunction {
 public:
  FreeResiduals(Residuals& residuals, const std::vector<double>& u, const std::vector<std::size_t>& free)
      : residuals_(residuals), u_(u), free_(free) {
    set_num_residuals(static_cast<int>(residuals.points()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(free.size()));
  }
  std::vector<double> all(const double* free) const {
    std::vector<double> u = u_;
    for (std::size_t k = 0; k < free_.size(); ++k) u[free_[k]] = free[k];
    return u;
  }
  /// What is thrown is kept: the solver passes no exceptions on.
  bool Evaluate(double const* const* free, double* r_out, double** J_out) const override {
    if (residuals_.failure || residuals_.interrupted()) return false;
    try {
      const std::vector<double> u = all(free[0]);
      std::vector<double> r, J;
      if (!residuals_.at(u, r)) return false;
      std::copy(r.begin(), r.end(), r_out);
      if (J_out == nullptr || J_out[0] == nullptr) return true;
      if (!residuals_.derivatives(u, r, free_, J)) return false;
      std::copy(J.begin(), J.end(), J_out[0]);
      return true;
    } catch (...) {
      residuals_.failure = std::current_exception();
      return false;
    }
  }

 private:
  Residuals& residuals_;
  const std::vector<double>& u_;
  const std::vector<std::size_t>& free_;
};

/// The search from where it stands, with some unknowns held at their bounds. It ends early where another one
/// comes to a bound: a step that goes on against it would be wrong for all the others as well.
class Leg final : public ceres::IterationCallback {
 public:
  Leg(const Unknowns& unknowns, Residuals& residuals, const SearchOptions& options, Found& found,
      const std::vector<double>& u, const std::vector<std::size_t>& free)
      : unknowns_(unknowns),
        residuals_(residuals),
        options_(options),
        found_(found),
        free_(free),
        cost_(residuals, u, free) {
    for (const std::size_t j : free) at_.push_back(u[j]), began_at_bound_.push_back(at_bound(j, u[j]));
  }

  ceres::Solver::Summary run() {
    residuals_.accepted_since_failure = 1000;
    ceres::Problem::Options owned;
    owned.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(owned);
    problem.AddResidualBlock(&cost_, nullptr, at_.data());
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const double low = unknowns_.low(free_[k]), high = unknowns_.high(free_[k]);
      if (std::isfinite(low)) problem.SetParameterLowerBound(at_.data(), static_cast<int>(k), low);
      if (std::isfinite(high)) problem.SetParameterUpperBound(at_.data(), static_cast<int>(k), high);
    }
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options(), &problem, &summary);
    return summary;
  }
  std::vector<double> end() const { return cost_.all(at_.data()); }
  bool hit() const { return hit_; }

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& s) override {
    const bool accepted = s.iteration == 0 || s.step_is_successful,
               again = s.iteration == 0 && !found_.iterations.empty();
    if (!again) {
      const int number = found_.iterations.empty() ? 0 : found_.iterations.back().number + 1;
      found_.iterations.push_back({number, 2 * s.cost, accepted, unknowns_.values(end().data())});
      if (options_.tell) options_.tell(found_.iterations.back());
    }
    if (residuals_.failure || residuals_.interrupted()) return ceres::SOLVER_ABORT;
    if (accepted && s.iteration > 0) ++residuals_.accepted_since_failure;
    for (std::size_t k = 0; k < free_.size() && accepted && s.iteration > 0; ++k)
      hit_ = hit_ || (began_at_bound_[k] == 0 && at_bound(free_[k], at_[k]));
    return hit_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  bool at_bound(std::size_t j, double u) const { return u == unknowns_.low(j) || u == unknowns_.high(j); }
  ceres::Solver::Options solver_options() {
    ceres::Solver::Options o;
    o.minimizer_type = ceres::TRUST_REGION;
    o.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
    o.linear_solver_type = ceres::DENSE_QR;
    o.num_threads = 1;
    o.max_num_iterations =
        options_.most_iterations - (found_.iterations.empty() ? 0 : found_.iterations.back().number);
    o.max_num_line_search_step_size_iterations = 0;  // it would take derivatives at points that are given up
    o.max_num_consecutive_invalid_steps = 20;        // runs that fail: each step is then half as long or less
    o.function_tolerance = 1e-12, o.parameter_tolerance = 1e-10, o.gradient_tolerance = 1e-14;
    o.update_state_every_iteration = true;
    o.callbacks.push_back(this);
    o.logging_type = ceres::SILENT;
    return o;
  }

  const Unknowns& unknowns_;
  Residuals& residuals_;
  const SearchOptions& options_;
  Found& found_;
  const std::vector<std::size_t>& free_;
  FreeResiduals cost_;
  std::vector<double> at_;
  std::vector<char> began_at_bound_;
  bool hit_ = false;
};

SearchEnd end_of(const ceres::Solver::Summary& s, const Residuals& residuals) {
  if (residuals.interrupted()) return SearchEnd::interrupted;
  switch (s.termination_type) {
    case ceres::CONVERGENCE:
    case ceres::USER_SUCCESS: return SearchEnd::converged;
    case ceres::NO_CONVERGENCE: return SearchEnd::iterations;
    case ceres::FAILURE:
    case ceres::USER_FAILURE: break;
  }
  return residuals.no_derivative ? SearchEnd::no_derivative : SearchEnd::no_better;
}

/// The unknowns that the sum of squares would not push beyond their bounds.
std::vector<std::size_t> free_of(const Unknowns& unknowns, const std::vector<double>& u,
                                 const std::vector<double>& r, const std::vector<double>& J) {
  std::vector<std::size_t> free;
  for (std::size_t j = 0; j < u.size(); ++j) {
    double gradient = 0;
    for (std::size_t i = 0; i < r.size(); ++i) gradient += J[i * u.size() + j] * r[i];
    const bool held =
        (u[j] == unknowns.low(j) && gradient >= 0) || (u[j] == unknowns.high(j) && gradient <= 0);
    if (!held) free.push_back(j);
  }
  return free;
}

/// The free values that would lower the sum of squares, where runs that fail keep the search from it. The
/// cosine of the angle between the residuals and the column of a value is 0 at a minimum. At 1e-3 the value
/// is 1e-3 sqrt(points) of its standard errors from where it would go.
void tell_held(const std::vector<std::size_t>& free, std::size_t unknowns, Found& found) {
  found.held.assign(unknowns, 0);
  for (const std::size_t j : free) {
    double Jr = 0, JJ = 0, rr = 0;
    for (std::size_t i = 0; i < found.residuals.size(); ++i) {
      const double r = found.residuals[i], slope = found.jacobian[i * unknowns + j];
      Jr += slope * r, JJ += slope * slope, rr += r * r;
    }
    if (std::abs(Jr) > 1e-3 * std::sqrt(JJ * rr)) found.held[j] = 1, found.end = SearchEnd::held;
  }
}

/// Leg by leg, until a leg comes to its own end and the same values are held as before.
void go(const Unknowns& unknowns, Residuals& residuals, const SearchOptions& options, std::vector<double>& u,
        Found& found) {
  std::vector<std::size_t> all, free;
  for (std::size_t j = 0; j < unknowns.size(); ++j) all.push_back(j);
  bool ended = false;
  for (;;) {
    std::vector<double> r, J;
    const bool known = residuals.at(u, r) && residuals.derivatives(u, r, all, J);
    if (!known) {
      found.jacobian.clear();
      found.end = residuals.interrupted() ? SearchEnd::interrupted : SearchEnd::no_derivative;
      return;
    }
    const std::vector<std::size_t> now_free = free_of(unknowns, u, r, J);
    found.residuals = std::move(r), found.jacobian = std::move(J), found.one_sided = residuals.one_sided;
    if (now_free.empty()) return;
    if (ended && now_free == free) {
      // at the edge of what fails steps get so short that the search seems to have come to its end
      const bool at_edge =
          residuals.accepted_since_failure == 0 || !found.one_sided.empty() || residuals.failed_near(u);
      if (at_edge && !residuals.within_rounding(found.residuals)) tell_held(free, unknowns.size(), found);
      return;
    }
    free = now_free;
    Leg leg(unknowns, residuals, options, found, u, free);
    const ceres::Solver::Summary summary = leg.run();
    if (residuals.failure) std::rethrow_exception(residuals.failure);
    u = leg.end();
    found.end = end_of(summary, residuals);
    ended = !leg.hit();
    if (found.end == SearchEnd::converged && found.iterations.back().number < options.most_iterations)
      continue;
    if (found.end == SearchEnd::converged && !ended) found.end = SearchEnd::iterations;

    const int accepted_since = residuals.accepted_since_failure;
    found.jacobian.clear();
    if (residuals.at(u, r) && found.end != SearchEnd::interrupted && residuals.derivatives(u, r, all, J))
      found.residuals = std::move(r), found.jacobian = std::move(J), found.one_sided = residuals.one_sided;
    // creeping along the edge of what fails, with a step that is accepted now and then
    if (!found.jacobian.empty() && found.end == SearchEnd::iterations && accepted_since < 5)
      tell_held(free, unknowns.size(), found);
    return;
  }
}

std::string in_words(SearchEnd end, const std::string& why, int most) {
  switch (end) {
    case SearchEnd::converged: return "no step of the search lowers the sum of squares any more";
    case SearchEnd::iterations: return "the search was ended after " + std::to_string(most) + " iterations";
    case SearchEnd::held: return "the search is held by runs that fail: " + why;
    case SearchEnd::no_better: return "no run near the best values went well: " + why;
    case SearchEnd::no_derivative:
      return "there is no derivative: no run beside the best values went well: " + why;
    case SearchEnd::interrupted: return "interrupted";
  }
  return "";
}

}  // namespace

double Searched::scale() const {
  if (start != 0) return std::abs(start);
  return std::isfinite(high - low) && high > low ? high - low : 1.0;
}

Found search(const std::vector<Searched>& values, const std::vector<double>& data,
             const std::vector<double>& sigma, const Curves& curves, const SearchOptions& options) {
  if (values.empty() || data.empty() || data.size() != sigma.size())
    throw std::invalid_argument("a search needs values, and data with a standard deviation each");
  FLAGS_minloglevel = google::FATAL;  // steps that fail are told by Found, not on stderr
  for (const Searched& v : values)
    if (!(v.low <= v.start && v.start <= v.high))
      throw std::invalid_argument("a search starts within its bounds");
  const Unknowns unknowns(values);
  Found found;
  Residuals residuals(unknowns, data, sigma, curves, options);
  std::vector<double> u, r;
  for (std::size_t j = 0; j < values.size(); ++j) u.push_back(unknowns.unknown(j, values[j].start));
  if (!residuals.at(u, r)) throw std::invalid_argument(residuals.why);
  go(unknowns, residuals, options, u, found);
  found.derivatives = residuals.used.empty() ? std::vector<Derivative>(values.size()) : residuals.used;
  found.why = in_words(found.end, residuals.why, options.most_iterations);
  found.values = unknowns.values(u.data());
  return found;
}

}  // namespace vbond::fit
