#include "seen.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <optional>
#include <string_view>

#include "lock.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/observe/table_text.hpp"

namespace vbond::app {
namespace {

/// Whether a run of this machine is not there any more; of others nothing is known. It holds the lock of its
/// folder as long as it lives. Its process id, which another process may have got since, is asked only where
/// there are no locks.
bool has_gone(const std::filesystem::path& folder, const RunStatus& s) {
  if (s.state != RunState::running || s.host != host_name()) return false;
  if (const auto held = is_held(folder, run_lock)) return !*held;
  return kill(static_cast<pid_t>(s.process), 0) != 0 && errno == ESRCH;
}

/// Sum of these columns; nothing if one of them is not there.
std::optional<double> sum_of(const RunStatus& s, const std::vector<std::string_view>& columns) {
  double sum = 0.0;
  for (const std::string_view column : columns) {
    const auto at = std::find_if(s.energies.begin(), s.energies.end(),
                                 [&](const auto& energy) { return energy.first == column; });
    if (at == s.energies.end() || !at->second) return std::nullopt;
    sum += *at->second;
  }
  return sum;
}

std::string energies_in_words(const RunStatus& s) {
  struct Kind {
    const char* name;
    std::vector<std::string_view> columns;
  };
  std::string text;
  for (const Kind& kind :
       {Kind{"kinetic", {"kinetic_translation", "kinetic_rotation"}},
        Kind{"stored", {"U_L", "U_B", "U_T", "contact"}}, Kind{"dissipated", {"dissipated"}},
        Kind{"released", {"released"}}, Kind{"work", {"work_loads", "work_supports"}}})
    if (const auto energy = sum_of(s, kind.columns))
      text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", kind.name, *energy);
  return text;
}

std::string where(const RunStatus& s) {
  const StageStatus& stage = s.stage;
  std::string text = fmt::format("stage {} ({} of {}, {}), ", on_one_line(stage.name), stage.index + 1,
                                 stage.count, to_text(stage.kind));
  if (is_static(stage.kind)) return text + fmt::format("{} points", stage.steps);
  text += fmt::format("step {}, t = {:.6g}", s.step, s.time);
  if (stage.end_time) text += fmt::format(" of at most {:.6g}", *stage.end_time);
  const bool last = stage.index + 1 == stage.count;  // the steps of later ones may be shorter
  if (s.seconds_left) text += (last ? ", at most " : ", about ") + hours(*s.seconds_left) + " left";
  return text;
}

}  // namespace

Seen see(const std::filesystem::path& folder) {
  RunStatus status = read_status(folder);
  if (!has_gone(folder, status)) return {std::move(status)};
  status = read_status(folder);  // it may have said its last word since
  const bool gone = has_gone(folder, status);
  return {std::move(status), gone};
}

std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
  return printable(text);
}

std::vector<std::string> lines_of(const Seen& seen) {
  const RunStatus& s = seen.status;
  std::vector<std::string> lines{
      seen.gone ? fmt::format("gone: process {} has ended without a word, as when it is killed", s.process)
                : to_text(s.state)};
  lines.push_back(where(s));
  if (const std::string energies = energies_in_words(s); !energies.empty()) lines.push_back(energies);
  if (s.broken) lines.push_back(fmt::format("{} bond{} broken", *s.broken, *s.broken == 1 ? "" : "s"));
  if (!s.last_event.empty()) lines.push_back(on_one_line(s.last_event));
  return lines;
}

}  // namespace vbond::app
