#include "vbond/fit/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/fit/at_points.hpp"
#include "vbond/run/run.hpp"

namespace vbond::fit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// The same for failures of one kind.
std::string without_numbers(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(),
                            [](char c) {
                              return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-';
                            }),
             text.end());
  return text;
}

/// The runs of a task. Each set of values is run once.
class Runs {
 public:
  Runs(const Task& task, const Options& options) : task_(task), options_(options) {
    for (const Tried& t : options.known)
      if (within_bounds(t.values)) known_.emplace(t.values, t.trial);
    taken = known_.size();
    columns_.push_back(task.x.history);
    for (const Measured& m : task.measured) columns_.push_back(m.y.history);
  }

  void set_points(std::vector<Point> points) { points_ = std::move(points); }

  /// Of a single run, with what goes wrong as it is thrown; nothing: interrupted.
  std::optional<AtPoints> run(const std::vector<double>& values, int threads, bool with_slopes,
                              std::vector<std::string>* no_slope = nullptr) const {
    const Rows rows =
        run_case(task_.case_text, changes_to(task_, values), columns_, threads, options_.search.interrupted,
                 with_slopes ? nudges_of(task_, values) : std::vector<Nudge>{});
    if (rows.interrupted) return std::nullopt;
    for (const Slope& s : rows.slopes)
      if (no_slope != nullptr) no_slope->push_back(s.why_not);
    return at_points(rows, points_, task_.case_text.file.string(), task_.x.history);
  }

  /// The same, kept, and with failures as a Trial.
  std::vector<Trial> try_all(const std::vector<std::vector<double>>& all) {
    std::vector<std::vector<double>> wanted;
    for (const auto& values : all)
      if (known_.count(values) == 0 && std::find(wanted.begin(), wanted.end(), values) == wanted.end())
        wanted.push_back(values);
    run_together(wanted, all.size() == 1);  // one alone: the search is there, and not beside
    std::vector<Trial> trials;
    for (const auto& values : all) {
      const auto at = known_.find(values);
      trials.push_back(at != known_.end() ? at->second : Trial{{}, "interrupted"});
    }
    return trials;
  }

  /// The start: what goes wrong there is the user's.
  std::optional<Trial> start(const std::vector<double>& values) {
    if (const auto at = known_.find(values); at != known_.end()) return at->second;
    auto trial = trial_of(values, options_.threads, true);
    if (!trial) return std::nullopt;
    keep(values, std::move(*trial));
    return known_.at(values);
  }

  const std::map<std::vector<double>, Trial>& tried() const { return known_; }
  std::size_t made = 0, failed = 0, taken = 0;

 private:
  bool within_bounds(const std::vector<double>& values) const {
    for (std::size_t j = 0; j < values.size(); ++j)
      if (values[j] < task_.varied[j].searched.low || values[j] > task_.varied[j].searched.high) return false;
    return true;
  }
  /// Several at once, which share the threads: the bits are the same.
  void run_together(const std::vector<std::vector<double>>& wanted, bool with_slopes) {
    const std::size_t workers = std::min(wanted.size(), static_cast<std::size_t>(options_.threads));
    std::atomic<std::size_t> next = 0;
    const auto work = [&](int threads) {
      for (std::size_t k = next++; k < wanted.size(); k = next++) {
        try {
          if (stop_) return;
          if (auto trial = guarded(wanted[k], threads, with_slopes)) keep(wanted[k], std::move(*trial));
        } catch (...) {
          const std::lock_guard lock(mutex_);
          failure_ = std::current_exception(), stop_ = true;
        }
      }
    };
    if (workers <= 1) {
      work(options_.threads);
    } else {
      std::vector<std::thread> threads;
      for (std::size_t k = 0; k < workers; ++k)
        threads.emplace_back(work, options_.threads / static_cast<int>(workers));
      for (std::thread& t : threads) t.join();
    }
    if (failure_) std::rethrow_exception(failure_);
  }

  std::optional<Trial> trial_of(const std::vector<double>& values, int threads, bool with_slopes) const {
    Trial trial;
    auto found = run(values, threads, with_slopes && options_.search.exact, &trial.no_slope);
    if (!found) return std::nullopt;
    trial.curve = std::move(found->y), trial.slopes = std::move(found->slopes);
    return trial;
  }
  std::optional<Trial> guarded(const std::vector<double>& values, int threads, bool with_slopes) const {
    const auto no_curve = [](const std::exception& e) { return Trial{{}, first_line(e.what())}; };
    try {
      return trial_of(values, threads, with_slopes);
    } catch (const CaseError& e) {
      return no_curve(e);
    } catch (const Diverged& e) {
      return no_curve(e);
    } catch (const NoEquilibrium& e) {
      return no_curve(e);
    } catch (const NoConvergence& e) {
      return no_curve(e);
    } catch (const std::invalid_argument& e) {
      return no_curve(e);
    }
  }

  void keep(const std::vector<double>& values, Trial trial) {
    const std::lock_guard lock(mutex_);
    ++made;
    if (trial.failed()) ++failed;
    if (options_.keep) options_.keep({values, trial});
    known_.emplace(values, std::move(trial));
  }

  const Task& task_;
  const Options& options_;
  std::vector<std::string> columns_;
  std::vector<Point> points_;
  std::map<std::vector<double>, Trial> known_;
  std::mutex mutex_;
  std::exception_ptr failure_;
  std::atomic<bool> stop_ = false;  ///< failure_ is set
};

std::vector<double> chosen(const std::vector<double>& all, const std::vector<std::size_t>& which) {
  std::vector<double> some;
  for (const std::size_t k : which) some.push_back(all[k]);
  return some;
}

/// The trial at the points that take part: all of them must lie within the run.
Trial at_chosen(const Trial& trial, const std::vector<std::size_t>& which, const std::vector<Point>& points,
                const Task& task) {
  if (trial.failed()) return trial;
  for (const std::size_t k : which)
    if (!std::isfinite(trial.curve[k]))
      return {{},
              fmt::format("the run has no {} at {} = {} of {}:{}", task.measured[points[k].curve].y.history,
                          task.x.history, points[k].x, task.data_file.string(), points[k].line)};
  Trial some{chosen(trial.curve, which), "", {}, trial.no_slope};
  for (std::size_t j = 0; j < trial.slopes.size(); ++j) {
    const std::vector<double>& all = trial.slopes[j];
    std::vector<double>& slope = some.slopes.emplace_back();
    if (!all.empty()) slope = chosen(all, which);
    if (std::any_of(slope.begin(), slope.end(), [](double x) { return !std::isfinite(x); }))
      slope.clear(), some.no_slope[j] = "it is not finite at some point";
  }
  return some;
}

/// 1 / their size, where they are not known: the search is then one of numbers near 1.
std::vector<double> sigma_of(const Task& task, const std::vector<Point>& points) {
  double largest = 0;
  for (const Point& p : points) largest = std::max(largest, std::abs(p.y));
  std::vector<double> sigma;
  for (const Point& p : points) sigma.push_back(task.sigma_known() ? p.sigma : largest > 0 ? largest : 1.0);
  return sigma;
}

double norm_of(const std::vector<double>& curve, const std::vector<double>& sigma) {
  double sum = 0;
  for (std::size_t k = 0; k < curve.size(); ++k) sum += curve[k] / sigma[k] * (curve[k] / sigma[k]);
  return std::sqrt(sum);
}

/// Correlations are those of ln(value / start) where the scale is logarithmic, which falls as a negative
/// value rises.
void turn_correlations(const Task& task, Result& result) {
  const std::size_t n = result.values.size();
  const auto turned = [&](std::size_t j) {
    return task.varied[j].searched.logarithmic && result.values[j].value < 0;
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (turned(i) != turned(j)) result.statistics.correlation[i * n + j] *= -1;
}

/// difference: the step of derivatives.
void judge(const Task& task, const std::vector<double>& sigma, double difference, Result& result) {
  const std::size_t n = task.varied.size();
  result.values.resize(n);
  std::vector<char> held(n, 0);
  for (std::size_t j = 0; j < n; ++j) {
    FoundValue& v = result.values[j];
    v.value = result.found.values[j];
    v.at_low = v.value == task.varied[j].searched.low, v.at_high = v.value == task.varied[j].searched.high;
    v.held = !result.found.held.empty() && result.found.held[j] != 0;
    held[j] = v.at_low || v.at_high || v.held ? 1 : 0;
    v.standard_error = v.low = v.high = none;
  }
  result.deviation = none;
  if (result.found.jacobian.empty()) return;
  const double criterion = criterion_of(difference, !result.found.one_sided.empty());
  const double no_effect =
      0.1 * criterion;  // of the curve, by a change of the value's size: what differences see
  result.statistics = statistics(result.found.jacobian, result.found.residuals, held, task.sigma_known(),
                                 criterion, no_effect * norm_of(result.fitted, sigma));
  turn_correlations(task, result);
  Statistics& s = result.statistics;
  if (any_contradicted(result.found)) {  // a wrong column is wrong for the errors of all
    std::fill(s.standard_error.begin(), s.standard_error.end(), none);
    std::fill(s.correlation.begin(), s.correlation.end(), none);
  }
  result.deviation = task.sigma_known() ? s.deviation : s.deviation * sigma.front();
  for (std::size_t j = 0; j < n; ++j) {
    FoundValue& v = result.values[j];
    const Searched& searched = task.varied[j].searched;
    const double error = s.standard_error[j], reach = s.quantile * error;
    v.standard_error = error * (searched.logarithmic ? std::abs(v.value) : searched.scale());
    v.low = searched.logarithmic ? v.value * std::exp(v.value > 0 ? -reach : reach)
                                 : v.value - reach * searched.scale();
    v.high = searched.logarithmic ? v.value * std::exp(v.value > 0 ? reach : -reach)
                                  : v.value + reach * searched.scale();
  }
}

void sum_up(const Runs& runs, Result& result) {
  result.runs = runs.made, result.failed = runs.failed, result.known = runs.taken;
  for (std::size_t j = 0; j < result.values.size(); ++j) {
    FoundValue& v = result.values[j];
    v.least_tried = v.largest_tried = v.value;
    for (const auto& [values, trial] : runs.tried())
      v.least_tried = std::min(v.least_tried, values[j]),
      v.largest_tried = std::max(v.largest_tried, values[j]);
  }
  std::set<std::string> kinds;
  for (const auto& [values, trial] : runs.tried())
    if (trial.failed() && kinds.size() < 5 && kinds.insert(without_numbers(trial.failure)).second)
      result.failures.push_back(trial.failure);
}

/// The best of all that was tried, where the search did not come to its own end.
void take_best(const Runs& runs, const std::vector<std::size_t>& which, const std::vector<Point>& points,
               const Task& task, const std::vector<double>& data, const std::vector<double>& sigma,
               Found& found) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [values, tried] : runs.tried()) {
    const Trial trial = at_chosen(tried, which, points, task);
    if (trial.failed()) continue;
    double sum = 0;
    for (std::size_t k = 0; k < data.size(); ++k) sum += std::pow((trial.curve[k] - data[k]) / sigma[k], 2);
    if (sum < best) best = sum, found.values = values;
  }
}

}  // namespace

std::optional<Result> fit(const Task& task, const Options& options) {
  const Case c = parse_case(task.case_text.text, task.case_text.file);
  std::vector<std::string> stages;
  for (const StageSpec& s : c.stages) stages.push_back(s.name);
  Points read = read_points(task.data_file, task.x, task.measured, task.stage, stages, c.units);
  Runs runs(task, options);
  runs.set_points(read.points);
  std::vector<double> start_values;
  for (const Varied& v : task.varied) start_values.push_back(v.searched.start);
  const std::optional<Trial> start = runs.start(start_values);
  if (!start) return std::nullopt;

  Result result;
  result.passed_over = read.passed_over;
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k < read.points.size(); ++k) {
    const bool within = !start->failed() && std::isfinite(start->curve[k]);
    (within ? result.points : result.left_out).push_back(read.points[k]);
    if (within) which.push_back(k);
  }
  if (which.size() < task.varied.size())
    throw CaseError(Problem{{task.data_file.string(), 0, 0},
                            fmt::format("{} points of {} lie within the run that starts the search",
                                        which.size(), read.points.size()),
                            fmt::format("{} values take at least as many points", task.varied.size()),
                            "look at the column of --x and its units, or vary fewer values"});
  const std::vector<double> sigma = sigma_of(task, result.points);
  std::vector<double> data;
  for (const Point& p : result.points) data.push_back(p.y);
  std::vector<Searched> searched;
  for (const Varied& v : task.varied) searched.push_back(v.searched);
  const auto curves = [&](const std::vector<std::vector<double>>& all) {
    std::vector<Trial> trials;
    for (const Trial& t : runs.try_all(all)) trials.push_back(at_chosen(t, which, read.points, task));
    return trials;
  };
  result.start = chosen(start->curve, which);
  result.found = search(searched, data, sigma, curves, options.search);
  if (result.found.jacobian.empty()) take_best(runs, which, read.points, task, data, sigma, result.found);
  result.fitted = chosen(runs.tried().at(result.found.values).curve, which);
  judge(task, sigma, options.search.difference, result);
  sum_up(runs, result);
  if (result.found.end == SearchEnd::interrupted) return result;
  if (const auto last = runs.run(result.found.values, options.threads, false)) {  // again, for its rows
    ++result.runs;
    for (std::size_t k = 0; k < which.size(); ++k)
      if (const double off = last->off[which[k]] / sigma[k]; off > result.runs_off)
        result.runs_off = off, result.runs_off_at = k;
    if (result.statistics.deviation > 0 && !task.sigma_known())
      result.runs_off /= result.statistics.deviation;
  }
  return result;
}

}  // namespace vbond::fit
