#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"
#include "vbond/physics/break_mode.hpp"
#include "vbond/physics/strength.hpp"

namespace vbond {

/// A row of breaks.csv, as far as words need it.
struct BreakTold {
  std::int64_t bond = 0, i = 0, j = 0;
  std::int64_t stage = 0, step = 0;
  double time = 0;                         ///< [time]
  bool at_rest = false;                    ///< in a static stage: step is the number of a point
  std::optional<double> load_factor = {};  ///< of a static stage, if it is known
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

/// Marks the breaks of static stages, with their load factors as far as fracture.csv in that folder has them.
/// Throws IoError if it is damaged.
void find_load_factors(BreaksTold& told, const Case& c, const std::filesystem::path& folder);

/// Of the names that breaks.csv has; other for those that it has not.
BreakMode break_mode(const std::string& name);

/// "t = 0.12 s"; of a static stage, where time says nothing, "load factor 0.5" or "point 12".
std::string when_in_words(const BreakTold& told, UnitSystem units);

/// Why it broke: "N/A + M_b r/J = 9 + 3.1 = 12.1 of 12 MPa", without an end.
std::string cause_in_words(const BreakTold& told, UnitSystem units);

/// "bond 12 (particles 7, 8) broke at t = 0.12 s in tension: ...", or "at load factor 0.5", one sentence
/// without an end of line.
std::string in_words(const BreakTold& told, UnitSystem units);

/// "3 bonds broke: 2 in tension, 1 in shear".
std::string in_words(const BreaksTold& told);

}  // namespace vbond
