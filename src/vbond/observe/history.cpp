#include "vbond/observe/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

constexpr int balance_error_column = 12;
constexpr const char* fixed_columns =
    "step,time,kinetic_translation,kinetic_rotation,U_L,U_B,U_T,contact,dissipated,work_loads,"
    "work_supports,total,balance_error,bonds,strained,snapped,peak_average";
constexpr const char* static_columns = ",load_factor,unstable";

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

/// The number in the given column of a row of numbers, nothing if it is not there.
template <class T>
std::optional<T> number_at(std::string_view row, int column) {
  for (; column > 0; --column) {
    const std::size_t comma = row.find(',');
    if (comma == std::string_view::npos) return std::nullopt;
    row.remove_prefix(comma + 1);
  }
  T value{};
  const auto [end, error] = std::from_chars(row.data(), row.data() + row.size(), value);
  if (error != std::errc{} || (end != row.data() + row.size() && *end != ',')) return std::nullopt;
  return value;
}

}  // namespace

std::string history_header(const OutputPlan& plan) {
  std::string line = fixed_columns;
  if (plan.statics) line += static_columns;
  for (const Group& g : plan.reactions)
    for (const char* c : {"fx", "fy", "fz", "mx", "my", "mz"})
      line += ',' + csv(fmt::format("reaction.{}.{}", g.name, c));
  for (const Group& g : plan.axial_force) line += ',' + csv("axial_force." + g.name);
  for (const Group& g : plan.displacements)
    for (const char* c : {"x", "y", "z"}) line += ',' + csv(fmt::format("displacement.{}.{}", g.name, c));
  return line + '\n';
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
    : plan_(plan), path_(plan.folder / "history.csv") {
  if (resume_step) {
    keep_until(*resume_step);
    file_ = open_file(path_, "ab");
  } else {
    file_ = open_file(path_, "wb");
    write_all(file_.get(), history_header(plan_), path_);
  }
}

void HistoryWriter::keep_until(std::int64_t resume_step) {
  const std::string content = read_all(path_);
  const std::string header = history_header(plan_);
  if (content.compare(0, header.size(), header) != 0)
    throw IoError(path_.string() + ": its columns are not those of this case, so it cannot be continued");
  std::size_t kept = header.size();
  for (std::size_t end; (end = content.find('\n', kept)) != std::string::npos; kept = end + 1) {
    const std::string_view row = std::string_view(content).substr(kept, end - kept);
    const auto step = number_at<std::int64_t>(row, 0);
    const auto error = number_at<double>(row, balance_error_column);
    if (!step || !error) throw IoError(path_.string() + ": is damaged at \"" + std::string(row) + '"');
    if (*step > resume_step) break;
    last_step_ = *step;
    largest_balance_error_ = std::max(largest_balance_error_, std::abs(*error));
  }
  if (kept < content.size()) cut_file(path_, kept);
}

void HistoryWriter::write(const HistoryValues& values) {
  write_all(file_.get(), history_row(values, plan_.statics), path_);
  last_step_ = values.clock.step;
  largest_balance_error_ = std::max(largest_balance_error_, std::abs(values.balance_error));
}

}  // namespace vbond
