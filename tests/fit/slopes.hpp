#pragma once
#include <string>
#include <vector>

#include "vbond/fit/fit.hpp"

/// What tests of slopes share.
namespace vbond::slopes_test {

/// A case, its values that are varied, and the columns that are looked at.
struct Trial {
  std::string text;
  std::vector<std::string> keys, columns;
};

inline fit::Task task_of(const Trial& t) {
  fit::Task task;
  task.case_text = {t.text, "slopes.toml"};
  for (const std::string& key : t.keys) task.varied.push_back(fit::varied_key(key, task.case_text));
  return task;
}

inline std::vector<double> starts_of(const fit::Task& task) {
  std::vector<double> values;
  for (const fit::Varied& v : task.varied) values.push_back(v.searched.start);
  return values;
}

inline fit::Rows run(const fit::Task& task, const std::vector<double>& values,
                     const std::vector<std::string>& columns, bool slopes) {
  return fit::run_case(task.case_text, changes_to(task, values), columns, 1, {},
                       slopes ? nudges_of(task, values) : std::vector<fit::Nudge>{});
}

}  // namespace vbond::slopes_test
