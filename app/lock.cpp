#include "lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <thread>
#include <utility>

#include "campaign.hpp"
#include "vbond/core/error.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error) {
  throw IoError("cannot write " + path.string() + ": " + std::strerror(error));
}

std::string who_i_am() {
  return fmt::format("process {} on {} since {:%Y-%m-%d %H:%M:%S} UTC\n", getpid(), host_name(),
                     fmt::gmtime(std::time(nullptr)));
}

/// Who holds a lock file, by its first line, as far as that can be shown.
std::string holder(int fd) {
  std::array<char, 400> text{};
  const ssize_t size = pread(fd, text.data(), text.size(), 0);
  std::string line(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  line.resize(std::min(line.size(), line.find('\n')));
  const bool printable =
      std::all_of(line.begin(), line.end(), [](unsigned char c) { return std::isprint(c); });
  return printable && line.rfind("process ", 0) == 0 ? line : "another process";
}

/// Closes the lock file and tells who holds it.
[[noreturn]] void in_use(const fs::path& path, int fd) {
  const std::string who = holder(fd);
  ::close(fd);
  throw IoError(
      fmt::format("{}: is in use by {}, which holds {}\n  wait until it has ended, or use another folder",
                  path.parent_path().string(), who, path.filename().string()));
}

/// Tries for a moment: somebody may only be looking, and one who has just taken it still writes who it is.
bool try_lock(int fd, int kind) {
  using namespace std::chrono_literals;
  constexpr int tries = 10;
  for (int k = 0; k < tries; ++k) {
    if (flock(fd, kind | LOCK_NB) == 0) return true;
    if (errno != EWOULDBLOCK && errno != EINTR) return false;
    std::this_thread::sleep_for(20ms);
  }
  errno = EWOULDBLOCK;
  return false;
}

using FileStatus = struct stat;

/// False if the file was removed between opening and locking it: its last holder did that.
bool is_still_there(int fd, const fs::path& path) {
  FileStatus ours{}, there{};
  return fstat(fd, &ours) == 0 && stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

}  // namespace

std::string host_name() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '?';
  return host.data();
}

FolderLock::FolderLock(const fs::path& folder, const char* name) : path_(folder / name) {
  while (!take()) ::close(fd_);
}

FolderLock::FolderLock(FolderLock&& o) noexcept : path_(std::move(o.path_)), fd_(std::exchange(o.fd_, -1)) {}

FolderLock::~FolderLock() {
  if (fd_ < 0) return;
  if (is_still_there(fd_, path_)) ::unlink(path_.c_str());  // while it is held: nobody else's is removed
  ::close(fd_);
}

bool FolderLock::take() {
  fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (fd_ < 0) fail(path_, errno);
  if (!try_lock(fd_, LOCK_EX)) {
    if (errno == EWOULDBLOCK) in_use(path_, fd_);
    say(fmt::format("warning: {} cannot be locked ({}): see to it that no other run uses the folder\n",
                    path_.string(), std::strerror(errno)),
        stderr);
  } else if (!is_still_there(fd_, path_)) {
    return false;
  }
  const std::string me = who_i_am();
  const bool said = ftruncate(fd_, 0) == 0 && pwrite(fd_, me.data(), me.size(), 0) >= 0;
  static_cast<void>(said);  // on a full disk it cannot be said; the lock holds all the same
  return true;
}

void require_free(const fs::path& folder, const char* name) {
  const fs::path path = folder / name;
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return;
  if (!try_lock(fd, LOCK_SH) && errno == EWOULDBLOCK) in_use(path, fd);
  ::close(fd);
}

std::optional<bool> is_held(const fs::path& folder, const char* name) {
  const int fd = ::open((folder / name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return errno == ENOENT ? std::optional(false) : std::nullopt;
  const int error = flock(fd, LOCK_SH | LOCK_NB) == 0 ? 0 : errno;
  ::close(fd);
  if (error == 0) return false;
  return error == EWOULDBLOCK ? std::optional(true) : std::nullopt;
}

}  // namespace vbond::app
