#pragma once
#include "vbond/model/model.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/unknowns.hpp"

namespace vbond {

/// Square roots of the mass that goes with each unknown: mass, or inertia / length^2 of a turn.
Vector roots_of_mass(const Model& model, const Unknowns& unknowns);

/// M^-1/2 K M^-1/2, whose eigenvalues are the squares of angular frequencies.  [1/time^2]
SparseMatrix mass_scaled(const SparseMatrix& K, const Vector& roots_of_mass);

}  // namespace vbond
