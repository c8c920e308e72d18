#pragma once
#include <filesystem>
#include <string>

namespace vbond {

/// All bytes of a file. Throws IoError with the name and the system's reason if it cannot be opened, or if
/// reading fails before its end.
std::string read_file(const std::filesystem::path& file);

/// The same of the standard input.
std::string read_standard_input();

}  // namespace vbond
