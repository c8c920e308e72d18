#pragma once
#include <cstdint>
#include <string>

#include "vbond/case/node.hpp"
#include "vbond/case/read.hpp"

namespace vbond::keys {

/// Where keys that a change has set stand: on a line that no file has, the number of the change beyond this.
inline constexpr std::uint32_t first_changed_line = 1u << 30;

/// Makes the change "PATH=VALUE" in the tree of a case file. PATH is names of keys joined by dots; behind the
/// name of a list stands which of its items, in brackets: by place from 0, or by its name. VALUE is what TOML
/// has behind =, or plain text that needs no quotes here. Tables that are not there are made, items of lists
/// are not. What it sets stands on first_changed_line + number. Throws CaseError for a text that is no such
/// change, for an item that is not there, and for a key that an earlier change has set, if that is
/// refused.
void apply_change(const std::string& text, std::uint32_t number, NodeTable& root, SetTwice twice);

}  // namespace vbond::keys
