#pragma once
#include <string_view>

namespace vbond {

/// Takes this off the beginning of a name; false if it begins otherwise.
inline bool take_off_front(std::string_view& name, std::string_view front) {
  if (!name.starts_with(front)) return false;
  name.remove_prefix(front.size());
  return true;
}

/// The same at its end.
inline bool take_off_end(std::string_view& name, std::string_view end) {
  if (!name.ends_with(end)) return false;
  name.remove_suffix(end.size());
  return true;
}

}  // namespace vbond
