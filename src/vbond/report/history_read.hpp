#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// history.csv read back, for plots.
namespace vbond::page {

/// One column of numbers; NaN where the file has none.
struct HistoryColumn {
  std::string name;
  std::vector<double> values;
};

struct History {
  std::vector<HistoryColumn> columns;  ///< all of one length
  std::size_t rows() const { return columns.empty() ? 0 : columns[0].values.size(); }
  /// Nullptr if there is none of this name.
  const HistoryColumn* find(std::string_view name) const;
};

/// Reads what HistoryWriter has written. A last line that is still being written is left out; if that
/// is the first line, or there is none, there are no columns. Throws IoError.
History read_history(const std::filesystem::path& path);

/// At most `most` rows, in order: the first, the last, those of the steps given, and as many stretches of the
/// run as fit with the smallest and largest value of every column in each. All rows if they are no more than
/// that. More rows than `most` only if there are as many steps.
std::vector<std::size_t> rows_to_keep(const History& history, const std::vector<std::int64_t>& steps,
                                      std::size_t most);

/// Unit of a column of history.csv in SI, empty for pure numbers.
std::string unit_of_column(std::string_view name);

/// The column along which a run goes on, "step" or "time": of balances the number of the point, their time
/// means nothing.
std::string clock_of(const History& history);

/// The column over which curves are drawn: the clock of a run in motion. Of balances it is the load factor
/// or, where that goes back (as along a path, or in several stages), the displacement that moves most; "step"
/// if both go back or there is neither.
std::string axis_of(const History& history);

/// A plot that the page shows by itself.
struct Plot {
  std::string title, x;
  std::vector<std::string> y;
};

/// Plots worth showing, by what columns there are: forces against displacements, load factor against
/// displacements, otherwise over axis_of().
std::vector<Plot> preset_plots(const History& history);

}  // namespace vbond::page
