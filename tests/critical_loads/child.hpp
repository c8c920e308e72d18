#pragma once
#include <functional>
#include <string>

namespace vbond::campaign {

/// What a process left behind.
struct ChildResult {
  std::string text;  ///< what its work returned
  std::string fate;  ///< empty: it ended in peace; else what became of it
};

/// Does this in a process of its own, which may crash, or take more seconds of its processor than it has.
ChildResult in_child(const std::function<std::string()>& work, int seconds);

}  // namespace vbond::campaign
