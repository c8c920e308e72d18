#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/read_file.hpp"
#include "vbond/fit/fit.hpp"

namespace vbond::fit {
namespace {

constexpr const char* option = "--vary";
constexpr const char* form =
    "write KEY, KEY=log, KEY=range(low, high) or KEY=logrange(low, high); low or high may be left empty";

[[noreturn]] void refuse(const std::string& text, const std::string& what, const std::string& rule,
                         const std::string& way_out) {
  throw CaseError(Problem{{fmt::format("{} {}", option, text), 0, 0}, what, rule, way_out});
}

std::string without_blanks(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Reads what stands behind KEY= into bounds and scale. `text` is all of it, for messages.
void read_range(const std::string& text, const std::string& range, Varied& v) {
  Searched& s = v.searched;
  if (range == "log") {
    s.logarithmic = true;
    return;
  }
  s.logarithmic = range.starts_with("logrange(");
  if ((!s.logarithmic && !range.starts_with("range(")) || !range.ends_with(')'))
    refuse(text, "\"" + range + "\"", "says neither bounds nor a scale", form);
  const std::size_t open = range.find('(') + 1, comma = range.find(',', open);
  if (comma == std::string::npos || range.find(',', comma + 1) != std::string::npos)
    refuse(text, "\"" + range + "\"", "a range has two bounds, with a comma between them", form);
  const std::string low = without_blanks(range.substr(open, comma - open)),
                    high = without_blanks(range.substr(comma + 1, range.size() - comma - 2));
  const std::string place = fmt::format("{} {}", option, text);
  if (!low.empty()) s.low = in_unit_of(v.start, low, place);
  if (!high.empty()) s.high = in_unit_of(v.start, high, place);
}

void look_over(const std::string& text, const Varied& v) {
  const Searched& s = v.searched;
  const std::string start =
      fmt::format("{} at {}:{}", v.start.toml(s.start), v.start.place.file, v.start.place.line);
  if (!(s.low < s.high))
    refuse(text, fmt::format("from {} to {}", s.low, s.high), "the lower bound must be below the upper one",
           "give the lower one first");
  if (s.start < s.low || s.start > s.high)
    refuse(text, "the search starts at " + start, "the start must lie within the bounds",
           "widen the bounds, or write another value into the case");
  const auto other_sign = [&s](double bound) { return std::isfinite(bound) && !(bound * s.start > 0); };
  if (s.logarithmic && (s.start == 0 || other_sign(s.low) || other_sign(s.high)))
    refuse(text, "the search starts at " + start,
           "on a logarithmic scale start and bounds are not 0 and have one sign", "use range(low, high)");
  if (s.start == 0 && !std::isfinite(s.high - s.low))
    refuse(text, "the search starts at " + start, "a start of 0 says nothing about the size of steps",
           "give both bounds, or another start");
}

/// The case must take values next to the start, above or below: a whole number, as of particles, has none.
void refuse_what_does_not_vary(const Task& task, std::size_t j) {
  constexpr double part = 1e-4;
  const Varied& v = task.varied[j];
  const Searched& s = v.searched;
  std::string why;
  for (const double h : {part * s.scale(), -part * s.scale()}) {
    const double beside = s.start + h;
    if (beside < s.low || beside > s.high) continue;
    try {
      parse_case(task.case_text.text, task.case_text.file, {v.key + '=' + v.start.toml(beside)});
      return;
    } catch (const CaseError& e) {
      if (why.empty()) why = e.problems().front().rule;
    }
  }
  if (why.empty()) return;  // the bounds are nearer than that
  throw CaseError(Problem{v.start.place, fmt::format("{} {}", option, v.key),
                          "the case refuses values next to this one: " + why,
                          "vary a key that takes numbers in between; whole ones go into a sweep"});
}

std::vector<Measured> measured_of(const std::vector<std::string>& compare,
                                  const std::vector<std::string>& sigma) {
  if (compare.empty()) throw std::invalid_argument("no column is compared\n  give --compare COLUMN");
  if (sigma.size() > 1 && sigma.size() != compare.size())
    throw std::invalid_argument(
        fmt::format("--sigma is given {} times, --compare {} times\n  give one for each, in the same order",
                    sigma.size(), compare.size()));
  if (sigma.size() != compare.size() && compare.size() > 1)
    throw std::invalid_argument(
        "several columns are compared, whose residuals have different sizes\n  give --sigma for each, in the "
        "same "
        "order: a number, or a column of the data");
  for (const std::string& s : sigma)
    if (s.empty())
      throw std::invalid_argument("--sigma is empty\n  give a number, a column of the data, or leave it out");
  std::vector<Measured> measured;
  for (std::size_t k = 0; k < compare.size(); ++k)
    measured.push_back({pair_of(compare[k], "--compare"), k < sigma.size() ? sigma[k] : ""});
  for (std::size_t k = 0; k < measured.size(); ++k)
    for (std::size_t other = 0; other < k; ++other)
      if (measured[k].y.history == measured[other].y.history || measured[k].y.data == measured[other].y.data)
        throw std::invalid_argument("--compare " + compare[k] + ": " + compare[other] +
                                    " is compared already\n  give each column and each heading once");
  return measured;
}

}  // namespace

Varied varied_key(const std::string& text, const CaseText& c) {
  const std::size_t equals = text.find('=');
  Varied v;
  v.key = without_blanks(text.substr(0, equals));
  v.start = number_in(c.text, c.file.string(), v.key, option);
  v.searched.start = v.start.value;
  if (equals != std::string::npos) read_range(text, without_blanks(text.substr(equals + 1)), v);
  look_over(text, v);
  return v;
}

Task make_task(const std::filesystem::path& case_file, const std::filesystem::path& data_file,
               const std::vector<std::string>& vary, const std::string& x,
               const std::vector<std::string>& compare, const std::vector<std::string>& sigma,
               std::optional<std::string> stage) {
  if (case_file == "-")
    throw std::invalid_argument("a fit reads its case again and again: give a file, not the standard input");
  if (vary.empty()) throw std::invalid_argument("no value is varied\n  give --vary KEY");
  Task task;
  task.case_text = {read_file(case_file), case_file};
  for (const std::string& text : vary) {
    Varied v = varied_key(text, task.case_text);
    for (const Varied& other : task.varied)
      if (other.start.begin == v.start.begin)
        refuse(text, "this key is varied already, as " + other.key, "each key is varied once",
               "leave one out");
    task.varied.push_back(std::move(v));
  }
  std::vector<double> others;  // none of them is the start, which would be found where nothing was replaced
  for (const Varied& v : task.varied) others.push_back(v.searched.start == 0 ? 1 : 0.5 * v.searched.start);
  with_values(task, others);
  for (std::size_t j = 0; j < task.varied.size(); ++j) refuse_what_does_not_vary(task, j);
  task.data_file = data_file;
  task.x = pair_of(x, "--x");
  task.measured = measured_of(compare, sigma);
  task.stage = std::move(stage);
  return task;
}

std::string with_values(const Task& task, const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [&task](std::size_t a, std::size_t b) {
    return task.varied[a].start.begin > task.varied[b].start.begin;  // from the end, so that places stay
  });
  std::string text = task.case_text.text;
  for (const std::size_t k : order) {
    const NumberInText& at = task.varied[k].start;
    text.replace(at.begin, at.end - at.begin, at.toml(values[k]));
  }
  const auto stands_there = [&](std::size_t k) {
    try {
      return number_in(text, task.case_text.file.string(), task.varied[k].key, option).value == values[k];
    } catch (const CaseError&) {
      return false;
    }
  };
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!stands_there(k))
      throw CaseError(Problem{task.varied[k].start.place, task.varied[k].key,
                              "another value cannot be put in the place of this one",
                              "write it as a number, or with its unit between plain quotes"});
  return text;
}

std::vector<std::string> changes_to(const Task& task, const std::vector<double>& values) {
  std::vector<std::string> changes;
  for (std::size_t j = 0; j < values.size(); ++j)
    changes.push_back(task.varied[j].key + '=' + task.varied[j].start.toml(values[j]));
  return changes;
}

std::vector<Nudge> nudges_of(const Task& task, const std::vector<double>& values) {
  constexpr double part = 2e-4;
  std::vector<Nudge> nudges;
  for (std::size_t j = 0; j < values.size(); ++j) {
    Nudge& nudge = nudges.emplace_back();
    if (!task.varied[j].key.starts_with("bonds[")) {
      nudge.why_not = "it is no key of bonds";
      continue;
    }
    nudge.step = part * std::max(std::abs(values[j]), 0.1 * task.varied[j].searched.scale());
    for (int k = -3; k <= 3; ++k) {
      std::vector<double> beside = values;
      beside[j] += k * nudge.step;
      nudge.changes[static_cast<std::size_t>(k + 3)] = changes_to(task, beside);
    }
  }
  return nudges;
}

}  // namespace vbond::fit
