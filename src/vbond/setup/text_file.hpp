#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond {

/// All lines of a file that a case names, without line ends (LF or CR LF).
/// Throws CaseError at `place`, where the case names it, if it cannot be opened; IoError if reading fails.
std::vector<std::string> read_lines(const std::filesystem::path& file, const SourcePlace& place);

/// All bytes of such a file. Throws like read_lines.
std::string read_bytes(const std::filesystem::path& file, const SourcePlace& place);

/// The file as seen from the folder of the case file.
std::filesystem::path beside_case(const std::string& case_file, const std::filesystem::path& file);

/// The words of a line, separated by blanks and tabs.
std::vector<std::string_view> words_of(std::string_view line);
/// A finite number, if that is all the text holds.
std::optional<double> to_number(std::string_view text);
/// A whole number, if that is all the text holds.
std::optional<std::int64_t> to_integer(std::string_view text);

/// The numbers of particles in a file of pairs, and what to say where one of them is wrong.
class PairNumbers {
 public:
  explicit PairNumbers(std::int64_t particles) : particles_(particles) {}
  void see(std::int64_t number) {
    least_ = std::min(least_, number);
    largest_ = std::max(largest_, number);
  }
  const char* way_out() const {
    return least_ == 1 && largest_ == particles_
               ? "its numbers seem to count from 1: subtract 1 from all of them"
               : "correct the pair";
  }

 private:
  std::int64_t particles_, least_ = INT64_MAX, largest_ = INT64_MIN;
};

}  // namespace vbond
