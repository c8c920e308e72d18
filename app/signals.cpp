#include "signals.hpp"

#include <csignal>

namespace vbond::app {
namespace {

volatile std::sig_atomic_t received = 0;

void remember(int signal) {
  received = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_signals() {
  std::signal(SIGINT, remember);
  std::signal(SIGTERM, remember);
}

int caught_signal() {
  return received;
}

}  // namespace vbond::app
