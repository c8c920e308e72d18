#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "lock.hpp"
#include "shell.hpp"
#include "signals.hpp"
#include "status.hpp"
#include "terminal.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/observe/report.hpp"

namespace vbond::app {
namespace {

/// How a run stands, as far as it can be seen from outside.
struct Seen {
  RunStatus status;
  bool gone = false;  ///< its process is, without a word on the end
  bool goes_on() const { return status.state == RunState::running && !gone; }
};

/// Whether a process of this machine is not there any more; of others nothing is known.
bool has_gone(const RunStatus& s) {
  return s.state == RunState::running && s.host == host_name() &&
         kill(static_cast<pid_t>(s.process), 0) != 0 && errno == ESRCH;
}

Seen see(const std::filesystem::path& folder) {
  RunStatus status = read_status(folder);
  if (!has_gone(status)) return {std::move(status)};
  status = read_status(folder);  // it may have said its last word since
  const bool gone = has_gone(status);
  return {std::move(status), gone};
}

/// Text of a file on one line of a terminal.
std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
  return printable(text);
}

/// At most `width` letters.
std::string cut(const std::string& line, int width) {
  std::size_t bytes = 0;
  for (int letters = 0; bytes < line.size(); ++bytes)
    if ((static_cast<unsigned char>(line[bytes]) & 0xc0U) != 0x80U && ++letters > width) break;
  return line.substr(0, bytes);
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
  if (s.seconds_left) text += ", at most " + hours(*s.seconds_left) + " left";
  return text;
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

/// Shows how a run stands: on a terminal in place of what it has shown before, else a line whenever it
/// changes.
class Display {
 public:
  void show(const Seen& seen) {
    std::vector<std::string> lines = lines_of(seen);
    if (isatty(STDOUT_FILENO) != 0)
      repaint(seen.status, lines);
    else
      print(lines);
  }

 private:
  void repaint(const RunStatus& s, std::vector<std::string>& lines) {
    lines.insert(lines.begin(), on_one_line(s.name));
    lines.push_back(fmt::format("process {} on {}, {} after its start, at {}", s.process, on_one_line(s.host),
                                hours(s.wall_seconds), on_one_line(s.written)));
    std::string text;
    if (shown_ > 0)
      text = fmt::format("\033[{}F\033[J", shown_);  // up to the first line, clear all (ECMA-48)
    for (const std::string& line : lines) text += cut(line, terminal_width() - 1) + '\n';
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
    shown_ = lines.size();
  }
  void print(const std::vector<std::string>& lines) {
    const std::string line = fmt::format("{}\n", fmt::join(lines, "; "));
    if (line != last_) say(line);
    last_ = line;
  }

  std::size_t shown_ = 0;  // lines
  std::string last_;
};

/// A second, or until a signal comes.
void wait_a_second() {
  if (caught_signal() == 0) poll(nullptr, 0, 1000);
}

int status_of_end(const Seen& seen, const WatchOptions& o) {
  const RunStatus& s = seen.status;
  if (s.state == RunState::complete) return done;
  if (s.state == RunState::failed) {
    say(s.failure + "\n", stderr);
  } else {
    const bool resumable = std::filesystem::exists(o.folder / "checkpoint.h5");
    say(resumable ? "go on with: " + shell_word(o.program) + " resume " + shell_word(o.folder.string()) + "\n"
                  : "it has left no checkpoint: run its case again\n",
        stderr);
  }
  return failed;
}

}  // namespace

int watch(const WatchOptions& o) {
  catch_broken_pipe();
  catch_signals();
  Display display;
  while (true) {
    const Seen seen = see(o.folder);
    display.show(seen);
    if (!seen.goes_on()) return status_of_end(seen, o);
    if (o.once) return done;
    wait_a_second();
    if (caught_signal() != 0) return 128 + caught_signal();
  }
}

}  // namespace vbond::app
