#pragma once
#include <string>
#include <utility>
#include <vector>

namespace vbond {

/// What was reached where a specimen was made at random: each figure by its name, one number or more.
struct SpecimenFigures {
  std::string specimen;
  std::vector<std::pair<std::string, std::vector<double>>> figures;
  friend bool operator==(const SpecimenFigures&, const SpecimenFigures&) = default;
};

}  // namespace vbond
