#pragma once
#include "judge.hpp"

namespace vbond::campaign {

/// A thin shell as a case file: cylinders, panels and domes of triangles, pressed, moved or twisted.
struct ShellCase {
  int number = 0;
  std::string kind, what;
  std::string text;  ///< the case file, with one stage of kind buckling
  int count = 1;     ///< of critical loads wanted
};

ShellCase random_shell(unsigned seed, int number);

/// Runs buckling, the path through the loads that it tells of, and the witness of inertia.hpp, each in a
/// process of its own. The reference of the record holds the loads that the witness has seen.
CaseRecord run_shell(const ShellCase& c);

}  // namespace vbond::campaign
