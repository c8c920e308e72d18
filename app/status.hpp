#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/static_stage.hpp"

namespace vbond::app {

/// How a run stands, or how it has ended.
enum class RunState : std::uint8_t { running, complete, failed, interrupted };
const char* to_text(RunState state);

/// The stage of a run that is under way, or was the last one.
struct StageStatus {
  std::int64_t index = 0, count = 0;  ///< from 0; of all stages
  std::string name;
  StageKind kind = StageKind::dynamics;
  std::int64_t steps = 0;          ///< made in it; of a static one: points of balance found
  std::optional<double> end_time;  ///< of the run, if it lasts for all its duration  [time]
  std::vector<std::string> names;  ///< of all stages; none in a status of an earlier version
};

/// What status.json holds: where a run is, for those who look at it from outside.
struct RunStatus {
  std::string version;  ///< of the program
  std::int64_t process = 0;
  std::string host;  ///< the machine it runs on
  std::string name;  ///< of the case
  RunState state = RunState::running;
  StageStatus stage;
  std::int64_t step = 0;
  double time = 0;                     ///< of the run  [time]
  std::optional<double> seconds_left;  ///< of wall time, at most; nothing: not known
  /// Columns of history.csv by their names; none before the first stage has begun.  [energy]
  std::vector<std::pair<std::string, std::optional<double>>> energies;
  std::optional<std::int64_t> broken;  ///< bonds; nothing where none may break
  std::string last_event;              ///< in words
  std::string failure;                 ///< why it has failed; empty: it has not
  double wall_seconds = 0;             ///< since the program was started
  std::string written;                 ///< UTC
};

/// The text of status.json. Numbers that are not finite become null.
std::string to_json(const RunStatus& status);
/// The same on one line.
std::string to_json_line(const RunStatus& status);

/// The status of the run in a folder. Throws std::invalid_argument, with what to do, if there is none, or
/// none that can be understood.
RunStatus read_status(const std::filesystem::path& folder);

}  // namespace vbond::app
