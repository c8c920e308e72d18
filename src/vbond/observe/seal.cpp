#include "vbond/observe/seal.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>
#include <string_view>

#include "vbond/core/error.hpp"
#include "vbond/observe/files.hpp"

namespace vbond {
namespace {

constexpr std::string_view before_format = "vbond checkpoint\nformat ";
constexpr std::string_view before_program = "\nprogram ";
constexpr std::string_view before_checksum = "\nfnv1a64 ";

/// FNV-1a in 64 bits (Fowler, Noll, Vo) of all bytes after the seal: finds accidents, not forgery.
std::uint64_t checksum(std::FILE* f, const std::filesystem::path& path) {
  std::uint64_t sum = 14695981039346656037u;
  std::fseek(f, static_cast<long>(seal_size), SEEK_SET);
  std::array<unsigned char, 1 << 16> block;
  for (std::size_t n; (n = std::fread(block.data(), 1, block.size(), f)) > 0;)
    for (std::size_t k = 0; k < n; ++k) sum = (sum ^ block[k]) * 1099511628211u;
  require_read(f, path);
  return sum;
}

/// Takes `key` and the text up to the end of its line off the front; nothing if it does not stand there.
std::optional<std::string_view> take_line(std::string_view& text, std::string_view key) {
  if (text.substr(0, key.size()) != key) return std::nullopt;
  text.remove_prefix(key.size());
  const std::string_view value = text.substr(0, text.find('\n'));
  text.remove_prefix(value.size());
  return value;
}

}  // namespace

void write_seal(const std::filesystem::path& path, std::int32_t format, const std::string& program_version) {
  const File f = open_file(path, "r+b");
  std::string seal = fmt::format("{}{}{}{}{}{:016x}\n", before_format, format, before_program,
                                 program_version, before_checksum, checksum(f.get(), path));
  if (seal.size() > seal_size) throw IoError("the program's version is too long a text");
  seal.resize(seal_size, '\0');
  std::rewind(f.get());
  write_all(f.get(), seal, path);
}

void check_seal(const std::filesystem::path& path, std::int32_t oldest, std::int32_t newest) {
  const File f = open_file(path, "rb");
  std::array<char, seal_size> head{};
  const std::size_t size = std::fread(head.data(), 1, head.size(), f.get());
  require_read(f.get(), path);
  std::string_view text(head.data(), size);
  const auto format_text = take_line(text, before_format), program = take_line(text, before_program);
  const auto sum = take_line(text, before_checksum);
  std::int32_t format = 0;
  if (!format_text || !program || !sum ||
      std::from_chars(format_text->data(), format_text->data() + format_text->size(), format).ec !=
          std::errc{})
    throw IoError("is not a checkpoint of vbond, or is damaged or cut short");
  if (format < oldest || format > newest)
    throw IoError(fmt::format(
        "was written by vbond {}, in format {}; this program reads formats {} and {}: use that version",
        *program, format, oldest, newest));
  if (*sum != fmt::format("{:016x}", checksum(f.get(), path)))
    throw IoError("is damaged or cut short: its checksum does not fit its content");
}

}  // namespace vbond
