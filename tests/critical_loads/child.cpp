#include "child.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <exception>
#include <stdexcept>

namespace vbond::campaign {
namespace {

void write_all(int to, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(to, text.data() + done, text.size() - done);
    if (n <= 0) return;
    done += static_cast<std::size_t>(n);
  }
}

[[noreturn]] void be_child(const std::function<std::string()>& work, int seconds, int to) {
  const auto limit = static_cast<rlim_t>(seconds);
  const rlimit processor{limit, limit + 1}, no_core{0, 0};
  setrlimit(RLIMIT_CPU, &processor);
  setrlimit(RLIMIT_CORE, &no_core);
  std::string text;
  try {
    text = "+" + work();
  } catch (const std::exception& e) {
    text = std::string("-") + e.what();
  } catch (...) {
    text = "-an exception that is none of the standard library's";
  }
  write_all(to, text);
  _exit(0);
}

}  // namespace

ChildResult in_child(const std::function<std::string()>& work, int seconds) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    close(ends[0]);
    be_child(work, seconds, ends[1]);
  }
  close(ends[1]);
  std::string text;
  char buffer[65536];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
    return {"", fmt::format("no end after {} s", seconds)};
  if (WIFSIGNALED(status)) return {"", fmt::format("killed: {}", strsignal(WTERMSIG(status)))};
  if (text.empty()) return {"", fmt::format("ended with status {}", WEXITSTATUS(status))};
  if (text[0] == '-') return {"", "exception: " + text.substr(1)};
  return {text.substr(1), ""};
}

}  // namespace vbond::campaign
