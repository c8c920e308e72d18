#pragma once
#include <string>
#include <vector>

#include "vbond/fit/case_run.hpp"
#include "vbond/fit/measured.hpp"

namespace vbond::fit {

/// The curves of a run at points.
struct AtPoints {
  std::vector<double> y;    ///< NaN beyond the rows
  std::vector<double> off;  ///< how far interpolation may be off, see Between
  /// Of each value whose slopes the rows have d y / d value at the points; empty: not known.
  std::vector<std::vector<double>> slopes;
};

/// rows.columns: x, then y of each measured curve. `file` and `x` for messages. Throws CaseError if some x
/// goes back.
AtPoints at_points(const Rows& rows, const std::vector<Point>& points, const std::string& file,
                   const std::string& x);

}  // namespace vbond::fit
