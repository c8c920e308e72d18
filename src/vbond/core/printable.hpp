#pragma once
#include <string>
#include <string_view>

namespace vbond {

/// A text that a terminal only shows: control characters but line end and tab, and what turns the direction
/// of writing, are written as \x1b or \u202e, and so are bytes that no UTF-8 begins with. Names in files may
/// hold any.
std::string printable(std::string_view text);

}  // namespace vbond
