#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/statics/elastic_constants.hpp"

namespace vbond {

/// The particles by which a finite body is strained or loaded, and the part of its surface that belongs to
/// each: sum A = 0 and sum A (x) x = V 1, as of a closed surface.
struct BodySurface {
  std::vector<ParticleId> particles;  ///< in increasing order
  std::vector<Vec3d> areas;           ///< out of the body, one for each  [length^2]
  double volume = 0;                  ///< [length^3]
};

/// The surface of a body that fills a box along the axes: the box around the particles of its largest part.
/// A particle belongs to each face that its centre is no farther from than its diameter, or the mean distance
/// of particles (the cube root of the box over their number) where that is more; a face is shared by its
/// particles alike; faces of one axis are scaled, and the least change (of the sum of squares) makes
/// areas those of a closed surface. volume: absent: that of the box. Throws std::invalid_argument if a corner
/// of the box is far from all particles, as that of a ball is, if a face has less than a third of the
/// particles that would fill it, or if all particles lie in one plane.
BodySurface surface_of_box(const Model& model, const State& state, std::optional<double> volume = {});
/// The same by these particles, those of them that belong to the largest part: the smallest areas (in the sum
/// of squares) that are those of a closed surface. They are normal to ellipsoids. particles: in increasing
/// order.
BodySurface surface_of(const Model& model, const State& state, const std::vector<ParticleId>& particles,
                       double volume);
/// The volume of the box around the particles of the largest part.  [length^3]
double volume_of_box(const Model& model, const State& state);

/// Elastic constants of a finite body, in Voigt's order xx yy zz yz xz xy with engineering shear.
struct HomogenisedBody {
  /// Particles of the surface move with the strain and do not turn: 2 U/V of the others in balance.
  /// [force/length^2]
  Constants by_displacement{};
  /// They bear the forces that a uniform stress exerts on their areas, and turn freely. The inverse of the
  /// compliance S; mean strain is the sum of (u (x) A + A (x) u)/2V. Never stiffer than by_displacement.
  /// [force/length^2]
  Constants by_traction{};
  double volume = 0;   ///< [length^3]
  double density = 0;  ///< of the largest part  [mass/length^3]
  std::size_t particles = 0, bonds = 0;
  std::size_t surface = 0;   ///< particles
  std::size_t floating = 0;  ///< particles of other parts than the largest: they count nowhere
  bool moved = false;        ///< the body was not in balance as it was given
  std::string solver;        ///< "direct" or "multigrid"
};

/// Elastic constants of a body without a cell, about the balance that it comes to when it is left alone: two
/// factors of the tangent, and six solutions by each. by_displacement - by_traction has no negative
/// eigenvalue: a surface that moves by e x has the mean strain e, and the loaded one has the least energy of
/// all with it. Throws std::invalid_argument if model or state have a mistake, there is a cell, there are
/// walls, particles are absent, areas are not those of a closed surface, or bonds or contacts have a kink
/// there. Throws NoEquilibrium if there is no balance, or particles can move at no cost.
HomogenisedBody homogenise_body(const Model& model, const State& state, const BodySurface& surface,
                                const NewtonSettings& newton = {});

}  // namespace vbond
