#pragma once
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <unistd.h>

/// What the fuzzers of files share: a folder to put them in, and seeds.
namespace vbond::fuzz {

/// A folder of this process, gone at its end. Give it memory to live in: TMPDIR=/dev/shm.
class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("vbond_fuzz_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline const Folder& folder() {
  static const Folder made;
  return made;
}

inline std::filesystem::path put(const std::filesystem::path& path, std::string_view content) {
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

inline std::string content_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The folder that seeds are to be written to instead of fuzzing: $VBOND_FUZZ_SEEDS, else null.
inline const char* seeds() {
  return std::getenv("VBOND_FUZZ_SEEDS");
}

inline void add_seed(const std::string& name, std::string_view content) {
  put(std::filesystem::path(seeds()) / name, content);
}

}  // namespace vbond::fuzz
