#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "vbond/core/tensor.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/statics/elastic_constants.hpp"

namespace vbond {

/// What C changes by if one stiffness of all bonds of a set grows: times that stiffness, so that it is the
/// derivative with the stiffness's logarithm.
struct ConstantsBySet {
  std::size_t set = 0;                   ///< Bond::set
  Constants c_A{}, c_D{}, c_B{}, c_T{};  ///< [force/length^2]
};

/// The material that the cell of a periodic body is a piece of.
struct Homogenised {
  /// How Cauchy's stress changes with strain of the cell without rotation, particles in balance meanwhile, in
  /// Voigt's order xx yy zz yz xz xy with engineering shear. Symmetric of a body without stress; else beside
  /// terms of the size of the stress.  [force/length^2]
  Constants C{};
  SymmetricParts stress{};  ///< xx yy zz yz xz xy, tension > 0  [force/length^2]
  double volume = 0;        ///< [length^3]
  double density = 0;       ///< [mass/length^3]
  std::size_t particles = 0, bonds = 0;
  /// Particles of parts that hang together with none of their images: they carry nothing, and are left out.
  std::size_t floating = 0;
  bool moved = false;  ///< the body was not in balance as it was given: constants are those where it is
  std::string solver;  ///< "direct" or "multigrid"
  std::vector<ConstantsBySet> derivatives;  ///< if asked for, in order of sets
};

struct HomogeniseSettings {
  NewtonSettings newton;
  bool derivatives = false;  ///< of bodies whose bonds are at rest
};

/// Elastic constants of a body whose cell is periodic in all directions, about the balance that it comes to
/// with its cell held: one factor of the tangent, and six solutions. Contacts repel as they do there, without
/// friction, and bonds at a limit of yield or softening are as stiff as they are when unloaded. Velocities do
/// not count. Throws std::invalid_argument if model or state have a mistake, the cell is open in some
/// direction, there are walls, particles are absent, or bonds or contacts have a kink there; with derivatives
/// also if bonds are strained, have flowed or stretch by a table, or particles touch. Throws NoEquilibrium if
/// there is no balance, or by the direct solver if some particles can move at no cost (mechanisms): a part
/// that nothing holds is left out, a mechanism is not.
Homogenised homogenise(const Model& model, const State& state, const HomogeniseSettings& settings = {});

}  // namespace vbond
