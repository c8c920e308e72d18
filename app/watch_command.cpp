#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "live_page.hpp"
#include "seen.hpp"
#include "shell.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "vbond/observe/table_text.hpp"

namespace vbond::app {
namespace {

/// At most `width` letters.
std::string cut(const std::string& line, int width) {
  std::size_t bytes = 0;
  for (int letters = 0; bytes < line.size(); ++bytes)
    if ((static_cast<unsigned char>(line[bytes]) & 0xc0U) != 0x80U && ++letters > width) break;
  return line.substr(0, bytes);
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
  std::optional<LivePage> page;
  Seen seen = see(o.folder);
  if (o.page) {
    page.emplace(o.folder, static_cast<std::uint16_t>(o.port));
    say("page at " + page->address() + "\n");
  }
  for (;; seen = see(o.folder)) {
    display.show(seen);
    if (!seen.goes_on()) break;
    if (o.once) return done;
    wait_a_second();
    if (caught_signal() != 0) return 128 + caught_signal();
  }
  if (page) {
    say("the page stays until Ctrl-C\n");
    while (caught_signal() == 0) wait_a_second();
  }
  return status_of_end(seen, o);
}

}  // namespace vbond::app
