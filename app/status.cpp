#include "status.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "vbond/core/error.hpp"
#include "vbond/observe/detail/static_json.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/summary.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t status_schema = 1;
constexpr std::uintmax_t most_bytes = 1 << 20;  // a status has about a thousand
constexpr std::array all_states{RunState::running, RunState::complete, RunState::failed,
                                RunState::interrupted};
constexpr std::array all_kinds{StageKind::dynamics, StageKind::equilibrium, StageKind::path,
                               StageKind::buckling, StageKind::modes,       StageKind::fracture};

template <class T>
Json or_null(const std::optional<T>& x) {
  return x ? Json(*x) : Json();
}

std::optional<double> number_or_null(const Json& j) {
  if (j.is_null()) return std::nullopt;
  if (!j.is_number())
    throw IoError(j.dump(-1, ' ', true, Json::error_handler_t::replace) + " is not a number");
  return j.get<double>();
}

double number_in(const Json& j) {
  return number_or_null(j).value_or(std::numeric_limits<double>::quiet_NaN());
}

StageStatus stage_status(const Json& j) {
  StageStatus s;
  s.index = whole_number(j.at("index"));
  s.count = whole_number(j.at("count"));
  if (s.index >= s.count) throw IoError("the stage is none of its stages");
  s.name = j.at("name").get<std::string>();
  s.kind = named(j.at("kind"), all_kinds);
  s.steps = whole_number(j.at("steps"));
  s.end_time = number_or_null(j.at("end_time"));
  if (j.contains("names")) s.names = j["names"].get<std::vector<std::string>>();
  return s;
}

RunStatus status_from(const Json& j) {
  RunStatus s;
  s.version = j.at("version").get<std::string>();
  s.process = whole_number(j.at("process"), std::numeric_limits<int>::max());
  if (s.process == 0) throw IoError("0 is no process");
  s.host = j.at("host").get<std::string>();
  s.name = j.at("case").get<std::string>();
  s.state = named(j.at("state"), all_states);
  s.stage = stage_status(j.at("stage"));
  s.step = whole_number(j.at("step"));
  s.time = number_in(j.at("time"));
  s.seconds_left = number_or_null(j.at("seconds_left"));
  if (const Json& energies = j.at("energies"); !energies.is_null()) {
    if (!energies.is_object()) throw IoError("the energies are no table");
    for (const auto& [column, value] : energies.items())
      s.energies.emplace_back(column, number_or_null(value));
  }
  if (!j.at("broken").is_null()) s.broken = whole_number(j["broken"]);
  s.last_event = j.at("last_event").get<std::string>();
  if (!j.at("failure").is_null()) s.failure = j["failure"].get<std::string>();
  s.wall_seconds = number_in(j.at("wall_seconds"));
  s.written = j.at("written").get<std::string>();
  return s;
}

[[noreturn]] void refuse_status(const fs::path& path, const std::string& why, const std::string& way_out) {
  throw std::invalid_argument(path.string() + ": " + why + "\n  " + way_out);
}

/// Throws unless the file is there, and is one that can be read in one go.
void require_readable(const fs::path& folder, const fs::path& path) {
  std::error_code e;
  if (!fs::exists(folder, e))
    refuse_status(folder, "there is no such folder",
                  "give the output folder of a run, which vbond run prints first");
  if (!fs::is_directory(folder, e))
    refuse_status(folder, "is not a folder", "give the output folder of a run, which vbond run prints first");
  if (!fs::exists(path, e))
    refuse_status(
        path, "there is none",
        "give the output folder of a run; one of an earlier version, or that has not begun, has none");
  if (!fs::is_regular_file(path, e) || fs::file_size(path, e) > most_bytes || e)
    refuse_status(path, "is not a status of a run: it is no file, or far too large", "remove it");
}

Json json_of(const RunStatus& s) {
  Json energies;
  for (const auto& [column, value] : s.energies) energies[column] = or_null(value);
  return Json{{"schema", status_schema},
              {"version", s.version},
              {"process", s.process},
              {"host", s.host},
              {"case", s.name},
              {"state", to_text(s.state)},
              {"stage",
               {{"index", s.stage.index},
                {"count", s.stage.count},
                {"name", s.stage.name},
                {"kind", vbond::to_text(s.stage.kind)},
                {"steps", s.stage.steps},
                {"end_time", or_null(s.stage.end_time)},
                {"names", s.stage.names}}},
              {"step", s.step},
              {"time", s.time},
              {"seconds_left", or_null(s.seconds_left)},
              {"energies", energies},
              {"broken", or_null(s.broken)},
              {"last_event", s.last_event},
              {"failure", s.failure.empty() ? Json() : Json(s.failure)},
              {"wall_seconds", s.wall_seconds},
              {"written", s.written}};
}

}  // namespace

const char* to_text(RunState state) {
  switch (state) {
    case RunState::running: return "running";
    case RunState::complete: return "complete";
    case RunState::failed: return "failed";
    case RunState::interrupted: return "interrupted";
  }
  return "";
}

std::string to_json(const RunStatus& s) {
  return json_of(s).dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string to_json_line(const RunStatus& s) {
  return json_of(s).dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

RunStatus read_status(const fs::path& folder) {
  const fs::path path = folder / "status.json";
  require_readable(folder, path);
  std::string why;
  try {
    const Json j = Json::parse(read_all(path));
    const std::int64_t schema = whole_number(j.at("schema"));
    if (schema != status_schema)
      refuse_status(path,
                    fmt::format("is of schema {}, and this program reads schema {}", schema, status_schema),
                    "use the vbond that runs there");
    return status_from(j);
  } catch (const Json::exception& e) {
    why = e.what();
  } catch (const IoError& e) {
    why = e.what();
  }
  refuse_status(path, "is not a status of a run: " + why,
                "a run writes it anew each second; of one that has ended see run.json");
}

}  // namespace vbond::app
