#include "terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

namespace vbond::app {

int terminal_width() {
  constexpr int usual = 80, narrowest = 40;
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return usual;
  return std::max(narrowest, static_cast<int>(size.ws_col));
}

}  // namespace vbond::app
