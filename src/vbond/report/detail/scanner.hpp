#pragma once
#include <charconv>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "vbond/core/error.hpp"

namespace vbond {

/// Goes through a text of known form; throws IoError where it has another one.
class Scanner {
 public:
  Scanner(std::string_view text, const std::filesystem::path& path) : text_(text), path_(path) {}

  bool next_is(std::string_view literal) const { return text_.substr(at_, literal.size()) == literal; }
  bool take(std::string_view literal) {
    if (!next_is(literal)) return false;
    at_ += literal.size();
    return true;
  }
  void expect(std::string_view literal) {
    if (!take(literal)) refuse();
  }
  /// Everything up to a character, which is taken as well.
  std::string_view until(char end) {
    const std::size_t to = text_.find(end, at_);
    if (to == std::string_view::npos) refuse();
    const std::string_view part = text_.substr(at_, to - at_);
    at_ = to + 1;
    return part;
  }
  template <class T>
  T number() {
    T value{};
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{}) refuse();
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  std::size_t at() const { return at_; }
  bool at_end() const { return at_ == text_.size(); }

  [[noreturn]] void refuse() const {
    const std::string_view rest = text_.substr(at_, text_.find('\n', at_) - at_);
    throw IoError(path_.string() + ": was not written by this version of vbond, or is damaged, at \"" +
                  std::string(rest.substr(0, 60)) + '"');
  }

 private:
  std::string_view text_;
  const std::filesystem::path& path_;
  std::size_t at_ = 0;
};

}  // namespace vbond
