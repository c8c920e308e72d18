#pragma once
#include <array>
#include <cstddef>
#include <string>

#include "vbond/core/vec3.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {

/// Of 11, 22 and 12, with engineering shear or twist.
using SheetConstants = std::array<std::array<double, 3>, 3>;

/// The plate that a sheet is: per width, membrane forces and moments
///
///     N = A e + B k,   M = B^T e + D k,   energy per area 1/2 (e A e + 2 e B k + k D k),
///
/// e being the strain of its plane, k its curvature: k = -(w_11, w_22, 2 w_12), w along the normal, so that a
/// fibre at height z above the plane is strained by e + z k.
struct HomogenisedSheet {
  SheetConstants A{};  ///< [force/length]
  SheetConstants B{};  ///< [force]; rows: e
  SheetConstants D{};  ///< [force*length]
  /// 1, 2 and the normal: axes of the world in cyclic order.
  std::array<Vec3d, 3> axes;
  /// Where the plane cuts the normal's axis: at the centre of mass of all that do not float.  [length]
  double plane = 0;
  double area = 0;     ///< of the cell  [length^2]
  double density = 0;  ///< mass of all particles per area  [mass/length^2]
  std::size_t particles = 0, bonds = 0;
  /// Particles of parts that hang together with none of their images: they carry nothing, and are left out of
  /// all but the density.
  std::size_t floating = 0;
  /// Parts that carry, and do not hang together with each other: layers of them are strained and curved about
  /// one plane, as if they could not slide.
  std::size_t parts = 0;
  std::string solver;  ///< "direct" or "multigrid"
};

/// Constants of a sheet: a body with a cell that is periodic in two directions, whose plane is normal to an
/// axis of the world, and open in the third. One factor of the tangent, and six solutions. What is curved
/// repeats when it is shifted and turned: an image that is L away is turned by n x (k L), and moved by
/// e L + z (k L) - (x.k L + L.k L/2) n, where the particle itself stands at (x, z). Transverse shear costs
/// what it does in uniform bending. Throws std::invalid_argument if model or state have a mistake, the cell
/// is another one, there are walls, particles are absent, bonds are strained, they or contacts have a kink
/// there, or particles touch that are not bonded. Throws NoEquilibrium if some particles can move at no cost.
HomogenisedSheet homogenise_sheet(const Model& model, const State& state, const NewtonSettings& newton = {});

}  // namespace vbond
