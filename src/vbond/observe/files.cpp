#include "vbond/observe/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

[[noreturn]] void fail(const char* what, const std::filesystem::path& path, int error) {
  throw IoError(std::string("cannot ") + what + " " + path.string() + ": " + std::strerror(error));
}

using FileStatus = struct stat;

/// Devices, pipes and sockets, by a link too, are not replaced: for root there would be no /dev/null
/// afterwards.
void refuse_to_replace_device(const std::filesystem::path& path) {
  FileStatus s{};
  if (::stat(path.c_str(), &s) == 0 && !S_ISREG(s.st_mode) && !S_ISDIR(s.st_mode))
    throw IoError("cannot replace " + path.string() + ": it is a device, a pipe or a socket");
}

/// Asks the disk to keep a file, or with O_DIRECTORY the names in a folder.
void sync_to_disk(const std::filesystem::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0) fail("open", path, errno);
  const int result = ::fsync(fd);
  const int error = errno;
  ::close(fd);
  // EINVAL, EROFS: this file system has nothing to sync here, as some do for folders
  if (result != 0 && error != EINVAL && error != EROFS) fail("write", path, error);
}

}  // namespace

File open_file(const std::filesystem::path& path, const char* mode) {
  const bool writes = mode[0] != 'r' || std::strchr(mode, '+');
  if (mode[0] == 'w') remove_file(path);
  const int flags = !writes          ? O_RDONLY
                    : mode[0] == 'w' ? O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW
                    : mode[0] == 'a' ? O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW
                                     : O_RDWR | O_NOFOLLOW;
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  File f(fd < 0 ? nullptr : ::fdopen(fd, mode));
  if (f) return f;
  const int error = errno;
  if (fd >= 0) ::close(fd);
  fail(writes ? "write" : "read", path, error);
}

void remove_file(const std::filesystem::path& path) {
  refuse_to_replace_device(path);
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) fail("replace", path, errno);
}

void write_all(std::FILE* f, std::string_view bytes, const std::filesystem::path& path) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), f) != bytes.size() || std::fflush(f) != 0)
    fail("write", path, errno);
}

void require_read(std::FILE* f, const std::filesystem::path& path) {
  if (std::ferror(f)) fail("read", path, errno);
}

File nameless_file(const std::filesystem::path& beside) {
  std::filesystem::path name = temporary_name(beside);
  name += ".arrays";
  remove_file(name);
  const int fd = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_APPEND | O_CLOEXEC, 0600);
  File f(fd < 0 ? nullptr : ::fdopen(fd, "a+b"));
  const int error = errno;
  if (fd >= 0) ::unlink(name.c_str());
  if (fd >= 0 && !f) ::close(fd);
  if (!f) fail("write", name, error);
  return f;
}

void read_at(std::FILE* f, std::uint64_t at, char* to, std::size_t size, const std::filesystem::path& path) {
  while (size > 0) {
    const ssize_t n = ::pread(::fileno(f), to, size, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("read", path, errno);
    if (n == 0) throw IoError("cannot read " + path.string() + ": it is shorter than it was");
    at += static_cast<std::uint64_t>(n), to += n, size -= static_cast<std::size_t>(n);
  }
}

std::string read_all(const std::filesystem::path& path) {
  const File f = open_file(path, "rb");
  std::string content;
  char block[1 << 16];
  for (std::size_t n; (n = std::fread(block, 1, sizeof block, f.get())) > 0;) content.append(block, n);
  require_read(f.get(), path);
  return content;
}

void cut_file(const std::filesystem::path& path, std::uintmax_t size) {
  const File f = open_file(path, "r+b");
  if (::ftruncate(::fileno(f.get()), static_cast<off_t>(size)) != 0) fail("shorten", path, errno);
}

void make_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) fail("make the folder", path, error.value());
}

std::filesystem::path temporary_name(const std::filesystem::path& path) {
  std::filesystem::path name = path;
  name += ".part";
  return name;
}

void publish(const std::filesystem::path& path, Sync sync) {
  const std::filesystem::path part = temporary_name(path);
  refuse_to_replace_device(path);
  if (sync == Sync::to_disk) sync_to_disk(part, O_RDONLY);
  if (std::rename(part.c_str(), path.c_str()) != 0) fail("replace", path, errno);
  if (sync == Sync::none) return;
  const std::filesystem::path folder = path.parent_path();
  sync_to_disk(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
}

Replacement::Replacement(std::filesystem::path path)
    : path_(std::move(path)), part_(temporary_name(path_)), file_(open_file(part_, "wb")) {}

Replacement::~Replacement() {
  if (published_) return;
  std::error_code ignored;  // what went wrong before is told
  std::filesystem::remove(part_, ignored);
}

void Replacement::publish(Sync sync) {
  if (std::fclose(file_.release()) != 0) fail("write", part_, errno);
  vbond::publish(path_, sync);
  published_ = true;
}

void replace_file(const std::filesystem::path& path, std::string_view content, Sync sync) {
  Replacement replacement(path);
  replacement.write(content);
  replacement.publish(sync);
}

GrowingFile::GrowingFile(std::filesystem::path path, Begin begin) : path_(std::move(path)) {
  if (begin == Begin::anew) open_file(path_, "wb");
  file_ = open_file(path_, "ab");
  std::error_code error;
  size_ = std::filesystem::file_size(path_, error);
  if (error) fail("read", path_, error.value());
}

void GrowingFile::append(std::string_view bytes) {
  require_untouched();
  write_all(file_.get(), bytes, path_);
  size_ += bytes.size();
}

void GrowingFile::require_untouched() const {
  FileStatus ours{}, there{};
  if (fstat(fileno(file_.get()), &ours) != 0) fail("look at", path_, errno);
  const bool is_there = stat(path_.c_str(), &there) == 0;
  if (!is_there && errno != ENOENT && errno != ENOTDIR) fail("look at", path_, errno);
  const char* what = !is_there                                                    ? "removed"
                     : ours.st_ino != there.st_ino || ours.st_dev != there.st_dev ? "replaced"
                     : static_cast<std::uintmax_t>(there.st_size) != size_        ? "changed by others"
                                                                                  : nullptr;
  if (what)
    throw IoError(path_.string() + ": was " + what +
                  " while the run wrote it, so it does not hold all results\n"
                  "  nothing is written any more: leave the files of a run alone until it has ended");
}

}  // namespace vbond
