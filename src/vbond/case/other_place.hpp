#pragma once
#include <optional>
#include <string>

namespace vbond::keys {

/// Where a key belongs that stands in the wrong table.
struct OtherPlace {
  std::string rule, way_out;
};

/// In a table around this one, or inside of it; nothing if no such table has this key. path: of the table, as
/// in `stage[0].stop`; value: short.
std::optional<OtherPlace> other_place(const std::string& path, const std::string& key,
                                      const std::string& value);

}  // namespace vbond::keys
