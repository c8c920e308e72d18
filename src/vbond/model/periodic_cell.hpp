#pragma once
#include <array>
#include <string>
#include <vector>

#include "vbond/core/tensor.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/cell_drive.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

/// How the cell of a periodic body has deformed, the stress of the body, and what can be wrong with a cell.
namespace vbond {

/// The tensor that has these components.
Tensor cell_tensor(const std::array<double, 6>& components, bool triangular);
/// Those of a tensor: of its upper triangle.
std::array<double, 6> cell_components(const Tensor& t);
/// F of these edges.
Tensor cell_gradient(const CellShape& shape, const CellEdges& cell);
/// L = dF/dt F^-1 with the rates of the edges.  [1/time]
Tensor cell_velocity_gradient(const CellEdges& cell);

/// Of what particles move beside the flow of the cell, as the books have it.  [energy]
double kinetic_energy_beside_flow(const Model& model, const State& state);

/// The stress of the body: V stress = sum of F_i (x) r_ij over pairs, less the momentum that the particles'
/// own velocities carry beyond their mean by mass, the sum of m (c - C) (x) (c - C); tension > 0. Elastic
/// forces and friction, no damping of bonds. Symmetric but for moments on particles that are out of balance.
/// [force/length^2]
Tensor cell_stress(const Model& model, const BodyPart& body);

/// A sentence for each component whose stress is not what a stage of motion asks for at this time: off by
/// more than a hundredth of the largest stress, and of what a strain of 1e-4 makes with the servo's modulus.
std::vector<std::string> stresses_not_reached(const CellDrive& drive, const State& state, double time);

/// A bound of the stiffness that the bonds give the body against changes of the cell's components, several at
/// once too, while particles follow the cell and do not turn.  [force/length^2]
double affine_modulus(const CellShape& shape, const State& state);

/// The same of the stress that damping of bonds adds per rate of the components that a stress moves.
/// [force/length^2*time]
double affine_viscosity(const CellShape& shape, const State& state, const CellDrive& drive);

/// Whether a surface is the same one edge further, for each edge that is periodic: planes along them, and
/// endless cylinders around the only one.
bool repeats_with_cell(const WallShape& shape, const CellShape& cell);
/// Whether it stays so: a cylinder may turn about its own axis, and nothing else.
bool may_turn_in_cell(const WallShape& shape, const WallDrive& drive);

std::vector<std::string> mistakes_in_cell(const Model& model);
std::vector<std::string> mistakes_in_cell(const Model& model, const State& state);
/// at_rest: of a static stage, which has no servo and no factors.
std::vector<std::string> mistakes_in_drive(const Model& model, const CellDrive& drive, bool at_rest);

/// Which axes of the world open edges are along.
std::array<bool, 3> open_axes(const CellShape& shape);

}  // namespace vbond
