#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "vbond/case/fibre_spec.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/core/random.hpp"
#include "vbond/core/vec3.hpp"

/// Directions of fibres. Those of a given tensor have the angular central Gaussian distribution: p = x/|x|,
/// where x has independent Gaussian components with the variances lambda along the axes of the tensor. The
/// principal values of the mean of p p are
///
///     a_k = 1/2 int_0^oo lambda_k/(1 + lambda_k s) prod_j (1 + lambda_j s)^(-1/2) ds
///         = 1/3 sqrt(b_1 b_2 b_3) R_D(b_i, b_j; b_k),    b = 1/lambda,
///
/// with R_D Carlson's elliptic integral. In a plane (lambda_3 = 0) a_1/a_2 = sqrt(lambda_1/lambda_2). It is
/// the distribution of fibres that were isotropic and then went with a homogeneous flow (Montgomery-Smith et
/// al., J. Fluid Mech. 680 (2011) 321).
namespace vbond {

/// The principal values a, of sum 1, for lambda >= 0, not all of them 0.
Vec3d orientation_of_variances(const Vec3d& lambda);
/// Its inverse, to 1e-12, with sum 1; principal values below 1e-9 count as 0.
Vec3d variances_of_orientation(const Vec3d& a);

/// The mean of p p: xx, yy, zz, xy, xz, yz.
using OrientationTensor = std::array<double, 6>;
OrientationTensor mean_dyad(const std::vector<Vec3d>& directions);

/// Draws directions as a specimen asks for them.
class DirectionDraw {
 public:
  explicit DirectionDraw(const FibresSpecimen& spec);

  Vec3d draw(Random& random) const;
  /// n of them, turned and stretched a little, if they are 10 at least, so that their tensor is the asked one
  /// to rounding.
  std::vector<Vec3d> draw(std::size_t n, Random& random) const;
  /// How many dimensions directions have: 3, 2 in a plane, 1 if all are along one axis.
  int dimensions() const;
  /// The axis that all are normal to, of two dimensions.
  Vec3d normal() const { return axes_.z; }

 private:
  Axes<double> axes_;  ///< principal axes; 0 <= a.z <= a.y <= a.x
  Vec3d a_, lambda_;
};

}  // namespace vbond
