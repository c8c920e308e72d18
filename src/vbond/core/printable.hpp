#pragma once
#include <string>
#include <string_view>

namespace vbond {

/// A text that a terminal only shows. Control characters but line end and tab, characters that turn the
/// direction of writing, and bytes that no UTF-8 begins with are written as their numbers. Names in files may
/// hold any.
std::string printable(std::string_view text);

}  // namespace vbond
