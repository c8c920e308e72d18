#pragma once
#include <array>
#include <string>
#include <vector>

#include "vbond/case/read.hpp"
#include "vbond/setup/build.hpp"

/// Bonds between two large and two small grains, by the text of a case; what tests of bonds of packings
/// share.
namespace vbond::two_sizes {

inline const std::string grains =
    "[[specimen]]\nname = \"large\"\nkind = \"list\"\npositions = [[0, 0, 0], [4.1, 0, 0]]\nradius = 2\nmass "
    "= 8\n"
    "[[specimen]]\nname = \"small\"\nkind = \"list\"\npositions = [[0, 3, 0], [0, 5.05, 0]]\nradius = 1\n"
    "mass = 1\n";
inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline const std::string still = "[[stage]]\nduration = 1\n";

inline Case of_two_sizes(const std::string& bonds, const std::string& more = "") {
  return parse_case(grains + more + "[[bonds]]\nname = \"b\"\n" + bonds + still, "case.toml");
}
inline std::string mistake_of(const std::string& bonds, const std::string& more = "") {
  try {
    build(of_two_sizes(bonds, more));
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

inline const std::string stiff = "stiffness = { c_A = 1, c_D = 0.3, c_B = 0.1, c_T = 0.1 }\n";

using PairList = std::vector<std::array<std::size_t, 2>>;
inline PairList pairs_of(const Built& b) {
  PairList pairs;
  for (const Bond& bond : b.state.bonds) pairs.push_back({bond.i.value, bond.j.value});
  return pairs;
}

}  // namespace vbond::two_sizes
