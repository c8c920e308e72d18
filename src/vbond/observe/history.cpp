#include "vbond/observe/history.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/types.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

constexpr int balance_error_column = 12;
constexpr const char* fixed_columns =
    "step,time,kinetic_translation,kinetic_rotation,U_L,U_B,U_T,contact,dissipated,work_loads,"
    "work_supports,total,balance_error,bonds,strained,snapped,peak_average";

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

/// The names of the columns, each as it stands in the file.
std::vector<std::string> columns_of(const OutputPlan& plan) {
  std::vector<std::string> names = cells_of(fixed_columns);
  if (plan.statics) names.insert(names.end(), {"load_factor", "unstable"});
  for (const Group& g : plan.reactions)
    for (const char* c : {"fx", "fy", "fz", "mx", "my", "mz"})
      names.push_back(csv(fmt::format("reaction.{}.{}", g.name, c)));
  for (const Group& g : plan.axial_force) names.push_back(csv("axial_force." + g.name));
  for (const Group& g : plan.displacements)
    for (const char* c : {"x", "y", "z"}) names.push_back(csv(fmt::format("displacement.{}.{}", g.name, c)));
  return names;
}

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
                       .displacements = {}};
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
                       .displacements = {}};
  for (const Group& g : plan.reactions) values.reactions.push_back(point.reaction(g.particles));
  for (const Group& g : plan.axial_force) values.axial_force.push_back(mean_axial_force(state, g.particles));
  for (const Group& g : plan.displacements)
    values.displacements.push_back(mean_displacement(g, model, state));
  return values;
}

std::string history_row(const HistoryValues& values, bool statics) {
  fmt::memory_buffer row;
  const auto to = std::back_inserter(row);
  const auto add = [&to](double x) { fmt::format_to(to, ",{:.17g}", x); };
  const auto add3 = [&add](const Vec3d& x) { add(x.x), add(x.y), add(x.z); };
  const Energies& e = values.energies;
  const EnergyBooks& b = values.books;

  fmt::format_to(to, "{}", values.clock.step);
  for (const double x :
       {values.clock.time(), e.kinetic_translation, e.kinetic_rotation, e.U_L, e.U_B, e.U_T, e.contact,
        b.dissipated, b.work_loads, b.work_supports, e.total(), values.balance_error})
    add(x);
  fmt::format_to(to, ",{},{},{}", values.bonds, values.ranges.strained, values.ranges.snapped);
  add(values.peak_average);
  if (statics) {
    values.load_factor ? add(*values.load_factor) : row.push_back(',');
    row.push_back(',');
    if (values.unstable) fmt::format_to(to, "{}", *values.unstable);
  }
  for (const Reaction& x : values.reactions) add3(x.force), add3(x.moment);
  for (const double x : values.axial_force) add(x);
  for (const Vec3d& x : values.displacements) add3(x);
  row.push_back('\n');
  return fmt::to_string(row);
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
}

void HistoryWriter::keep_until(std::int64_t resume_step) {
  LineReader in(path_);
  const std::string header = std::string(in.next().value_or(""));
  if (header.rfind(fixed_columns, 0) != 0)
    throw IoError(path_.string() +
                  ": its first columns are not those of a history, so it cannot be continued\n"
                  "  move it away, and resume begins a new one");
  const std::vector<std::string> old = cells_of(header), wanted = std::exchange(columns_, old);
  for (const std::string& name : wanted)
    if (std::find(old.begin(), old.end(), name) == old.end()) columns_.push_back(name);

  std::uintmax_t kept = header.size() + 1;
  std::optional<Replacement> wider;
  if (columns_ != old) wider.emplace(path_), wider->write(line_of(columns_));
  const std::string empty_cells(columns_.size() - old.size(), ',');
  while (const auto row = in.next()) {
    const std::vector<std::string> cells = cells_of(*row);
    const auto step = number_in<std::int64_t>(cells[0]);
    const auto error =
        cells.size() == old.size() ? number_in<double>(cells[balance_error_column]) : std::nullopt;
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
    const auto at = std::find(names.begin(), names.end(), name);
    placed.push_back(at == names.end() ? "" : cells[static_cast<std::size_t>(at - names.begin())]);
  }
  return line_of(placed);
}

void HistoryWriter::write(const HistoryValues& values) {
  file_->append(in_columns_of_file(history_row(values, plan_.statics)));
  last_step_ = values.clock.step;
  largest_balance_error_ = std::max(largest_balance_error_, std::abs(values.balance_error));
}

}  // namespace vbond
