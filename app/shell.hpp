#pragma once
#include <string>

namespace vbond::app {

/// A word as a POSIX shell reads it back: as it is if it is plain, else quoted.
std::string shell_word(const std::string& word);

}  // namespace vbond::app
