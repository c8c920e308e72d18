#include "vbond/core/read_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

[[noreturn]] void refuse_unread(const std::string& name, int error) {
  throw IoError(name + ": cannot be read: " + std::strerror(error));
}

/// What is left to read.
std::string rest_of(int descriptor, const std::string& name) {
  constexpr std::size_t block = std::size_t{1} << 18;
  std::string content;
  for (;;) {
    const std::size_t size = content.size();
    content.resize(size + block);
    const ssize_t got = ::read(descriptor, content.data() + size, block);
    if (got < 0 && errno != EINTR) refuse_unread(name, errno);
    content.resize(size + static_cast<std::size_t>(got > 0 ? got : 0));
    if (got == 0) return content;
  }
}

/// Closes a file when its reader leaves.
struct Descriptor {
  int number;
  ~Descriptor() { ::close(number); }
};

}  // namespace

std::string read_file(const std::filesystem::path& file) {
  const int number = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (number < 0) refuse_unread(file.string(), errno);
  const Descriptor closed_at_the_end{number};
  return rest_of(number, file.string());
}

std::string read_standard_input() {
  return rest_of(STDIN_FILENO, "the standard input");
}

}  // namespace vbond
