#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace vbond::app {

/// A key of the case and the values that it takes, as they stand behind = in --set.
struct SweptKey {
  std::string key;
  std::vector<std::string> values;
};

/// "KEY=a,b,c", or with "range(first, last, count)" or "logrange(first, last, count)", which may be followed
/// by a unit, in place of values. Commas in brackets and quotes do not part values. Throws
/// std::invalid_argument.
SweptKey swept_key(const std::string& text);

/// All combinations, the last key changing fastest: for each point the changes of the case.
std::vector<std::vector<std::string>> points_of(const std::vector<SweptKey>& keys);

/// How the run of a point ended.
struct PointEnd {
  std::size_t point = 0;  ///< from 0
  bool failed = false;
  double seconds = 0;  ///< of wall time, of the last run of it
  std::string reason;  ///< why it failed
};

/// The folder of a point's run, in that of the sweep: 0001, 0002, ...
std::filesystem::path point_folder(const std::filesystem::path& sweep, std::size_t point);

/// Writes sweep.csv: of each point its values, how it ended, all numbers of its run.json but wall times, and
/// the last row of its history.csv; and, if the page was built with the program, sweep.html with curves of
/// them under this title. Throws IoError.
void write_sweep_table(const std::filesystem::path& sweep, const std::string& title,
                       const std::vector<SweptKey>& keys, const std::vector<PointEnd>& ends);

}  // namespace vbond::app
