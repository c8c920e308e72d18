#include "vbond/statics/detail/homogenising.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "vbond/model/bond_sums.hpp"
#include "vbond/statics/detail/kinks.hpp"

namespace vbond {
StaticStage stage_of_homogenising(const NewtonSettings& newton) {
  StaticStage stage;
  stage.name = homogenise_name;
  stage.newton = newton;
  return stage;
}

Model about_cell_of(const Model& model, const State& state) {
  Model now = model;
  now.cell.triangular = false;
  for (std::size_t k = 0; k < 3; ++k) now.cell.edges[k] = state.cell[k].along;
  return now;
}

void refuse_what_is_no_material(const Model& model, const State& state) {
  require_material(model.walls.empty(), "a wall is no part of a material: leave walls out");
  require_material(
      state.waiting.empty() && state.dropped.empty(),
      "particles have not come in yet, or were dropped: constants are those of a body with all of them");
}

/// Its angular energies are differences of terms of the size of angular_scale().
bool is_at_rest(const State& s, BondId k) {
  constexpr double rounding = 1e-12;  // of the energy of a bond that is stretched by its length
  const Bond& b = s.bonds[k];
  const BondEnergy<double> U = bond_energy(s, k);
  return U.U_L + U.U_B + U.U_T <=
         rounding * b.law->stiffness(b).c_A * sq(b.a) + 16.0 * epsilon * angular_scale(b);
}

void refuse_kinks(const Model& model, const State& s) {
  if (const std::optional<Kink> kink = kink_at(model, s))
    require_material(false, kink->what + "; " + kink->way_out);
}

DenseMatrix solved_with_tangent(TangentSolver& solver, const StaticBody& body, const DenseMatrix& columns) {
  if (!solver.factor_definite(body)) {
    const EigenPairs lowest = solver.near_zero(body, 1);
    throw NoEquilibrium(
        homogenise_name,
        fmt::format("some motion of particles has no stiffness, or less than none; most of all {}",
                    body.unknowns().names_of_largest(lowest.vectors.col(0))),
        "bonds without bending or torsional stiffness leave hinges: give them some, or more neighbours; of a "
        "body under stress look for its buckling loads");
  }
  if (!solver.by_multigrid()) return solver.solve_columns(columns);
  DenseMatrix X(columns.rows(), columns.cols());
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const Vector x = solver.solve(columns.col(k));
    if (x.size() == 0)
      throw NoEquilibrium(homogenise_name, "the tangent is not positive definite", "look for buckling loads");
    X.col(k) = x;
  }
  return X;
}

std::size_t unbroken_bonds(const State& state) {
  return static_cast<std::size_t>(
      std::count_if(state.bonds.begin(), state.bonds.end(), [](const Bond& b) { return !b.broken; }));
}

}  // namespace vbond
