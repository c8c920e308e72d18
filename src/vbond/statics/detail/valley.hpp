#pragma once
#include <functional>

#include "vbond/statics/detail/newton.hpp"

namespace vbond {

struct ValleyWalk {
  bool found = false;  ///< the body stands where the valley is lowest; otherwise as far as the walk came
  bool interrupted = false;
  int iterations = 0;
};

/// Leaves an unstable balance along its lowest mode: the body is moved along it by more and more and balanced
/// each time but for the modes, until nothing drives it on along that one. Near a critical load that valley
/// is so flat that neither the potential nor what is out of balance shows its end: the drive over the
/// amplitude does, which begins at minus the eigenvalue and is known as well as that. modes: orthonormal,
/// those that are unstable, the lowest first; along the others the body stays where it is. first: the first
/// amplitude, of either sign.  [length]
ValleyWalk walk_down_valley(StaticBody& body, TangentSolver& solver, const DenseMatrix& modes,
                            double eigenvalue, double first, const std::function<bool()>& interrupted);

}  // namespace vbond
