#pragma once
#include <filesystem>

namespace vbond {

/// Memory that this process may have at most: that of the machine, or less where a container (cgroup, version
/// 1 or 2) or the shell (ulimit) sets a limit.  [bytes] root: where proc and sys are looked for.
double memory_limit(const std::filesystem::path& root = "/");

}  // namespace vbond
