#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "bodies.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond::testing {

using Edges = std::array<Vec3d, 3>;

inline Edges cube(double side) {
  return {Vec3d{side, 0, 0}, Vec3d{0, side, 0}, Vec3d{0, 0, side}};
}

/// Particles in a cell that repeats along all edges, without bonds.
inline Specimen periodic_body(const Edges& edges, const std::vector<Vec3d>& r, double radius = 0.4) {
  Specimen s{equal_particles(r, 1.0, 0.064, radius), {}};
  s.model.cell = {edges, {true, true, true}, {}, false};
  s.state = at_rest(s.model);
  return s;
}

inline void bond_image(Specimen& s, std::size_t i, std::size_t j, const Image& of_j,
                       const BondRecipe& recipe) {
  s.state.bonds.push_back(make_bond(recipe, bond_site(s.model, s.state, ParticleId{i}),
                                    bond_site(s.model, s.state, ParticleId{j}, of_j))
                              .value());
}

/// Bonds all pairs of particles and images within a distance.
inline void bond_within(Specimen& s, double distance, const BondRecipe& recipe) {
  for_near_images(
      s.state.cell, s.model.cell.periodic, s.state.r.values(), distance,
      [&](std::size_t i, std::size_t j, const Image& n, double) { bond_image(s, i, j, n, recipe); });
}

inline CellComponent strained(double by) {
  return {CellComponent::By::strain, by, {}};
}
inline CellComponent stressed(double to) {
  return {CellComponent::By::stress, to, {}};
}

/// The cell goes so in an equilibrium: xx, yy, zz, yz, xz, xy.
inline StaticStage cell_stage(const std::array<CellComponent, 6>& component, int steps = 1) {
  StaticStage stage = static_stage(StageKind::equilibrium, {});
  stage.cell.component = component;
  stage.newton.tolerance = 1e-13;
  stage.steps = steps;
  return stage;
}

inline std::array<double, 6> cell_strain(const Specimen& s, const State& state) {
  return cell_components(cell_gradient(s.model.cell, state.cell));
}
inline SymmetricParts stress_of(const Specimen& s, const State& state) {
  return symmetric_part(cell_stress(s.model, state));
}
inline double energy_of(const Specimen& s, const State& state) {
  const StaticStage stage = static_stage(StageKind::equilibrium, {});
  return StaticBody(s.model, stage, state).energies().potential();
}

}  // namespace vbond::testing
