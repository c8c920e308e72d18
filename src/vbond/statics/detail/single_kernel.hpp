#pragma once
#include <cstddef>

namespace vbond {

/// At most so many columns of a factor, and so many right-hand sides, at a time.
inline constexpr int widest_strip = 4, most_sides = 4;
/// The columns of a strip are filled up with zeros to a multiple of this, as sums have so many parts.
inline constexpr int sum_parts = 8;

constexpr int filled_up(int height) {
  return (height + sum_parts - 1) / sum_parts * sum_parts;
}

/// Some columns of L, one to widest_strip. `corner` is at their diagonal, entry row, column at widest_strip
/// column + row; `below` is what follows, filled_up(height) rows: of each sum_parts of them column after
/// column, so that memory is read from its begin to its end.
struct StripOfFactor {
  const float *corner, *below;
  int height;
  const float* next;  ///< the corner of the strip that comes next, which is on its way then; or nullptr
};

/// One step of a solution: x is at the first row of the strip, side c from x + c stride on, with room behind
/// as the columns of the strip have.
using StripStep = void (*)(const StripOfFactor& L, double* x, std::ptrdiff_t stride);

/// X - Z part for so many columns of X, `rows` long each. Z has `rank` columns, which lie `stride` apart, as
/// those of X do; part has so many rows, one after the other.
using SubtractProduct = void (*)(const double* Z, std::ptrdiff_t rows, int rank, const double* part,
                                 double* X, std::ptrdiff_t stride);

/// For a strip of w columns and s sides at [w - 1][s - 1]: L x = b, what lies below included, and L^T x = b.
struct SingleKernel {
  StripStep forward[widest_strip][most_sides], backward[widest_strip][most_sides];
  SubtractProduct subtract_product[most_sides];
};

/// That of the best instruction set that this processor has; numbers do not depend on it.
const SingleKernel& single_kernel();
/// With number 0 that of any processor, then those of wider vectors; nullptr: there are no more here.
const SingleKernel* single_kernel(int number);

}  // namespace vbond
