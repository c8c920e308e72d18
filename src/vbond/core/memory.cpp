#include "vbond/core/memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace vbond {
namespace {

namespace fs = std::filesystem;

constexpr double no_limit = std::numeric_limits<double>::infinity();

/// The number in a file of the kernel; none if there is no such file, or if it says "max".
double limit_in(const fs::path& file) {
  std::ifstream in(file);
  double bytes = 0.0;
  return in >> bytes ? bytes : no_limit;
}

/// The least limit of a control group and those above it. In a container its own path may not be visible:
/// then the groups above it, of which the topmost is the container, still are.
double limit_of_group(const fs::path& mount, fs::path group, const char* file) {
  double least = limit_in(mount / file);
  for (group = group.relative_path(); !group.empty(); group = group.parent_path())
    least = std::min(least, limit_in(mount / group / file));
  return least;
}

/// Lines of /proc/self/cgroup are NUMBER:CONTROLLERS:PATH, with 0::PATH for version 2 (cgroups(7)).
double limit_of_groups(const fs::path& root) {
  std::ifstream in(root / "proc/self/cgroup");
  const fs::path mounts = root / "sys/fs/cgroup";
  double least = no_limit;
  for (std::string line; std::getline(in, line);) {
    const std::size_t one = line.find(':'), two = line.find(':', one + 1);
    if (one == std::string::npos || two == std::string::npos) continue;
    const std::string controllers = ',' + line.substr(one + 1, two - one - 1) + ',';
    const fs::path group = line.substr(two + 1);
    if (controllers == ",,") least = std::min(least, limit_of_group(mounts, group, "memory.max"));
    if (controllers.find(",memory,") != std::string::npos)
      least = std::min(least, limit_of_group(mounts / "memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

double limit_of_shell() {
  double least = no_limit;
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA})
    if (rlimit limit{}; getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      least = std::min(least, static_cast<double>(limit.rlim_cur));
  return least;
}

}  // namespace

double machine_memory(const fs::path& root) {
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::min(machine, limit_of_groups(root));
}

double memory_limit(const fs::path& root) {
  return std::min(machine_memory(root), limit_of_shell());
}

}  // namespace vbond
