#include "vbond/observe/history.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/types.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

/// A column name as CSV wants it: quoted if it holds a comma, a quote or a line end.
std::string csv(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

Vec3d mean_displacement(const Group& group, const Model& model, const State& state) {
  Vec3d sum;
  for (const ParticleId p : group.particles) sum += state.r[p] - model.r_0[p];
  return sum / static_cast<double>(group.particles.size());
}

/// The cells of a line without its end, as they stand there: quoted ones with their quotes.
std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells(1);
  bool in_quotes = false;
  for (const char c : line) {
    if (c == '"') in_quotes = !in_quotes;
    if (c == ',' && !in_quotes)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

std::string line_of(const std::vector<std::string>& cells) {
  return fmt::format("{}\n", fmt::join(cells, ","));
}

/// The columns of a group, without quotes.
std::vector<std::string> names_of(const GroupQuantity& q, const Group& g) {
  std::vector<std::string> names;
  for (const GroupQuantity::Component& c : q.components)
    names.push_back(fmt::format("{}.{}{}{}", q.name, g.name, *c.name != '\0' ? "." : "", c.name));
  return names;
}

/// The names of the columns, without quotes.
std::vector<std::string> names_of(const OutputPlan& plan) {
  std::vector<std::string> names;
  for (const HistoryQuantity& q : history_quantities())
    if (!q.statics_only || plan.statics) names.emplace_back(q.name);
  for (const GroupQuantity& q : group_quantities())
    for (const Group& g : plan.*q.groups)
      for (std::string& name : names_of(q, g)) names.push_back(std::move(name));
  return names;
}

/// The names of the columns, each as it stands in the file.
std::vector<std::string> columns_of(const OutputPlan& plan) {
  std::vector<std::string> names = names_of(plan);
  for (std::string& name : names) name = csv(name);
  return names;
}

/// What csv() was given.
std::string plain(const std::string& cell) {
  if (cell.empty() || cell.front() != '"') return cell;
  std::string name;
  for (std::size_t k = 1; k + 1 < cell.size(); ++k) {
    name += cell[k];
    if (cell[k] == '"') ++k;
  }
  return name;
}

/// Where a column stands; nothing if there is none of this name.
std::optional<std::size_t> index_of(const std::vector<std::string>& columns, std::string_view name) {
  const auto at = std::find(columns.begin(), columns.end(), name);
  if (at == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(at - columns.begin());
}

struct WriteCell {
  fmt::memory_buffer& row;
  void operator()(std::monostate) const {}
  void operator()(std::int64_t x) const { fmt::format_to(std::back_inserter(row), "{}", x); }
  void operator()(double x) const { fmt::format_to(std::back_inserter(row), "{:.17g}", x); }
};

template <class T>
std::optional<T> number_in(const std::string& cell) {
  T value{};
  const char* end_of_cell = cell.data() + cell.size();
  const auto [end, error] = std::from_chars(cell.data(), end_of_cell, value);
  if (error != std::errc{} || end != end_of_cell) return std::nullopt;
  return value;
}

/// Reads a file line by line, whatever its size.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path) : file_(open_file(path, "rb")), path_(path) {}
  ~LineReader() { std::free(line_); }
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// The next line without its end; nothing at the end of the file, or for a last line cut short.
  std::optional<std::string_view> next() {
    const ssize_t size = getline(&line_, &room_, file_.get());
    if (size < 0 && std::ferror(file_.get())) throw IoError("cannot read " + path_.string());
    if (size <= 0 || line_[size - 1] != '\n') return std::nullopt;
    return std::string_view(line_, static_cast<std::size_t>(size) - 1);
  }

 private:
  File file_;
  std::filesystem::path path_;
  char* line_ = nullptr;
  std::size_t room_ = 0;
};

}  // namespace

std::string history_header(const OutputPlan& plan) {
  return line_of(columns_of(plan));
}

HistoryValues history_values(const OutputPlan& plan, const Simulation& run) {
  HistoryValues values{.clock = run.clock(),
                       .books = run.books(),
                       .energies = run.energies(),
                       .balance_error = run.balance_error(run.energies()),
                       .bonds = count_bonds(run),
                       .ranges = count_ranges(run),
                       .peak_average = run.peak().last,
                       .load_factor = {},
                       .unstable = {},
                       .reactions = {},
                       .axial_force = {},
                       .displacements = {},
                       .run = &run};
  for (const Group& g : plan.reactions) values.reactions.push_back(run.reaction(g.particles));
  for (const Group& g : plan.axial_force) values.axial_force.push_back(run.mean_axial_force(g.particles));
  for (const Group& g : plan.displacements)
    values.displacements.push_back(mean_displacement(g, run.model(), run.state()));
  return values;
}

HistoryValues history_values(const OutputPlan& plan, const Model& model, const StaticPoint& point) {
  const State& state = point.state;
  HistoryValues values{.clock = state.clock,
                       .books = {.at_start = point.energies.total()},
                       .energies = point.energies,
                       .balance_error = 0.0,
                       .bonds = static_cast<std::int64_t>(state.bonds.size()),
                       .ranges = count_ranges(state),
                       .peak_average = 0.0,
                       .load_factor = point.load_factor,
                       .unstable = point.unstable,
                       .reactions = {},
                       .axial_force = {},
                       .displacements = {},
                       .point = &point};
  for (const Group& g : plan.reactions) values.reactions.push_back(point.reaction(g.particles));
  for (const Group& g : plan.axial_force) values.axial_force.push_back(mean_axial_force(state, g.particles));
  for (const Group& g : plan.displacements)
    values.displacements.push_back(mean_displacement(g, model, state));
  return values;
}

std::string history_row(const OutputPlan& plan, const HistoryValues& values) {
  std::vector<Cell> cells;
  for (const HistoryQuantity& q : history_quantities())
    if (!q.statics_only || plan.statics) cells.push_back(q.value(values));
  for (const GroupQuantity& q : group_quantities())
    for (std::size_t k = 0; k < (plan.*q.groups).size(); ++k) q.add(values, k, cells);
  fmt::memory_buffer row;
  for (const Cell& cell : cells) {
    if (row.size() > 0) row.push_back(',');
    std::visit(WriteCell{row}, cell);
  }
  row.push_back('\n');
  return fmt::to_string(row);
}

std::string history_columns_json(const std::vector<std::string>& names, UnitSystem units) {
  nlohmann::ordered_json columns;
  for (const std::string& name : names) {
    const auto facts = facts_of_column(name);
    columns[name] = {{"unit", facts ? facts->unit.in(units) : ""}, {"meaning", facts ? facts->meaning : ""}};
  }
  return columns.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

HistoryWriter::HistoryWriter(const OutputPlan& plan, std::optional<std::int64_t> resume_step)
    : plan_(plan), path_(plan.folder / "history.csv"), columns_(columns_of(plan)) {
  std::error_code e;
  begun_anew_ = resume_step && !std::filesystem::exists(path_, e) && !e;
  if (resume_step && !begun_anew_) {
    keep_until(*resume_step);
    file_.emplace(path_, GrowingFile::Begin::at_end);
  } else {
    file_.emplace(path_, GrowingFile::Begin::anew);
    file_->append(line_of(columns_));
  }
  std::vector<std::string> names;
  for (const std::string& column : columns_) names.push_back(plain(column));
  replace_file(plan.folder / "history.columns.json", history_columns_json(names, plan.units), Sync::none);
}

void HistoryWriter::keep_until(std::int64_t resume_step) {
  LineReader in(path_);
  const std::string header = std::string(in.next().value_or(""));
  const std::vector<std::string> old = cells_of(header), wanted = std::exchange(columns_, old);
  const auto balance_error = index_of(old, "balance_error");
  if (old.front() != "step" || !index_of(old, "time") || !balance_error)
    throw IoError(path_.string() +
                  ": its columns are not those of a history, so it cannot be continued\n"
                  "  move it away, and resume begins a new one");
  for (const std::string& name : wanted)
    if (!index_of(old, name)) columns_.push_back(name);

  std::uintmax_t kept = header.size() + 1;
  std::optional<Replacement> wider;
  if (columns_ != old) wider.emplace(path_), wider->write(line_of(columns_));
  const std::string empty_cells(columns_.size() - old.size(), ',');
  while (const auto row = in.next()) {
    const std::vector<std::string> cells = cells_of(*row);
    const auto step = number_in<std::int64_t>(cells[0]);
    const auto error = cells.size() == old.size() ? number_in<double>(cells[*balance_error]) : std::nullopt;
    if (!step || !error)
      throw IoError(path_.string() + ": is damaged at \"" + std::string(row->substr(0, 60)) + '"');
    if (*step > resume_step) break;
    last_step_ = *step;
    largest_balance_error_ = std::max(largest_balance_error_, std::abs(*error));
    kept += row->size() + 1;
    if (wider) wider->write(fmt::format("{}{}\n", *row, empty_cells));
  }
  if (wider)
    wider->publish(Sync::to_disk);
  else
    cut_file(path_, kept);
}

std::string HistoryWriter::in_columns_of_file(const std::string& row) const {
  const std::vector<std::string> names = columns_of(plan_);
  if (names == columns_) return row;
  const std::vector<std::string> cells = cells_of(std::string_view(row).substr(0, row.size() - 1));
  std::vector<std::string> placed;
  for (const std::string& name : columns_) {
    const auto at = index_of(names, name);
    placed.push_back(at ? cells[*at] : "");
  }
  return line_of(placed);
}

void HistoryWriter::write(const HistoryValues& values) {
  file_->append(in_columns_of_file(history_row(plan_, values)));
  last_step_ = values.clock.step;
  largest_balance_error_ = std::max(largest_balance_error_, std::abs(values.balance_error));
}

}  // namespace vbond
