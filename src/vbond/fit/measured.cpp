#include "vbond/fit/measured.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>
#include <variant>

#include "vbond/case/dimension.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/nearest.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/setup/csv_table.hpp"
#include "vbond/setup/text_file.hpp"

namespace vbond::fit {
namespace {

constexpr const char* stage_title = "stage";

/// 1 of a unit; history.csv has blanks for products.
std::variant<keys::Quantity, keys::UnitMistake> one_of(std::string unit) {
  std::replace(unit.begin(), unit.end(), ' ', '*');
  return keys::parse_quantity("1 " + unit);
}

/// What a number of a column is multiplied by: the unit of its heading over that of history.csv.
double factor_of(const std::string& title, const std::string& history, UnitSystem units,
                 const SourcePlace& place, Problems& problems) {
  const std::size_t open = title.rfind('[');
  if (open == std::string::npos || !title.ends_with(']')) return 1;
  const std::string unit = title.substr(open + 1, title.size() - open - 2);
  const auto facts = facts_of_column(history);
  if (!facts) {
    problems.add(place, fmt::format("column {}", shown_field(title)),
                 fmt::format("it is {} of history.csv, which has no column of this name", history),
                 "correct the name: docs/output.md has them all");
    return 1;
  }
  const std::string wanted = facts->unit.in(units);
  const bool pure = unit.empty() || unit == "-" || unit == "1";
  if (unit == wanted || unit.empty() || (pure && (wanted.empty() || units != UnitSystem::si))) return 1;
  const auto refuse = [&](const std::string& rule) {
    problems.add(
        place, fmt::format("column {}", shown_field(title)), rule,
        wanted.empty() ? "leave the unit out of the heading" : fmt::format("give it in [{}]", wanted));
    return 1.0;
  };
  if (units != UnitSystem::si || wanted.empty())
    return refuse(fmt::format("{} of history.csv {} here: there is nothing to convert to", history,
                              wanted.empty() ? "is a pure number" : "is in reduced units"));
  if (pure) return refuse(fmt::format("{} of history.csv is in {}, not a pure number", history, wanted));
  const auto given = one_of(unit), is = one_of(wanted);
  if (const auto* mistake = std::get_if<keys::UnitMistake>(&given)) return refuse(mistake->rule);
  const auto &from = std::get<keys::Quantity>(given), &to = std::get<keys::Quantity>(is);
  if (from.in_T_0 || !(from.dimension == to.dimension))
    return refuse(fmt::format("{} of history.csv is in {}, of another dimension", history, wanted));
  return from.value / to.value;
}

/// The fields of the file, with the places where numbers are wrong.
class Fields {
 public:
  Fields(const std::filesystem::path& file, const CsvTable& table, Problems& problems)
      : file_(file), table_(table), lines_(read_lines(file, {})), problems_(problems) {}
  const std::string& text(std::size_t column, std::size_t row) const { return table_.fields[column][row]; }
  bool empty(std::size_t column, std::size_t row) const { return text(column, row).empty(); }
  double number(std::size_t column, std::size_t row, const std::string& title) const {
    if (const auto x = to_number(text(column, row))) return *x;
    refuse(column, row, title, "must be a finite number",
           empty(column, row) ? "fill it in, or leave out the row"
                              : "write it with a decimal point, without a unit");
    return 1;
  }
  void refuse(std::size_t column, std::size_t row, const std::string& title, const std::string& rule,
              const std::string& way_out) const {
    problems_.add(place(column, row), fmt::format("{} = {}", title, shown_field(text(column, row))), rule,
                  way_out);
  }

  /// Of a field of a row; its first character, if it stands on the row's first line.
  SourcePlace place(std::size_t column, std::size_t row) const { return on_line(column, table_.lines[row]); }
  SourcePlace heading(std::size_t column) const { return on_line(column, table_.header_line); }

 private:
  SourcePlace on_line(std::size_t column, std::uint32_t line) const {
    const std::uint32_t character =
        line <= lines_.size() ? column_of_field(lines_[line - 1], table_.separator, table_.columns[column])
                              : 1;
    return {file_.string(), line, character};
  }

  const std::filesystem::path& file_;
  const CsvTable& table_;
  std::vector<std::string> lines_;
  Problems& problems_;
};

/// Which column of the file each thing is in.
struct Columns {
  std::vector<WantedColumn> wanted{};
  std::size_t add(const std::string& title) {
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (wanted[k].title == title) return k;
    wanted.push_back({title, true});
    return wanted.size() - 1;
  }
};

std::size_t stage_of(const std::string& name, const std::vector<std::string>& stages,
                     const SourcePlace& place) {
  const auto found = std::find(stages.begin(), stages.end(), name);
  if (found != stages.end()) return static_cast<std::size_t>(found - stages.begin());
  const auto near = nearest_name(name, stages);
  throw CaseError(Problem{place, fmt::format("stage {}", shown_field(name)),
                          "the case has no stage of this name",
                          near ? fmt::format("did you mean \"{}\"?", *near)
                               : fmt::format("its stages are {}", fmt::join(stages, ", "))});
}

/// A standard deviation: a number for all points, or a column.
struct Sigma {
  double number = 1;
  std::optional<std::size_t> column;
  double factor = 1;
};

}  // namespace

Pair pair_of(const std::string& text, const std::string& option) {
  const std::size_t equals = text.find('=');
  Pair pair{text.substr(0, equals), equals == std::string::npos ? text : text.substr(equals + 1)};
  if (pair.history.empty() || pair.data.empty())
    throw std::invalid_argument(option + " " + text + ": a column is missing\n  write " + option +
                                " COLUMN or " + option + " 'COLUMN=COLUMN OF THE DATA'");
  return pair;
}

Points read_points(const std::filesystem::path& file, const Pair& x, const std::vector<Measured>& measured,
                   const std::optional<std::string>& stage, const std::vector<std::string>& stages,
                   UnitSystem units) {
  Columns columns;
  const std::size_t x_column = columns.add(x.data);
  std::vector<std::size_t> y_columns;
  std::vector<Sigma> sigmas;
  for (const Measured& m : measured) {
    y_columns.push_back(columns.add(m.y.data));
    Sigma& sigma = sigmas.emplace_back();
    if (const auto number = to_number(m.sigma)) {
      if (!(*number > 0))
        throw std::invalid_argument("--sigma " + m.sigma +
                                    ": must be > 0\n  leave it out if it is not known");
      sigma.number = *number;
    } else if (!m.sigma.empty()) {
      sigma.column = columns.add(m.sigma);
    }
  }
  const std::size_t stage_column = columns.wanted.size();
  columns.wanted.push_back({stage_title, false});
  const CsvTable table = read_csv(file, {file.string(), 0, 0}, columns.wanted, {true, ""});
  const bool has_stages = table.found[stage_column] != 0;

  Problems problems;
  const SourcePlace header{file.string(), table.header_line, 1};
  const Fields fields(file, table, problems);
  const auto factor = [&](const std::string& title, const std::string& history) {
    return factor_of(title, history, units, fields.heading(columns.add(title)), problems);
  };
  const double x_factor = factor(x.data, x.history);
  std::vector<double> y_factors;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    y_factors.push_back(factor(measured[k].y.data, measured[k].y.history));
    if (sigmas[k].column) sigmas[k].factor = factor(measured[k].sigma, measured[k].y.history);
  }
  Points read{{}, table.passed_over};
  std::optional<std::size_t> of_all;
  if (stage) of_all = stage_of(*stage, stages, {"--stage", 0, 0});
  for (std::size_t row = 0; row < table.rows(); ++row) {
    std::optional<std::size_t> of_stage = of_all;
    try {
      if (has_stages)
        of_stage = stage_of(fields.text(stage_column, row), stages, fields.place(stage_column, row));
    } catch (const CaseError& e) {
      problems.add(e);
    }
    if (of_all && of_stage != of_all) continue;  // of another stage than the one that was asked for
    const double at = x_factor * fields.number(x_column, row, x.data);
    for (std::size_t k = 0; k < measured.size(); ++k) {
      if (fields.empty(y_columns[k], row)) continue;
      Point point{k,
                  at,
                  y_factors[k] * fields.number(y_columns[k], row, measured[k].y.data),
                  sigmas[k].number,
                  of_stage,
                  table.lines[row]};
      if (const auto column = sigmas[k].column) {
        point.sigma = sigmas[k].factor * fields.number(*column, row, measured[k].sigma);
        if (!(point.sigma > 0))
          fields.refuse(*column, row, measured[k].sigma, "a standard deviation must be > 0", "correct it");
      }
      read.points.push_back(point);
    }
  }
  if (table.rows() == 0)
    problems.add(header, "no row of data stands below the heading", "a fit needs more points than values",
                 "write a row for each measured point");
  problems.throw_if_any();
  return read;
}

}  // namespace vbond::fit
