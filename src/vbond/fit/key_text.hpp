#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include "vbond/core/error.hpp"

namespace vbond::fit {

/// A number of a case file as it stands there, so that another one can take its place.
struct NumberInText {
  double value = 0;       ///< in its own unit
  std::string unit;       ///< as written; empty: none
  SourcePlace place;      ///< of its key
  std::size_t begin = 0;  ///< of the value in the text, in bytes
  std::size_t end = 0;
  /// This number in its unit, as TOML: what stands behind = in --set, and in the file.
  std::string toml(double number) const;
};

/// Finds the number of a key in the text of a case file. path: as before the = of --set (change.hpp).
/// `option` names what asked for it, for messages. Throws CaseError if the text has no such key, or if what
/// it has is no number.
NumberInText number_in(std::string_view text, const std::string& file, const std::string& path,
                       const std::string& option);

/// What a number without a unit, or with a unit of its own, is in the unit of another number: for bounds.
/// Throws CaseError if the units do not fit; `option` is named as the place.
double in_unit_of(const NumberInText& number, std::string_view text, const std::string& option);

}  // namespace vbond::fit
