#include "still.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/observe/files.hpp"

extern char** environ;

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// A folder for the browser's own files, gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "vbond-XXXXXX").string();
    if (!mkdtemp(name.data())) throw IoError("cannot make the folder " + name + ": " + std::strerror(errno));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// file:// with every byte that is not plain written as %XX.
std::string url_of(const fs::path& html) {
  std::string url = "file://";
  for (const char c : fs::absolute(html).string())
    if (std::isalnum(static_cast<unsigned char>(c)) || std::strchr("/-._~", c))
      url += c;
    else
      url += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return url + "#still";
}

/// Starts the first of these programs that there is, silent. Nothing if there is none of them.
std::optional<pid_t> start_first(const std::vector<const char*>& programs,
                                 std::vector<std::string> arguments) {
  posix_spawn_file_actions_t silent;
  posix_spawn_file_actions_init(&silent);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&silent, stream, "/dev/null", O_WRONLY, 0);
  std::optional<pid_t> started;
  for (const char* program : programs) {
    std::string name = program;
    std::vector<char*> argv{name.data()};
    for (std::string& a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    pid_t pid = 0;
    if (posix_spawnp(&pid, program, &silent, nullptr, argv.data(), environ) == 0) {
      started = pid;
      break;
    }
  }
  posix_spawn_file_actions_destroy(&silent);
  return started;
}

/// Waits for a process, not for ever. Returns false if it had to be ended.
bool wait_for(pid_t pid) {
  using namespace std::chrono_literals;
  const auto last = std::chrono::steady_clock::now() + 120s;
  int status = 0;
  while (std::chrono::steady_clock::now() < last) {
    if (waitpid(pid, &status, WNOHANG) != 0) return true;
    std::this_thread::sleep_for(50ms);
  }
  kill(pid, SIGKILL);
  waitpid(pid, &status, 0);
  return false;
}

}  // namespace

void take_still(const fs::path& html, const fs::path& png) {
  const TemporaryFolder profile;
  const fs::path picture = profile.path() / "still.png";
  std::vector<std::string> arguments{"--headless",
                                     "--use-angle=swiftshader",  // no graphics card is needed
                                     "--enable-unsafe-swiftshader",
                                     "--hide-scrollbars",
                                     "--no-first-run",
                                     "--window-size=1280,900",
                                     "--virtual-time-budget=20000",  // ms of the page's own clock
                                     "--user-data-dir=" + profile.path().string(),
                                     "--screenshot=" + picture.string(),
                                     url_of(html)};
  if (geteuid() == 0) arguments.insert(arguments.begin(), "--no-sandbox");  // chromium refuses root otherwise
  const std::optional<pid_t> pid =
      start_first({"chromium", "chromium-browser", "google-chrome"}, std::move(arguments));
  if (!pid)
    throw IoError(html.string() +
                  " is written, but a picture of it needs a browser that is not here\n"
                  "  install chromium, or open the page elsewhere");
  std::error_code e;
  if (!wait_for(*pid) || !fs::exists(picture, e))
    throw IoError(html.string() + " is written, but chromium did not make a picture of it");
  replace_file(png, read_all(picture), Sync::none);
}

}  // namespace vbond::app
