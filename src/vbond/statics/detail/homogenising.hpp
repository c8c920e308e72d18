#pragma once
#include <stdexcept>
#include <string>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/detail/newton.hpp"

/// What cells, sheets and finite bodies have in common where their constants are looked for.
namespace vbond {

inline constexpr const char* homogenise_name = "homogenise";  ///< of stages and in errors

/// Throws std::invalid_argument with the rule unless it holds.
inline void require_material(bool holds, const std::string& rule) {
  if (!holds) throw std::invalid_argument("homogenise: " + rule);
}

/// A stage that holds nothing and loads nothing, with the cell as it stands.
StaticStage stage_of_homogenising(const NewtonSettings& newton);

/// The cell as it stands is the one that strains count from.
Model about_cell_of(const Model& model, const State& state);

/// Throws std::invalid_argument if there are walls, or particles are absent: `homogenise: ...`.
void refuse_what_is_no_material(const Model& model, const State& state);
/// Throws std::invalid_argument where rounding would choose the stiffness: see kinks.hpp.
void refuse_kinks(const Model& model, const State& state);
/// To rounding: the energy of a bond is none.
bool is_at_rest(const State& state, BondId k);

/// Factors the tangent of the body and solves with it for each column. Throws NoEquilibrium, naming them, if
/// some particles can move at no cost.
DenseMatrix solved_with_tangent(TangentSolver& solver, const StaticBody& body, const DenseMatrix& columns);

std::size_t unbroken_bonds(const State& state);

}  // namespace vbond
