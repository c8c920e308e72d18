#pragma once
#include <string>

#include "vbond/case/node.hpp"

namespace vbond::keys {

/// A key of a case file.
struct FoundKey {
  const Node* node = nullptr;
  bool in_list =
      false;  ///< it is an item of a list, and stands where its line and column say; else its key does
};

/// The key that a path names, as in a change (change.hpp), without making anything. Throws CaseError for a
/// text that is no path and for a key that is not there; `option` is named as the place.
FoundKey find_key(const std::string& path, NodeTable& root, const std::string& option);

}  // namespace vbond::keys
