#pragma once
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond {

/// A value and where it stands in the case file, for errors that only setup/ can find.
template <class T>
struct Placed {
  T value{};
  SourcePlace place;
};

/// A time: a number in the model's unit, or a multiple of T_0, which is known only after building.
struct CaseTime {
  double value = 0;
  bool in_T_0 = false;
  double resolve(double T_0) const { return in_T_0 ? value * T_0 : value; }
};

/// A factor over the time of a stage.
struct TimeFunctionSpec {
  std::vector<std::pair<CaseTime, double>> points;  ///< empty: constant 1
};

}  // namespace vbond
