#pragma once
#include <filesystem>

namespace vbond::app {

/// Has a browser draw a page at its end, without a window, and writes the picture. Throws IoError, also if
/// there is no browser.
void take_still(const std::filesystem::path& html, const std::filesystem::path& png);

}  // namespace vbond::app
