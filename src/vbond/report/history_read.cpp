#include "vbond/report/history_read.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>

#include "vbond/core/error.hpp"
#include "vbond/observe/csv.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond::page {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Rows of the extremes of every column in a stretch; columns that do not change there say nothing.
void add_extremes(const History& h, std::size_t from, std::size_t to, std::vector<std::size_t>& rows) {
  for (const HistoryColumn& column : h.columns) {
    if (column.name == "step" || column.name == "time") continue;
    std::size_t low = from, high = from;
    for (std::size_t r = from; r < to; ++r) {
      if (!(column.values[r] >= column.values[low])) low = r;
      if (!(column.values[r] <= column.values[high])) high = r;
    }
    if (low == high || column.values[low] == column.values[high]) continue;
    rows.push_back(low);
    rows.push_back(high);
  }
}

void sort_unique(std::vector<std::size_t>& rows) {
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
}

std::vector<std::size_t> rows_with_stretches(const History& h, std::vector<std::size_t> rows,
                                             std::size_t stretches) {
  for (std::size_t k = 0; k < stretches; ++k)
    add_extremes(h, k * h.rows() / stretches, (k + 1) * h.rows() / stretches, rows);
  sort_unique(rows);
  return rows;
}

bool starts_with(std::string_view text, std::string_view begin) {
  return text.substr(0, begin.size()) == begin;
}

double span_of(const HistoryColumn& c) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double x : c.values)
    if (!std::isnan(x)) low = std::min(low, x), high = std::max(high, x);
  return high > low ? high - low : 0.0;
}

/// "axial_force.rod" -> "rod", "reaction.ends.fx" -> "ends".
std::string group_of(const std::string& column) {
  const std::size_t from = column.find('.') + 1, to = column.rfind('.');
  return to < from ? column.substr(from) : column.substr(from, to - from);
}

std::vector<std::string> columns_that_begin(const History& h, std::string_view begin) {
  std::vector<std::string> names;
  for (const HistoryColumn& c : h.columns)
    if (starts_with(c.name, begin)) names.push_back(c.name);
  return names;
}

/// Only the forces of a reaction: moments have another unit and so another axis.
std::vector<std::string> reaction_forces(const History& h) {
  std::vector<std::string> names = columns_that_begin(h, "reaction.");
  names.erase(std::remove_if(names.begin(), names.end(),
                             [](const std::string& n) { return n[n.rfind('.') + 1] != 'f'; }),
              names.end());
  return names;
}

/// Names of the walls that have columns.
std::vector<std::string> walls_of(const History& h) {
  constexpr std::string_view begin = "wall.", end = ".Fx";
  std::vector<std::string> walls;
  for (const HistoryColumn& c : h.columns)
    if (starts_with(c.name, begin) && c.name.size() > begin.size() + end.size() && c.name.ends_with(end))
      walls.push_back(c.name.substr(begin.size(), c.name.size() - begin.size() - end.size()));
  return walls;
}

/// These components of a wall, without those that never change.
std::vector<std::string> moving_components(const History& h, const std::string& wall,
                                           std::initializer_list<const char*> components) {
  std::vector<std::string> names;
  for (const char* component : components)
    if (const HistoryColumn* c = h.find("wall." + wall + '.' + component); c && span_of(*c) > 0.0)
      names.push_back(c->name);
  return names;
}

/// Those components of the cell's strain or stress, by how their names begin, that change by more than
/// rounding does.
std::vector<std::string> changing(const History& h, std::string_view begin) {
  constexpr double rounding = 1e-9;  // of the largest change
  std::vector<std::string> names = columns_that_begin(h, begin);
  double most = 0.0;
  for (const std::string& name : names) most = std::max(most, span_of(*h.find(name)));
  std::erase_if(names, [&](const std::string& name) { return !(span_of(*h.find(name)) > rounding * most); });
  return names;
}

/// Whether it changes, and never back.
bool goes_forward(const HistoryColumn& c) {
  return span_of(c) > 0.0 && std::is_sorted(c.values.begin(), c.values.end());
}

/// The end of a title.
std::string over_in_words(const std::string& axis) {
  if (axis == "step") return " at each point";
  if (axis == "load_factor") return " against load factor";
  return axis == "time" ? " against time" : " against displacement of " + group_of(axis);
}

/// The one that changes most; nothing if none changes.
std::vector<std::string> leading(const History& h, const std::vector<std::string>& names) {
  const std::string* most = nullptr;
  double span = 0.0;
  for (const std::string& name : names)
    if (const double s = span_of(*h.find(name)); s > span) most = &name, span = s;
  return most ? std::vector<std::string>{*most} : std::vector<std::string>{};
}

/// What a force is shown against: the largest movement along the largest reaction, such as a shortening, or
/// the largest of all where nothing is held.
std::vector<std::string> leading_movement(const History& h, const std::vector<std::string>& reactions) {
  const std::vector<std::string> all = columns_that_begin(h, "displacement.");
  std::vector<std::string> along;
  for (const std::string& reaction : leading(h, reactions))
    std::copy_if(all.begin(), all.end(), std::back_inserter(along),
                 [&reaction](const std::string& name) { return name.back() == reaction.back(); });
  const std::vector<std::string> movement = leading(h, along);
  return movement.empty() ? leading(h, all) : movement;
}

}  // namespace

const HistoryColumn* History::find(std::string_view name) const {
  for (const HistoryColumn& c : columns)
    if (c.name == name) return &c;
  return nullptr;
}

History read_history(const std::filesystem::path& path) {
  CsvReader in(path);
  History h;
  for (const std::string& name : in.header()) {
    if (std::count(name.begin(), name.end(), '"') % 2 != 0)  // quotes that do not end
      throw IoError(path.string() + ": is damaged at \"" + name.substr(0, 60) + '"');
    h.columns.push_back({csv_plain(name), {}});
  }
  while (in.next())
    for (std::size_t c = 0; c < h.columns.size(); ++c) {
      const std::string& cell = in.cells()[c];
      const auto value = cell.empty() ? none : csv_number<double>(cell);
      if (!value) in.refuse();
      h.columns[c].values.push_back(*value);
    }
  return h;
}

std::vector<std::size_t> rows_to_keep(const History& history, const std::vector<std::int64_t>& steps,
                                      std::size_t most) {
  std::vector<std::size_t> fixed;
  const std::size_t n = history.rows();
  const HistoryColumn* step = history.find("step");
  const auto of_a_frame = [&](std::size_t r) {
    const double x = step ? step->values[r] : none;
    return x >= 0.0 && x < 0x1p63 &&
           std::binary_search(steps.begin(), steps.end(), static_cast<std::int64_t>(x));
  };
  for (std::size_t r = 0; r < n; ++r)
    if (n <= most || r == 0 || r + 1 == n || of_a_frame(r)) fixed.push_back(r);
  if (n <= most) return fixed;
  std::vector<std::size_t> best = fixed;
  for (std::size_t low = 0, high = most; low < high;) {  // the most stretches that fit
    const std::size_t middle = (low + high + 1) / 2;
    std::vector<std::size_t> rows = rows_with_stretches(history, fixed, middle);
    if (rows.size() <= most) {
      best = std::move(rows);
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return best;
}

std::string unit_of_column(std::string_view name) {
  const auto facts = facts_of_column(name);
  return facts ? facts->unit.si : "";
}

std::string clock_of(const History& h) {
  const HistoryColumn* factor = h.find("load_factor");
  const bool only_balances = factor && std::none_of(factor->values.begin(), factor->values.end(),
                                                    [](double x) { return std::isnan(x); });
  return only_balances ? "step" : "time";
}

std::string axis_of(const History& h) {
  const std::string clock = clock_of(h);
  if (clock != "step") return clock;
  if (goes_forward(*h.find("load_factor"))) return "load_factor";
  for (const std::string& x : leading_movement(h, reaction_forces(h)))
    if (goes_forward(*h.find(x))) return x;
  return clock;
}

std::vector<Plot> preset_plots(const History& h) {
  std::vector<Plot> plots;
  const auto add = [&plots](const std::string& title, const std::string& x,
                            const std::vector<std::string>& y) {
    const bool is_there =
        std::any_of(plots.begin(), plots.end(), [&title](const Plot& p) { return p.title == title; });
    if (!y.empty() && !is_there) plots.push_back({title, x, y});
  };
  const HistoryColumn* factor = h.find("load_factor");
  const std::vector<std::string> axial = columns_that_begin(h, "axial_force."),
                                 reactions = reaction_forces(h);
  for (const std::string& x : leading_movement(h, reactions)) {
    const std::string of = " against displacement of " + group_of(x);
    if (factor && span_of(*factor) > 0.0) add("Load factor" + of, x, {"load_factor"});
    add("Axial force" + of, x, axial);
    if (axial.empty()) add("Reaction" + of, x, leading(h, reactions));
  }
  const std::string clock = axis_of(h), over = over_in_words(clock);
  add("Axial force" + over, clock, axial);
  add("Reactions" + over, clock, reactions);
  for (const std::string& wall : walls_of(h)) {
    const std::vector<std::string> force = moving_components(h, wall, {"Fx", "Fy", "Fz"});
    for (const std::string& x : leading(h, moving_components(h, wall, {"x", "y", "z"})))
      add("Force on wall " + wall + " against its displacement", x, leading(h, force));
    add("Force on wall " + wall + over, clock, force);
  }
  const std::vector<std::string> strains = changing(h, "cell_strain_"),
                                 stresses = changing(h, "cell_stress_");
  for (const std::string& x : leading(h, strains)) add("Stress of the body against strain", x, stresses);
  add("Stress of the body" + over, clock, stresses);
  add("Strain of the cell" + over, clock, strains);
  add("Displacements" + over, clock, columns_that_begin(h, "displacement."));
  add("Velocities" + over, clock, columns_that_begin(h, "velocity."));
  return plots;
}

}  // namespace vbond::page
