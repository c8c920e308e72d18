#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/physics/break_mode.hpp"
#include "vbond/physics/strength.hpp"

namespace vbond {

/// A row of breaks.csv, as far as words need it.
struct BreakTold {
  std::int64_t bond = 0, i = 0, j = 0;
  double time = 0;  ///< [time]
  std::string criterion, mode;
  Failure<double> failure{};
  std::optional<double> limit;  ///< [force/area]
  double energy = 0;            ///< [energy]
};

struct BreaksTold {
  std::vector<BreakTold> first;               ///< in the order of the file
  std::int64_t count = 0;                     ///< of all
  std::map<std::string, std::int64_t> modes;  ///< how many of each
};

/// Reads breaks.csv, at most so many of its rows for words. Throws IoError if it is missing or damaged.
BreaksTold read_breaks(const std::filesystem::path& path, std::size_t most);

/// Of the names that breaks.csv has; other for those that it has not.
BreakMode break_mode(const std::string& name);

/// Why it broke: "N/A + M_b r/J = 9 + 3.1 = 12.1 of 12 MPa", without an end.
std::string cause_in_words(const BreakTold& told, UnitSystem units);

/// "bond 12 (particles 7, 8) broke at t = 0.12 s in tension: ...", one sentence without an end of line.
std::string in_words(const BreakTold& told, UnitSystem units);

/// "3 bonds broke: 2 in tension, 1 in shear".
std::string in_words(const BreaksTold& told);

}  // namespace vbond
