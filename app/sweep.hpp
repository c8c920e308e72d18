#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace vbond::app {

/// Keys of the case that go through their values together, mostly one, and what each takes at each of them,
/// as it stands behind = in --set.
struct SweptKeys {
  std::vector<std::string> keys;
  std::vector<std::vector<std::string>> values;  ///< values[k][j]: of keys[j] at the k-th
};

/// "KEY=a,b,c", or with "range(first, last, count)" or "logrange(first, last, count)", which may be followed
/// by a unit, in place of values; "KEY,KEY=a:b,c:d" or "KEY,KEY=range(...):range(...)" for keys that go
/// together. Commas and colons in brackets and quotes part nothing. Throws std::invalid_argument.
SweptKeys swept_keys(const std::string& text);

/// All combinations, the last ones changing fastest: for each point the changes of the case. Throws
/// std::invalid_argument if they are more than a million.
std::vector<std::vector<std::string>> points_of(const std::vector<SweptKeys>& all);

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
                       const std::vector<SweptKeys>& keys, const std::vector<PointEnd>& ends);

}  // namespace vbond::app
