#pragma once
#include <string>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/unknowns.hpp"

namespace vbond {

/// The motions as a rigid body, of each connected part (by bonds and contacts), that supports do not hold.
struct RigidMotions {
  DenseMatrix basis;               ///< orthonormal columns over the unknowns
  std::vector<std::string> names;  ///< one per column, e.g. "rotation about x of particles 0 to 9"
};

RigidMotions free_rigid_motions(const Model& model, const State& state, const Unknowns& unknowns);

}  // namespace vbond
