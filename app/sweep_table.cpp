#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "report_command.hpp"
#include "sweep.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/csv.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/report/page.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Results of one point, by name, in the order of the files.
using Results = std::vector<std::pair<std::string, std::string>>;

/// Numbers and words below a value; stages by their names, items of other lists by their places from 0.
void add_leaves(const Json& value, const std::string& path, Results& results) {
  if (value.is_object()) {
    for (const auto& [key, below] : value.items())
      if (key != "wall_time" && key != "name")
        add_leaves(below, path.empty() ? key : path + "." + key, results);
  } else if (value.is_array()) {
    for (std::size_t k = 0; k < value.size(); ++k) {
      const bool named = path == "stages" && value[k].contains("name");
      add_leaves(value[k], named ? value[k]["name"].get<std::string>() : path + "." + std::to_string(k),
                 results);
    }
  } else if (value.is_number() || value.is_boolean() || path.find('.') != std::string::npos) {
    results.emplace_back(path, value.is_string() ? csv_quoted(value.get<std::string>()) : value.dump());
  }
}

void add_summary(const fs::path& file, Results& results) {
  const Json json = Json::parse(read_all(file), nullptr, false);
  if (json.is_discarded()) return;
  Results all;
  add_leaves(json, "", all);
  for (const auto& result : all)
    if (result.first != "bond_steps_per_second" && !result.first.starts_with("threads"))
      results.push_back(result);
}

void add_last_row(const fs::path& file, Results& results) {
  std::istringstream text(read_all(file));
  std::string header, line, last;
  std::getline(text, header);
  while (std::getline(text, line)) last = line;
  const std::vector<std::string> names = csv_cells(header), cells = csv_cells(last);
  for (std::size_t k = 0; k < names.size() && k < cells.size(); ++k)
    results.emplace_back("history." + csv_plain(names[k]), cells[k]);
}

/// Of each point its results, and all names that occur.
struct AllResults {
  const std::vector<std::string>& names;
  const std::vector<Results>& rows;
};

/// Those that are numbers at some point: of each its values, point by point.
Json numbers_of(const AllResults& results) {
  Json names = Json::array(), values = Json::array();
  for (const std::string& name : results.names) {
    Json of_name = Json::array();
    bool any = false;
    for (const Results& row : results.rows) {
      const auto at = std::find_if(row.begin(), row.end(), [&](const auto& r) { return r.first == name; });
      const auto number = at != row.end() ? csv_number<double>(at->second) : std::nullopt;
      any = any || number;
      of_name.push_back(number ? Json(*number) : Json());
    }
    if (any) names.push_back(name), values.push_back(std::move(of_name));
  }
  return {{"names", std::move(names)}, {"values", std::move(values)}};
}

/// A text that a spreadsheet would take for a formula stands in quotes of its own.
std::string csv_text(const std::string& text) {
  const bool sign = text.starts_with('-') || text.starts_with('+');
  const bool number =
      sign && text.size() > 1 && (std::isdigit(static_cast<unsigned char>(text[1])) || text[1] == '.');
  const bool formula = text.starts_with('=') || text.starts_with('@') || (sign && !number);
  return csv_quoted(formula ? '"' + text + '"' : text);
}

/// sweep.html. A program without the page writes none.
void write_overview(const fs::path& sweep, const std::string& title, const std::vector<SweptKeys>& keys,
                    const std::vector<PointEnd>& ends, const AllResults& results) {
  std::string page;
  try {
    page = page_template();
  } catch (const IoError&) {
    return;
  }
  Json j{{"format", 1}, {"program", "vbond " VBOND_VERSION}, {"title", title}};
  j["keys"] = Json::array(), j["points"] = Json::array();
  for (const SweptKeys& swept : keys)
    for (std::size_t k = 0; k < swept.keys.size(); ++k) {
      Json key{{"name", swept.keys[k]}, {"values", Json::array()}};
      for (const auto& values : swept.values) key["values"].push_back(values[k]);
      if (k > 0) key["with"] = swept.keys.front();
      j["keys"].push_back(std::move(key));
    }
  const auto points = points_of(keys);
  for (const PointEnd& end : ends) {
    Json values = Json::array();
    for (const std::string& change : points[end.point]) values.push_back(change.substr(change.find('=') + 1));
    j["points"].push_back({{"folder", point_folder(sweep, end.point).filename().string()},
                           {"values", std::move(values)},
                           {"ended", end.failed ? "failed" : "done"},
                           {"reason", end.reason}});
  }
  j["results"] = numbers_of(results);
  const std::string text = j.dump(-1, ' ', false, Json::error_handler_t::replace);
  replace_file(sweep / "sweep.html", page::sweep_page(page, text), Sync::none);
}

}  // namespace

void write_sweep_table(const fs::path& sweep, const std::string& title, const std::vector<SweptKeys>& keys,
                       const std::vector<PointEnd>& ends) {
  std::vector<Results> rows;
  std::vector<std::string> names;
  for (const PointEnd& end : ends) {
    const fs::path folder = point_folder(sweep, end.point);
    Results& row = rows.emplace_back();
    if (fs::exists(folder / "run.json")) add_summary(folder / "run.json", row);
    if (fs::exists(folder / "history.csv")) add_last_row(folder / "history.csv", row);
    for (const auto& result : row)
      if (std::find(names.begin(), names.end(), result.first) == names.end()) names.push_back(result.first);
  }

  std::vector<std::string> cells{"point"};
  for (const SweptKeys& swept : keys)
    for (const std::string& key : swept.keys) cells.push_back(csv_quoted(key));
  for (const char* name : {"ended", "seconds", "reason"}) cells.emplace_back(name);
  for (const std::string& name : names) cells.push_back(csv_quoted(name));
  std::string text = csv_line(cells);
  const auto points = points_of(keys);
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const PointEnd& end = ends[k];
    cells = {std::to_string(end.point + 1)};
    for (const std::string& change : points[end.point])
      cells.push_back(csv_text(change.substr(change.find('=') + 1)));
    cells.emplace_back(end.failed ? "failed" : "done");
    cells.push_back(std::to_string(end.seconds));
    cells.push_back(csv_text(end.reason));
    const std::map<std::string, std::string> of(rows[k].begin(), rows[k].end());
    for (const std::string& name : names) cells.push_back(of.count(name) > 0 ? of.at(name) : "");
    text += csv_line(cells);
  }
  replace_file(sweep / "sweep.csv", text);
  write_overview(sweep, title, keys, ends, {names, rows});
}

}  // namespace vbond::app
