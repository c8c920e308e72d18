#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "vbond/observe/files.hpp"

namespace vbond {

/// Bytes that wait until they are written: in memory as long as they are few, then in a file that has no
/// name, and goes with the spool.
class Spool {
 public:
  static constexpr std::size_t in_memory = 8 << 20;  ///< bytes at most

  /// beside: a path in the folder of that file; none: all stay in memory.
  explicit Spool(std::filesystem::path beside = {}) : beside_(std::move(beside)) {}

  /// Where some bytes wait.
  struct Piece {
    bool in_file;
    std::uint64_t at, size;
  };
  /// Throws IoError, as when the disk is full.
  Piece keep(std::string_view bytes);
  /// Throws IoError.
  void copy(const Piece& piece, Replacement& to) const;

 private:
  std::filesystem::path beside_;
  std::string memory_;
  File file_;
  std::uint64_t file_size_ = 0;
};

}  // namespace vbond
