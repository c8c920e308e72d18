#include "shell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace vbond::app {
namespace {

bool is_plain(unsigned char c) {
  return c >= 0x80 || std::isalnum(c) ||
         std::string_view("_./-+,:=@%").find(static_cast<char>(c)) != std::string::npos;
}

bool is_control(unsigned char c) {
  return c < 0x20 || c == 0x7f;
}

}  // namespace

std::string shell_word(const std::string& word) {
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  const bool controls = std::any_of(word.begin(), word.end(), is_control);
  std::string quoted = controls ? "$'" : "'";  // only $'...' has names for what would upset a terminal
  for (const char c : word) {
    if (controls && is_control(static_cast<unsigned char>(c)))
      quoted += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    else if (controls && (c == '\'' || c == '\\'))
      quoted += std::string("\\") + c;
    else
      quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted + '\'';
}

}  // namespace vbond::app
