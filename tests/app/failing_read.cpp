// Preloaded by reading_test: reading the file VBOND_FAILING_FILE fails as on a bad disk once VBOND_FAILING_AT
// bytes of it were read.
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <string>

namespace {

bool is_the_file(int descriptor) {
  const char* wanted = std::getenv("VBOND_FAILING_FILE");
  char name[PATH_MAX];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t size = ::readlink(link.c_str(), name, sizeof name);
  return wanted != nullptr && size > 0 && std::string(name, static_cast<std::size_t>(size)) == wanted;
}

}  // namespace

extern "C" ssize_t read(int descriptor, void* buffer, size_t size) {
  if (is_the_file(descriptor)) {
    const long most = std::atol(std::getenv("VBOND_FAILING_AT")), at = ::lseek(descriptor, 0, SEEK_CUR);
    if (at >= most) {
      errno = EIO;
      return -1;
    }
    size = std::min(size, static_cast<size_t>(most - at));
  }
  return ::syscall(SYS_read, descriptor, buffer, size);
}
