#include "sweep.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>

#include "campaign.hpp"
#include "commands.hpp"
#include "lock.hpp"
#include "shell.hpp"
#include "signals.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/csv.hpp"
#include "vbond/observe/files.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// The first problem of a point that is told on stderr, on one line.
std::string reason_in(const fs::path& log, int status) {
  std::istringstream text(read_all(log));
  std::string reason, line;
  while (std::getline(text, line) && (reason.empty() || line.starts_with("  ")))
    reason += (reason.empty() ? "" : "; ") + line.substr(std::min(line.size(), line.find_first_not_of(' ')));
  if (!reason.empty()) return reason;
  if (WIFSIGNALED(status)) return fmt::format("ended by signal {}", WTERMSIG(status));
  return fmt::format("exit status {}", WEXITSTATUS(status));
}

/// The points of a sweep and their processes. What has ended stands in sweep.journal, line by line, so that
/// it is never run again. A run whose output could not be written, or that a signal has ended, has not: it
/// goes on the next time.
class Sweep {
 public:
  Sweep(const SweepOptions& options, std::vector<SweptKeys> keys, fs::path folder)
      : options_(options),
        keys_(std::move(keys)),
        points_(points_of(keys_)),
        folder_(std::move(folder)),
        journal_(folder_ / "sweep.journal", fs::exists(folder_ / "sweep.journal")
                                                ? GrowingFile::Begin::at_end
                                                : GrowingFile::Begin::anew) {
    read_journal();
  }

  /// Runs all points, or those before a signal or before one whose output could not be written.
  void run() {
    const std::size_t before = ends_.size();
    if (before > 0) say(fmt::format("{} of {} points have ended before\n", before, points_.size()));
    std::size_t next = 0;
    while (true) {
      while (caught_signal() == 0 && stopped_with_ != bad_io &&
             running_.size() < static_cast<std::size_t>(options_.jobs) && next < points_.size()) {
        if (!has_ended(next)) start(next);
        ++next;
      }
      if (running_.empty()) break;
      wait_for_one();
    }
  }
  void write_table(const std::string& title) {
    std::sort(ends_.begin(), ends_.end(),
              [](const PointEnd& a, const PointEnd& b) { return a.point < b.point; });
    write_sweep_table(folder_, title, keys_, ends_);
  }
  std::size_t failed() const {
    return static_cast<std::size_t>(
        std::count_if(ends_.begin(), ends_.end(), [](const PointEnd& e) { return e.failed; }));
  }
  std::size_t points() const { return points_.size(); }
  std::size_t ended() const { return ends_.size(); }
  /// With which status runs have stopped that go on the next time: 3, or 128 + signal.
  int stopped_with() const { return stopped_with_; }

 private:
  struct Running {
    std::size_t point;
    std::chrono::steady_clock::time_point start;
  };

  void read_journal() {
    std::istringstream text(read_all(folder_ / "sweep.journal"));
    for (std::string line; std::getline(text, line);) {
      const std::vector<std::string> cells = csv_cells(line);
      const auto point = cells.size() == 4 ? csv_number<std::size_t>(cells[0]) : std::nullopt;
      const auto seconds = cells.size() == 4 ? csv_number<double>(cells[2]) : std::nullopt;
      if (!point || !seconds || *point < 1 || *point > points_.size())
        throw IoError((folder_ / "sweep.journal").string() + ": \"" + line +
                      "\" is no end of a point\n  remove that line: its point is run again");
      ends_.push_back({*point - 1, cells[1] == "failed", *seconds, csv_plain(cells[3])});
    }
  }
  bool has_ended(std::size_t point) const {
    return std::any_of(ends_.begin(), ends_.end(), [&](const PointEnd& e) { return e.point == point; });
  }

  fs::path log_of(std::size_t point) const { return point_folder(folder_, point).string() + ".log"; }

  void start(std::size_t point) {
    const fs::path folder = point_folder(folder_, point);
    std::vector<std::string> words{options_.program};
    if (fs::exists(folder / "checkpoint.h5") && fs::exists(folder / "resolved.toml"))
      words.insert(words.end(), {"resume", folder.string()});
    else
      words.insert(words.end(), {"run", options_.case_file.string(), "-o", folder.string(), "--force"});
    if (words[1] == "run")
      for (const std::string& change : points_[point]) words.insert(words.end(), {"--set", change});
    words.insert(words.end(), {"--quiet", "--threads", std::to_string(options_.threads)});
    running_[spawn(words, log_of(point))] = {point, std::chrono::steady_clock::now()};
  }

  /// A process that ends, with a checkpoint, when this one ends.
  static pid_t spawn(const std::vector<std::string>& words, const fs::path& log) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const std::string log_name = log.string();
    const pid_t parent = getpid(), pid = fork();
    if (pid < 0) throw IoError(std::string("cannot start a process: ") + std::strerror(errno));
    if (pid > 0) return pid;
    const int file = open(log_name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0 || getppid() != parent || file < 0 || dup2(file, 2) < 0)
      _exit(bad_io);
    execv("/proc/self/exe", arguments.data());
    _exit(bad_io);
  }

  void wait_for_one() {
    int status = 0;
    pid_t pid = 0;
    while ((pid = waitpid(-1, &status, 0)) < 0)
      if (caught_signal() != 0)  // of a terminal it has reached them, too; a second one does no harm
        for (const auto& [child, running] : running_) kill(child, SIGTERM);
    const auto at = running_.find(pid);
    if (at == running_.end()) return;
    const auto [point, start] = at->second;
    running_.erase(at);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (code != done && (code == bad_io || code > 128 || caught_signal() != 0)) {
      if (caught_signal() == 0) stop(point, code, status);
      return;
    }
    PointEnd end{point, code != done, seconds, code == done ? "" : reason_in(log_of(point), status)};
    journal_.append(csv_line({std::to_string(point + 1), end.failed ? "failed" : "done",
                              std::to_string(seconds), csv_quoted(end.reason)}));
    ends_.push_back(end);
    if (!end.failed) fs::remove(log_of(point));
    say(fmt::format("{} of {}: point {} {} in {:.3g} s{}\n", ends_.size(), points_.size(), point + 1,
                    end.failed ? "failed" : "done", seconds, end.failed ? ": " + end.reason : ""));
  }

  /// It goes on the next time. Where output could not be written no more points are begun: they would end
  /// alike.
  void stop(std::size_t point, int code, int status) {
    if (stopped_with_ != bad_io) stopped_with_ = code;
    say(fmt::format("point {} has not ended: {}{}\n", point + 1, reason_in(log_of(point), status),
                    code == bad_io && !running_.empty() ? "\n  waiting for those under way" : ""),
        stderr);
  }

  const SweepOptions& options_;
  std::vector<SweptKeys> keys_;
  std::vector<std::vector<std::string>> points_;
  fs::path folder_;
  GrowingFile journal_;
  std::vector<PointEnd> ends_;
  std::map<pid_t, Running> running_;
  int stopped_with_ = done;
};

/// What the sweep is of: the case with all defaults, and the swept keys. A folder has one sweep.
std::string definition_of(const Case& c, const std::vector<std::string>& sets) {
  std::string text = "# vbond sweep\n";
  for (const std::string& set : sets) text += "# --set " + set + "\n";
  return text + to_toml(c);
}

void require_same_sweep(const fs::path& folder, const std::string& definition) {
  const fs::path file = folder / "sweep.toml";
  if (fs::exists(file)) {
    if (read_all(file) == definition) return;
    throw std::invalid_argument(folder.string() + " has another sweep: of another case, or of other values" +
                                "\n  give another folder with -o, or remove this one");
  }
  const auto begun = [](const fs::directory_entry& e) { return e.path().filename() == "sweep.toml.part"; };
  if (fs::exists(folder) && !std::all_of(fs::directory_iterator(folder), {}, begun))
    throw std::invalid_argument(folder.string() +
                                " is not empty, and holds no sweep\n  give another folder with -o");
  make_folder(folder);
  replace_file(file, definition);
}

/// Throws the mistakes of the first point if no point at all can be read: then it is a key that is wrong.
void require_any_point(const fs::path& case_file, const std::vector<std::vector<std::string>>& points) {
  std::optional<CaseError> first;
  for (const auto& changes : points) {
    try {
      read_case(case_file, changes);
      return;
    } catch (const CaseError& e) {
      if (!first) first = e;
    }
  }
  throw *first;
}

}  // namespace

fs::path point_folder(const fs::path& sweep, std::size_t point) {
  return sweep / fmt::format("{:04}", point + 1);
}

int sweep(const SweepOptions& options) {
  if (options.case_file == "-")
    throw std::invalid_argument(
        "a sweep reads its case again and again: give a file, not the standard input");
  std::vector<SweptKeys> keys;
  for (const std::string& text : options.sets) keys.push_back(swept_keys(text));
  const Case c = read_case(options.case_file);
  const auto points = points_of(keys);
  require_any_point(options.case_file, points);
  const fs::path folder = options.folder.value_or(options.case_file.stem().string() + ".sweep");
  catch_signals();  // before there are files
  require_same_sweep(folder, definition_of(c, options.sets));
  const FolderLock lock(folder, run_lock);
  Sweep sweep(options, std::move(keys), folder);
  sweep.run();
  if (sweep.ended() < sweep.points())  // said before files are written: the disk may be full
    say(fmt::format("{}{} of {} points have ended; the same command goes on\n",
                    caught_signal() != 0 ? "stopped by a signal: " : "", sweep.ended(), sweep.points()),
        stderr);
  sweep.write_table(c.title);
  say(fmt::format("{} points, {} failed: {}\n", sweep.ended(), sweep.failed(),
                  (folder / "sweep.csv").string()));
  if (fs::exists(folder / "sweep.html")) say("curves in " + (folder / "sweep.html").string() + "\n");
  if (sweep.ended() < sweep.points())
    return caught_signal() != 0 ? 128 + caught_signal() : sweep.stopped_with();
  return sweep.failed() > 0 ? failed : done;
}

}  // namespace vbond::app
