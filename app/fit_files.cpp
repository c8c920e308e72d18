#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "fit_command.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/read_file.hpp"
#include "vbond/fit/fit.hpp"
#include "vbond/observe/csv.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// FNV-1a of 64 bits: tells texts apart that are not meant to pass for each other.
class Fingerprint {
 public:
  void add(const std::string& text) {
    for (const char c : text) take(static_cast<unsigned char>(c));
    take(0);
  }
  std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  void take(unsigned char c) { hash_ = (hash_ ^ c) * 0x100000001b3u; }
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

constexpr const char *slope_begins = "slope", *no_slope = "no slope";  // in the line of a run

const char* in_words(fit::SearchEnd end) {
  switch (end) {
    case fit::SearchEnd::converged: return "converged";
    case fit::SearchEnd::held: return "held";
    case fit::SearchEnd::iterations: return "iterations";
    case fit::SearchEnd::no_better: return "no_better";
    case fit::SearchEnd::no_derivative: return "no_derivative";
    case fit::SearchEnd::interrupted: return "interrupted";
  }
  return "";
}

std::string shortest(double x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "";
}

Json value_as_json(const fit::Varied& varied, const fit::FoundValue& v, const fit::Derivative& d) {
  Json j{{"key", varied.key}};
  if (!varied.start.unit.empty()) j["unit"] = varied.start.unit;
  j["scale"] = varied.searched.logarithmic ? "logarithmic" : "linear";
  j["bounds"] = {varied.searched.low, varied.searched.high};
  j["start"] = varied.searched.start, j["value"] = v.value, j["standard_error"] = v.standard_error;
  j["interval_95"] = {v.low, v.high};
  j["held_by_failed_runs"] = v.held;
  j["at_bound"] = v.at_low ? Json("lower") : v.at_high ? Json("upper") : Json();
  j["tried"] = {v.least_tried, v.largest_tried};
  j["derivative"] = d.last_exact ? "tangent" : "differences";  // the last one
  j["derivatives"] = {{"times", d.times}, {"by_differences", d.exact ? d.fell_back : d.times}};
  if (!std::isnan(d.off)) j["off_from_differences"] = d.off;
  if (d.contradicted) j["derivative"] = "unknown";
  if (!d.exact) j["why_differences"] = d.why_not;
  if (d.fell_back > 0) j["why_differences"] = d.fell_back_why;
  return j;
}

}  // namespace

namespace {

/// Of what the runs of a fit depend on.
std::string fingerprint_of(const fit::Task& task, const std::string& derivatives) {
  Fingerprint all;
  all.add(VBOND_VERSION);
  all.add(task.case_text.text);
  Case c = parse_case(task.case_text.text, task.case_text.file);
  for (const fs::path* file : files_of(c))
    if (!file->empty() && fs::is_regular_file(*file)) all.add(read_file(*file));
  all.add(read_file(task.data_file));
  all.add(task.x.history + '=' + task.x.data);
  for (const fit::Measured& m : task.measured) all.add(m.y.history + '=' + m.y.data), all.add(m.sigma);
  for (const fit::Varied& v : task.varied)
    all.add(fmt::format("{} {} {} {}", v.key, v.searched.low, v.searched.high, v.searched.logarithmic));
  all.add(task.stage.value_or(""));
  all.add(derivatives);  // runs without slopes are no runs of a fit that takes them
  return all.text();
}

/// How a page says of which fit it is: it stands in the JSON of no other.
std::string mark_of_page(const fit::Task& task, const std::string& derivatives) {
  return "\"fingerprint\":\"" + fingerprint_of(task, derivatives) + "\"";
}

}  // namespace

std::string definition_of(const fit::Task& task, const std::string& derivatives) {
  return "# runs of vbond fit " VBOND_VERSION ", of case, data, columns and bounds with fingerprint " +
         fingerprint_of(task, derivatives);
}

FitFiles fit_files(const FitOptions& options, const fit::Task& task) {
  const fs::path fitted = options.output.value_or(options.case_file.stem().string() + ".fitted.toml");
  if (fitted.extension() != ".toml")
    throw std::invalid_argument("-o " + fitted.string() +
                                ": the fitted case is a case file\n  name it NAME.toml");
  if (!fitted.parent_path().empty() && !fs::is_directory(fitted.parent_path()))
    throw std::invalid_argument("-o " + fitted.string() + ": there is no such folder\n  make it first");
  const fs::path stem = fitted.parent_path() / fitted.stem();
  const FitFiles files{fitted, stem.string() + ".json", stem.string() + ".csv", stem.string() + ".runs.csv",
                       stem.string() + ".html"};
  for (const fs::path& read : {options.case_file, options.data_file})
    for (const fs::path& written : {files.fitted, files.result, files.curves, files.runs, files.page})
      if (fs::exists(written) && fs::equivalent(read, written))
        throw std::invalid_argument(written.string() +
                                    " would be replaced\n  give another name with -o NAME.toml");
  const auto refuse = [](const fs::path& written) {
    throw std::invalid_argument(written.string() +
                                " is there already, and not of this fit\n  give another name "
                                "with -o NAME.toml, or remove it");
  };
  if (!fs::exists(files.runs))
    for (const fs::path& written : {files.fitted, files.result, files.curves})
      if (fs::exists(written)) refuse(written);
  if (options.report && fs::exists(files.page) &&
      read_file(files.page).find(mark_of_page(task, options.derivatives)) == std::string::npos)
    refuse(files.page);
  Case here = parse_case(task.case_text.text, task.case_text.file),
       there = parse_case(task.case_text.text, fitted);
  const auto before = files_of(here), after = files_of(there);
  for (std::size_t k = 0; k < before.size(); ++k)
    if (*before[k] != *after[k])
      throw std::invalid_argument("-o " + fitted.string() + ": the case names " +
                                  before[k]->filename().string() +
                                  " relative to its own folder\n  give a name in " +
                                  fs::absolute(options.case_file).parent_path().string());
  return files;
}

std::string header_of_runs(const fit::Task& task, const std::string& derivatives) {
  std::vector<std::string> cells;
  for (const fit::Varied& v : task.varied) cells.push_back(csv_quoted(v.key));
  cells.insert(cells.end(),
               {"ended", "reason", "curve at each point of the data, then slopes of each value"});
  return definition_of(task, derivatives) + "\n" + csv_line(cells);
}

std::string line_of(const fit::Tried& run) {
  std::vector<std::string> cells;
  for (const double value : run.values) cells.push_back(shortest(value));
  cells.emplace_back(run.trial.failed() ? "failed" : "done");
  cells.push_back(csv_quoted(run.trial.failure));
  for (const double y : run.trial.curve) cells.push_back(shortest(y));
  for (std::size_t j = 0; j < run.trial.slopes.size(); ++j) {
    const std::vector<double>& slope = run.trial.slopes[j];
    cells.emplace_back(slope.empty() ? no_slope : slope_begins);
    if (slope.empty()) cells.push_back(csv_quoted(run.trial.no_slope[j]));
    for (const double y : slope) cells.push_back(shortest(y));
  }
  return csv_line(cells);
}

std::vector<fit::Tried> read_runs(const fs::path& runs, const fit::Task& task,
                                  const std::string& derivatives) {
  std::vector<fit::Tried> known;
  if (!fs::exists(runs)) return known;
  LineReader lines(runs);
  const auto first = lines.next();
  if (!first || *first != definition_of(task, derivatives))
    throw std::invalid_argument(runs.string() +
                                " has runs of another fit: of another case, data, columns, bounds, sigma, "
                                "derivatives or version\n  give another "
                                "name with -o NAME.toml, or remove it");
  lines.next();
  const std::size_t n = task.varied.size();
  while (const auto line = lines.next()) {
    const std::vector<std::string> cells = csv_cells(*line);
    const auto refuse = [&] {
      throw IoError(runs.string() + ": \"" + std::string(line->substr(0, 60)) +
                    "\" is no run\n  remove that line: it is run again");
    };
    if (cells.size() < n + 2) refuse();
    fit::Tried tried;
    std::vector<double>* to = &tried.values;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (k == n) to = &tried.trial.curve;
      if (k == n || k == n + 1) continue;
      if (k > n && (cells[k] == slope_begins || cells[k] == no_slope)) {
        to = &tried.trial.slopes.emplace_back();
        tried.trial.no_slope.emplace_back();
        if (cells[k] == no_slope && ++k < cells.size()) tried.trial.no_slope.back() = csv_plain(cells[k]);
        continue;
      }
      const auto x =
          cells[k].empty() ? std::numeric_limits<double>::quiet_NaN() : csv_number<double>(cells[k]);
      if (!x) refuse();
      to->push_back(*x);
    }
    tried.trial.failure = csv_plain(cells[n + 1]);
    if (tried.trial.failed() != (cells[n] == "failed")) refuse();
    for (const std::vector<double>& slope : tried.trial.slopes)
      if (!slope.empty() && slope.size() != tried.trial.curve.size()) refuse();
    if (!tried.trial.slopes.empty() && tried.trial.slopes.size() != n) refuse();
    known.push_back(std::move(tried));
  }
  return known;
}

namespace {

Json all_as_json(const fit::Task& task, const fit::Result& r) {
  Json j{{"format", 1}, {"program", "vbond " VBOND_VERSION}};
  j["case"] = task.case_text.file.string(), j["data"] = task.data_file.string();
  j["x"] = task.x.history;
  j["columns"] = Json::array();
  for (const fit::Measured& m : task.measured) j["columns"].push_back(m.y.history);
  j["end"] = in_words(r.found.end), j["why"] = r.found.why;
  const fit::Statistics& s = r.statistics;
  const std::size_t n = r.values.size();
  j["values"] = Json::array();
  for (std::size_t k = 0; k < n; ++k)
    j["values"].push_back(value_as_json(task.varied[k], r.values[k], r.found.derivatives[k]));
  j["sigma_known"] = task.sigma_known();
  j["points"] = r.points.size(), j["degrees_of_freedom"] = s.dof, j["residual_deviation"] = r.deviation;
  j["correlation"] = Json::array();
  for (std::size_t k = 0; k < n && !s.correlation.empty(); ++k)
    j["correlation"].push_back(
        std::vector<double>(s.correlation.begin() + static_cast<std::ptrdiff_t>(k * n),
                            s.correlation.begin() + static_cast<std::ptrdiff_t>((k + 1) * n)));
  j["singular_values"] = s.singular_values, j["criterion"] = s.criterion;
  const auto names = [&task](const std::vector<std::size_t>& which) {
    Json list = Json::array();
    for (const std::size_t k : which) list.push_back(task.varied[k].key);
    return list;
  };
  j["no_effect"] = names(s.no_effect), j["not_told_apart"] = Json::array();
  for (const auto& together : s.not_told_apart) j["not_told_apart"].push_back(names(together));
  j["interpolation_off"] = r.runs_off;
  j["left_out_lines"] = Json::array();
  for (const fit::Point& p : r.left_out) j["left_out_lines"].push_back(p.line);
  j["iterations"] = Json::array();
  for (const fit::Iteration& i : r.found.iterations)
    j["iterations"].push_back({{"number", i.number},
                               {"sum_of_squares", i.sum_of_squares},
                               {"accepted", i.accepted},
                               {"values", i.values}});
  j["failures"] = r.failures;
  return j;
}

}  // namespace

std::string fit_as_json(const fit::Task& task, const fit::Result& r) {
  return all_as_json(task, r).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string fit_for_page(const fit::Task& task, const std::string& derivatives, const fit::Result& r) {
  Json j = all_as_json(task, r);
  j["fingerprint"] = fingerprint_of(task, derivatives);
  const Case c = parse_case(task.case_text.text, task.case_text.file);
  j["title"] = c.title, j["stages"] = Json::array();
  for (const StageSpec& stage : c.stages) j["stages"].push_back(stage.name);
  const auto unit_of = [&c](const std::string& column) {
    const auto facts = facts_of_column(column);
    return facts ? facts->unit.in(c.units) : "";
  };
  j["x_unit"] = unit_of(task.x.history), j["units"] = Json::array();
  for (const fit::Measured& m : task.measured) j["units"].push_back(unit_of(m.y.history));
  j["data"] = task.data_file.filename().string();
  j["case"] = task.case_text.file.filename().string();
  j["runs"] = {{"made", r.runs}, {"failed", r.failed}, {"known", r.known}};
  j["points"] = Json::array();
  for (std::size_t k = 0; k < r.points.size(); ++k) {
    const fit::Point& p = r.points[k];
    Json point{{"line", p.line},  {"curve", p.curve},    {"x", p.x},
               {"measured", p.y}, {"start", r.start[k]}, {"fitted", r.fitted[k]}};
    point["stage"] = p.stage ? Json(*p.stage) : Json();
    point["sigma"] = task.sigma_known() ? Json(p.sigma) : Json();
    j["points"].push_back(std::move(point));
  }
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string fit_as_csv(const fit::Task& task, const fit::Result& r) {
  std::string text = csv_line(std::vector<std::string>{"line", "column", csv_quoted(task.x.history),
                                                       "measured", "start", "fitted", "residual", "sigma"});
  for (std::size_t k = 0; k < r.points.size(); ++k) {
    const fit::Point& p = r.points[k];
    text += csv_line(
        std::vector<std::string>{std::to_string(p.line), csv_quoted(task.measured[p.curve].y.history),
                                 shortest(p.x), shortest(p.y), shortest(r.start[k]), shortest(r.fitted[k]),
                                 shortest(r.fitted[k] - p.y), task.sigma_known() ? shortest(p.sigma) : ""});
  }
  return text;
}

}  // namespace vbond::app
