#pragma once
#include <filesystem>

namespace vbond {

/// Memory that all processes share: that of the machine, or less where a container (cgroup, version 1 or 2)
/// sets a limit.  [bytes] root: where proc and sys are looked for.
double machine_memory(const std::filesystem::path& root = "/");

/// Memory that this process may have at most: the same, or less where the shell (ulimit) sets a limit.
double memory_limit(const std::filesystem::path& root = "/");

}  // namespace vbond
