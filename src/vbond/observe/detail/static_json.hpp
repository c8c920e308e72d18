#pragma once
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "vbond/core/error.hpp"
#include "vbond/observe/summary.hpp"

namespace vbond {

using Json = nlohmann::ordered_json;

/// A static stage as its object in run.json, without name and time.
Json to_json(const StaticSummary& s);

/// The same back, without shapes and residuals. Throws Json::exception or IoError, without the file's name.
StaticSummary static_summary(const Json& j);

/// A vector as a list of three numbers, and back. Throws Json::exception or IoError.
inline Json to_json(const Vec3d& x) {
  return Json::array({x.x, x.y, x.z});
}
inline Vec3d vector_from(const Json& j) {
  if (!j.is_array() || j.size() != 3) throw IoError("a vector is not a list of 3");
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

/// A whole number from 0 to `most`. Throws IoError: Json's own way turns 1e300 and -1 into any number.
inline std::int64_t whole_number(const Json& j,
                                 std::int64_t most = std::numeric_limits<std::int64_t>::max()) {
  const bool fits = j.is_number_unsigned() && j.get<std::uint64_t>() <= static_cast<std::uint64_t>(most);
  if (!fits) throw IoError(j.dump(-1, ' ', true, Json::error_handler_t::replace) + " is not a count");
  return j.get<std::int64_t>();
}

/// The same as an int.
inline int small_number(const Json& j) {
  return static_cast<int>(whole_number(j, std::numeric_limits<int>::max()));
}

/// The value of this name among `all`. Throws IoError.
template <class E, std::size_t n>
E named(const Json& j, const std::array<E, n>& all) {
  const auto& name = j.get_ref<const std::string&>();
  for (const E e : all)
    if (name == to_text(e)) return e;
  throw IoError('"' + name + "\" is unknown");
}

}  // namespace vbond
