#include "signals.hpp"

#include <csignal>

namespace vbond::app {
namespace {

volatile std::sig_atomic_t received = 0;

void remember(int signal) {
  received = signal;
  std::signal(signal, signal == SIGPIPE ? SIG_IGN : SIG_DFL);
}

void catch_unless_ignored(int signal) {
  if (std::signal(signal, remember) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

void catch_broken_pipe() {
  catch_unless_ignored(SIGPIPE);
}

void catch_signals() {
  std::signal(SIGINT, remember);
  std::signal(SIGTERM, remember);
  catch_unless_ignored(SIGHUP);
}

int caught_signal() {
  return received;
}

}  // namespace vbond::app
