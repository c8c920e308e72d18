#pragma once
#include "vbond/statics/detail/body.hpp"

namespace vbond::testing {

/// What a body's tangent and load direction should be where it stands: by central differences of what is out
/// of balance. The error is h^2 times third derivatives, and rounding over h.
struct ByDifferences {
  DenseMatrix tangent;    ///< with the antisymmetric part
  Vector load_direction;  ///< supports moving with the load factor
};

inline ByDifferences by_differences(StaticBody& body, double h = 1e-5) {
  const Placement here = body.placement();
  const auto at = [&](const Vector& x, double factor) {
    body.restore(here);
    body.move(x, here.load_factor + factor);
    return Vector(body.unbalanced());
  };
  const Eigen::Index size = body.unknowns().size();
  ByDifferences d{DenseMatrix(size, size), Vector(size)};
  for (Eigen::Index k = 0; k < size; ++k) {
    const Vector x = h * Vector::Unit(size, k);
    d.tangent.col(k) = (at(-x, 0.0) - at(x, 0.0)) / (2.0 * h);
  }
  const Vector none = Vector::Zero(size);
  d.load_direction = (at(none, h) - at(none, -h)) / (2.0 * h);
  body.restore(here);
  return d;
}

}  // namespace vbond::testing
