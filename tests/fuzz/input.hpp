#pragma once
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <unistd.h>

#include "temporary_folder.hpp"

/// What the fuzzers of files share: a folder to put them in, and seeds.
namespace vbond::fuzz {

using Folder = test::TemporaryFolder;

/// A folder of this process. Give it memory to live in: TMPDIR=/dev/shm.
inline const Folder& folder() {
  static const Folder made("vbond_fuzz_" + std::to_string(getpid()));
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
