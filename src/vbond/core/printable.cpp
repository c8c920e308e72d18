#include "vbond/core/printable.hpp"

#include <cstdint>

namespace vbond {
namespace {

struct Letter {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  ///< 0: this is not UTF-8
};

Letter first_letter(std::string_view text) {
  const auto byte = [text](std::size_t k) -> std::uint32_t {
    return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U;
  };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc2 ? 2 : 0;
  if (bytes == 0 || first > 0xf4) return {};
  std::uint32_t code = first & (0x7fU >> bytes);
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xc0U) != 0x80U) return {};
    code = code << 6U | (byte(k) & 0x3fU);
  }
  constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < least[bytes] || code > 0x10ffff) return {};  // a longer form than needed hides what it is
  return {code, bytes};
}

bool is_shown(std::uint32_t code) {
  if (code == '\n' || code == '\t') return true;
  const bool control = code < 0x20 || (code >= 0x7f && code < 0xa0);
  const bool turns = (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  return !control && !turns;
}

void add_hexadecimal(const char* mark, std::uint32_t code, int digits, std::string& text) {
  text += mark;
  for (int k = digits - 1; k >= 0; --k) text += "0123456789abcdef"[code >> 4 * k & 15U];
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const auto [code, bytes] = first_letter(text);
    if (bytes > 0 && is_shown(code))
      shown += text.substr(0, bytes);
    else if (bytes > 0 && code > 0xff)
      add_hexadecimal("\\u", code, 4, shown);
    else
      add_hexadecimal("\\x", bytes > 0 ? code : static_cast<unsigned char>(text[0]), 2, shown);
    text.remove_prefix(bytes > 0 ? bytes : 1);
  }
  return shown;
}

}  // namespace vbond
