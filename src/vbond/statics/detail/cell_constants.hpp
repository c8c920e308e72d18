#pragma once
#include <optional>
#include <vector>

#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/newton.hpp"
#include "vbond/statics/homogenise.hpp"

namespace vbond {

/// The constants of one periodic body, with one choice of stiffnesses of its bonds after the other: what
/// homogenise() asks of a body is asked once, and factors are kept.
class CellConstants {
 public:
  /// Looks at the body and brings it into balance; throws what homogenise() throws.
  CellConstants(const Model& model, const State& given, const HomogeniseSettings& settings);

  /// The body in balance.
  const State& state() const { return state_; }
  /// As that body is. Throws what homogenise() throws.
  Homogenised found() { return found_with(state_); }
  /// With other stiffnesses of its bonds, of a body with derivatives: bonds are at rest, so that it stays in
  /// balance. A stiffness that was > 0 must be so again, and one that was 0 stays 0: then the tangent is a
  /// sum of the same parts, none of them negative, and as definite as it was.
  Homogenised found_with(const State& state);

 private:
  const HomogeniseSettings settings_;
  const Model model_;  // its cell as it stands is the one that strains count from
  State state_;
  bool moved_ = false;
  StaticStage stage_;  // that holds what floats
  TangentSolver solver_;
  DenseMatrix X_;  // how particles move with the cell, as last found
};

}  // namespace vbond
