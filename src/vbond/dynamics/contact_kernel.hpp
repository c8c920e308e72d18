#pragma once
#include <cstdint>

#include "vbond/dynamics/rows.hpp"
#include "vbond/physics/hertz.hpp"

namespace vbond {

/// Two particles are deep in one another when their centres are nearer than this part of the sum of their
/// radii: for equal ones, when they overlap by half a radius.
inline constexpr double deep_part = 0.75;

/// Which rows are near which: those of row i are rows[start[i]], ... up to end[i]. Behind the last of all,
/// rows_at_once more can be read and are rows.
struct NearRows {
  const std::size_t *start, *end;
  const Row* rows;
};

/// How particles repel each other, and how large they are.
struct ContactRule {
  enum class Kind : std::uint8_t {
    alike,     ///< all radii are equal, and `law` is that of all pairs
    same_law,  ///< radii are not, but the law is
    by_radii,  ///< Hertz's law of E* and the radii of the pair
  };
  Kind kind;
  HertzContact<double> law;
  double E_star;         ///< [force/area]
  const double* radius;  ///< of each row  [length]
};

/// Adds to the loads of these rows the forces of all that touch them, in the order in which they are listed.
/// Returns whether two of them are nearer than deep_part of the sum of their radii.
using ContactLoop = bool(const ContactRule&, const NearRows&, RowRange, const PoseRow*, LoadRow*);

}  // namespace vbond
