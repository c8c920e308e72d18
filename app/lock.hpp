#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace vbond::app {

/// Names of the lock files in an output folder. They are there while they are held, and after a crash.
inline constexpr const char* run_lock = "run.lock";  ///< held by run and resume
inline constexpr const char* report_lock =
    "report.lock";  ///< held by whoever writes report.html, or removes it

/// Of this machine.
std::string host_name();

/// Keeps other processes out of an output folder, or of its report, while it lives (flock on a lock file,
/// which the system gives up when the process ends, however it ends). The file says who holds it and is
/// removed in the end. Child processes do not inherit it.
class FolderLock {
 public:
  /// Throws IoError if another process holds it, saying which, or if the lock file cannot be made. Where the
  /// file system has no locks, it only warns on stderr.
  FolderLock(const std::filesystem::path& folder, const char* name);
  ~FolderLock();
  FolderLock(FolderLock&& o) noexcept;
  FolderLock& operator=(FolderLock&& o) = delete;

 private:
  bool take();
  std::filesystem::path path_;
  int fd_ = -1;
};

/// Throws IoError if another process holds that lock of the folder; writes nothing.
void require_free(const std::filesystem::path& folder, const char* name);

/// Whether a process holds that lock of the folder. Nothing where that cannot be told: the file system has no
/// locks, or the file is not ours to read. Writes nothing, and keeps nobody out for longer than a moment.
std::optional<bool> is_held(const std::filesystem::path& folder, const char* name);

}  // namespace vbond::app
