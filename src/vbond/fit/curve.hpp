#pragma once
#include <cstddef>
#include <optional>
#include <vector>

namespace vbond::fit {

/// One column of history.csv over another, row by row.
struct Curve {
  std::vector<double> x, y;  ///< y is NaN where there is a gap
};

/// The first row at which x, which went one way before, goes back; nothing if it never does. Such a curve has
/// no single y at an x. Rows with the x of the row before are no way back.
std::optional<std::size_t> goes_back(const Curve& curve);

/// A value between rows.
struct Between {
  double y = 0;
  /// How far the straight line between the two rows may be off, by the second differences of the rows around:
  /// |y''| / 2 (x - x_k) (x_k+1 - x), [as y]; 0 where there are not enough rows to tell.
  double off = 0;
};

/// On straight lines between rows, of a curve that does not go back; where y jumps at an x, the first of the
/// two. Nothing if x is beyond the rows, or within a gap, by more than rounding (1e-9 of their span).
std::optional<Between> at(const Curve& curve, double x);

/// How at() changes at this x if rows move: `rates` has d x and d y of each row. NaN where at() is nothing.
double rate_at(const Curve& curve, const Curve& rates, double x);

}  // namespace vbond::fit
