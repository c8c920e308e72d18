#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "fit_command.hpp"
#include "report_command.hpp"
#include "signals.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/fit/fit.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/report/page.hpp"

namespace vbond::app {
namespace {

/// NAME.runs.csv as it grows. It begins with the first run, so that what is refused before leaves nothing.
class RunsFile {
 public:
  RunsFile(std::filesystem::path path, std::string header, const std::vector<fit::Tried>& known)
      : path_(std::move(path)), text_(std::move(header)), is_new_(known.empty()) {
    for (const fit::Tried& run : known) text_ += line_of(run);
  }
  void append(const fit::Tried& run) {
    if (!file_) {
      replace_file(path_, text_, Sync::none);  // without a last line that was cut short
      file_.emplace(path_, GrowingFile::Begin::at_end);
    }
    file_->append(line_of(run));
  }
  /// The task was refused after all.
  void discard() {
    file_.reset();
    if (is_new_) remove_file(path_);
  }

 private:
  std::filesystem::path path_;
  std::string text_;
  bool is_new_;
  std::optional<GrowingFile> file_;
};

std::string keys_of(const fit::Task& task, const std::vector<std::size_t>& which) {
  std::vector<std::string> keys;
  for (const std::size_t k : which) keys.push_back(task.varied[k].key);
  return fmt::format("{}", fmt::join(keys, ", "));
}

std::string lines_of(const std::vector<fit::Point>& points) {
  std::vector<std::uint32_t> lines;
  for (const fit::Point& p : points)
    if (lines.empty() || lines.back() != p.line) lines.push_back(p.line);
  const std::size_t shown = std::min<std::size_t>(lines.size(), 10);
  return fmt::format("line{} {}{}", lines.size() == 1 ? "" : "s",
                     fmt::join(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                     shown < lines.size() ? fmt::format(" and {} more", lines.size() - shown) : "");
}

/// A line of the table of iterations; the last column is not padded.
void say_row(const fit::Task& task, const std::string& number, const std::string& sum,
             const std::vector<std::string>& values, const char* remark) {
  std::string text = fmt::format("{:>9}  {:<14}", number, sum);
  for (std::size_t j = 0; j < values.size(); ++j)
    text += fmt::format("  {:<{}}", values[j], std::max<std::size_t>(14, task.varied[j].key.size()));
  text += remark;
  say(printable(text.substr(0, text.find_last_not_of(' ') + 1)) + "\n");
}

void say_heading(const fit::Task& task) {
  std::vector<std::string> keys;
  for (const fit::Varied& v : task.varied) keys.push_back(v.key);
  say_row(task, "iteration", "sum of squares", keys, "");
}

void say_iteration(const fit::Task& task, const fit::Iteration& i) {
  std::vector<std::string> values;
  for (const double value : i.values) values.push_back(fmt::format("{:.8g}", value));
  say_row(task, std::to_string(i.number),
          std::isfinite(i.sum_of_squares) ? fmt::format("{:.6g}", i.sum_of_squares) : "no run", values,
          i.accepted ? "" : "  no better");
}

std::string unit_of(const fit::Varied& v) {
  return v.start.unit.empty() ? "" : " " + v.start.unit;
}

/// A value with its error bar, or why there is none.
void say_value(const fit::Task& task, const fit::Result& r, std::size_t j) {
  const fit::Varied& varied = task.varied[j];
  const fit::FoundValue& v = r.values[j];
  std::string text = fmt::format("{} = {:.10g}{}", varied.key, v.value, unit_of(varied));
  if (std::isfinite(v.low))
    text +=
        fmt::format("   standard error {:.3g}, 95 % from {:.8g} to {:.8g}", v.standard_error, v.low, v.high);
  else if (std::isfinite(v.standard_error))
    text += fmt::format("   standard error {:.3g}", v.standard_error);
  if (v.at_low || v.at_high)
    text += fmt::format("   at its {} bound: held there, without an error", v.at_low ? "lower" : "upper");
  else if (v.held)
    text += "   held by runs that fail, without an error";
  say(printable(text) + "\n");
  say(fmt::format("    start {:.10g}, tried from {:.6g} to {:.6g}\n", varied.searched.start, v.least_tried,
                  v.largest_tried));
}

/// By what derivatives the values were found.
void say_derivatives(const fit::Task& task, const fit::Result& r) {
  std::vector<std::string> exact;
  double off = 0;
  for (std::size_t j = 0; j < r.values.size(); ++j) {
    const fit::Derivative& d = r.found.derivatives[j];
    const std::string& key = task.varied[j].key;
    if (d.exact && std::isnan(d.off))
      say(printable(fmt::format(
          "derivatives with {} by the tangents of balances: no effect at the start, by differences too\n",
          key)));
    else if (d.exact)
      exact.push_back(key), off = std::max(off, d.off);
    else if (!d.why_not.empty())
      say(printable(fmt::format("derivatives with {} by differences: {}\n", key, d.why_not)));
  }
  if (!exact.empty())
    say(printable(fmt::format(
        "derivatives with {} by the tangents of balances, at the start {:.1g} off from differences\n",
        fmt::join(exact, ", "), off)));
  for (std::size_t j = 0; j < r.values.size(); ++j)
    if (const fit::Derivative& d = r.found.derivatives[j]; d.fell_back > 0)
      say(printable(
          fmt::format("    with {} by differences {} of {} times, {}: {}\n", task.varied[j].key, d.fell_back,
                      d.times, d.last_exact ? "not the last time" : "the last among them", d.fell_back_why)));
}

void say_quality(const fit::Task& task, const fit::Result& r) {
  const fit::Statistics& s = r.statistics;
  if (r.found.jacobian.empty()) return;
  if (!(s.dof > 0))
    say(fmt::format(
        "{} points determine {} combinations of values: nothing is left to tell how far off they are\n",
        s.points, s.rank));
  else if (task.sigma_known())
    say(fmt::format(
        "residuals are {:.4g} of the given standard deviations in the mean (1 is expected), {} degrees of "
        "freedom\n",
        s.deviation, s.dof));
  else
    say(fmt::format(
        "standard deviation of the residuals {:.6g}, {} degrees of freedom; errors follow from it, as no "
        "--sigma is given\n",
        r.deviation, s.dof));
  if (any_contradicted(r.found))
    say("no standard errors: differences with two steps say different things, as where the rows of a run "
        "move "
        "with its values; give them in a stage whose rows stay, as an equilibrium with steps\n");
  for (const std::size_t k : s.no_effect)
    say(fmt::format("{} has no effect on the points: it is not determined\n", task.varied[k].key));
  for (const auto& together : s.not_told_apart)
    say(fmt::format(
        "the points do not tell apart {}: a singular value of the Jacobian with columns of length 1 is "
        "below {:g} of the largest\n  their values are one choice of many; hold one of them, or measure "
        "something else as well\n",
        keys_of(task, together), s.criterion));
  for (std::size_t i = 0; i < r.values.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const double c = s.correlation[i * r.values.size() + j]; std::isfinite(c))
        say(fmt::format("correlation of {} and {}: {:.4f}\n", task.varied[j].key, task.varied[i].key, c));
  if (r.runs_off > 0.1)
    say(fmt::format(
        "between rows of history.csv the curve may be off by {:.2g} of {}, at {}:{}: write more rows, or "
        "measure at them\n",
        r.runs_off, task.sigma_known() ? "sigma" : "the residuals' deviation", task.data_file.string(),
        r.points[r.runs_off_at].line));
}

void say_result(const fit::Task& task, const fit::Result& r) {
  say(fmt::format("\n{}: {} iterations, {} runs, {} of them failed{}\n", printable(r.found.why),
                  r.found.iterations.empty() ? 0 : r.found.iterations.back().number, r.runs, r.failed,
                  r.known > 0 ? fmt::format("; {} known from before", r.known) : ""));
  for (const std::string& why : r.failures) say("  failed: " + printable(why) + "\n");
  if (!r.found.one_sided.empty())
    say(fmt::format("{} derivatives are one-sided, since a run beside the best values failed\n",
                    r.found.one_sided.size()));
  say("\n");
  for (std::size_t j = 0; j < r.values.size(); ++j) say_value(task, r, j);
  say_quality(task, r);
  say_derivatives(task, r);
  if (!r.left_out.empty())
    say(fmt::format(
        "left out: {} points of {} beyond the run at the start, or where its rows have no number, {}\n",
        r.left_out.size(), task.data_file.string(), lines_of(r.left_out)));
  if (!r.passed_over.empty())
    say(printable(fmt::format("columns of {} that nothing asks for: {}", task.data_file.string(),
                              fmt::join(r.passed_over, ", "))) +
        "\n");
  if (r.found.end == fit::SearchEnd::converged)
    say("This is a minimum near the start. Other starts may lead to others.\n");
}

}  // namespace

int fit(const FitOptions& o) {
  instruction_set();  // refuses a wrong VBOND_SIMD before anything is written
  const fit::Task task = fit::make_task(o.case_file, o.data_file, o.vary, o.x, o.compare, o.sigma, o.stage);
  const FitFiles files = fit_files(o, task);
  const std::string html = o.report ? page_template() : std::string();  // refuses before the first run
  fit::Options options;
  options.known = read_runs(files.runs, task, o.derivatives);
  options.threads = o.threads;
  options.search.most_iterations = o.iterations, options.search.difference = o.difference;
  options.search.exact = o.derivatives == "automatic";
  options.search.interrupted = [] { return caught_signal() != 0; };
  options.search.tell = [&task](const fit::Iteration& i) {
    if (i.number == 0) say_heading(task);
    say_iteration(task, i);
  };
  RunsFile runs(files.runs, header_of_runs(task, o.derivatives), options.known);
  options.keep = [&runs](const fit::Tried& run) { runs.append(run); };
  catch_signals();

  std::optional<fit::Result> result;
  try {
    result = fit::fit(task, options);
  } catch (const CaseError&) {
    runs.discard();
    throw;
  }
  if (!result) {
    say("stopped by a signal before the start was computed: nothing is written\n", stderr);
    return 128 + caught_signal();
  }
  say_result(task, *result);
  replace_file(files.fitted, fit::with_values(task, result->found.values));
  replace_file(files.result, fit_as_json(task, *result));
  replace_file(files.curves, fit_as_csv(task, *result));
  say(fmt::format("fitted case in {}, curves and residuals in {}, all of the result in {}\n",
                  files.fitted.string(), files.curves.string(), files.result.string()));
  if (o.report) {
    replace_file(files.page, page::fit_page(html, fit_for_page(task, o.derivatives, *result)), Sync::none);
    say("report in " + files.page.string() + "\n");
  }
  if (result->found.end == fit::SearchEnd::interrupted) {
    say("stopped by a signal: these are the best values so far; the same command goes on\n", stderr);
    return 128 + caught_signal();
  }
  return result->found.end == fit::SearchEnd::converged ? done : failed;
}

}  // namespace vbond::app
