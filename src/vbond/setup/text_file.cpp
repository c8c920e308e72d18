#include "vbond/setup/text_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

#include "vbond/core/read_file.hpp"

namespace vbond {
namespace {

template <class T>
std::optional<T> parsed(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Throws CaseError at `place` if it is no file or may not be read.
void require_file(const std::filesystem::path& file, const SourcePlace& place) {
  const auto refuse = [&](const std::string& reason) {
    throw CaseError({place, fmt::format("\"{}\" cannot be read: {}", file.string(), reason),
                     "file names are taken from the folder of the case file",
                     "check the name and the rights"});
  };
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (std::filesystem::is_directory(status)) refuse("it is a folder");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    refuse("it is not a regular file, of which the output folder could hold a copy");
  if (::access(file.c_str(), R_OK) != 0) refuse(std::strerror(errno));
}

}  // namespace

std::string read_bytes(const std::filesystem::path& file, const SourcePlace& place) {
  require_file(file, place);
  return read_file(file);
}

std::vector<std::string> read_lines(const std::filesystem::path& file, const SourcePlace& place) {
  const std::string content = read_bytes(file, place);
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < content.size();) {
    const std::size_t end = std::min(content.find('\n', at), content.size());
    const bool carriage_return = end > at && content[end - 1] == '\r';
    lines.push_back(content.substr(at, end - at - (carriage_return ? 1 : 0)));
    at = end + 1;
  }
  return lines;
}

std::filesystem::path beside_case(const std::string& case_file, const std::filesystem::path& file) {
  return std::filesystem::path(case_file).parent_path() / file;  // an absolute `file` replaces the folder
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

std::optional<double> to_number(std::string_view text) {
  const auto value = parsed<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> to_integer(std::string_view text) {
  return parsed<std::int64_t>(text);
}

}  // namespace vbond
