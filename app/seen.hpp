#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "status.hpp"

namespace vbond::app {

/// How a run stands, as far as it can be seen from outside.
struct Seen {
  RunStatus status;
  bool gone = false;  ///< its process is, without a word on the end
  bool goes_on() const { return status.state == RunState::running && !gone; }
};

/// Throws as read_status does.
Seen see(const std::filesystem::path& folder);

/// Text of a file on one line of a terminal.
std::string on_one_line(std::string text);

/// It in words: its state, where it is, energies, bonds that broke, the last event.
std::vector<std::string> lines_of(const Seen& seen);

}  // namespace vbond::app
