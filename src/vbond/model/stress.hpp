#pragma once
#include <cstddef>
#include <vector>

#include "vbond/core/tensor.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"

/// Stress and strain of bodies of particles, from the forces between them and their displacements.
namespace vbond {

/// V times the stress of each particle: the sum of x f over bonds and contacts, where f is the force on the
/// particle and x the way from its centre to where it acts, which for a bond is the middle between its bonded
/// points, for a contact the middle of the overlap and for a wall the point of it that is touched (Love 1927,
/// Weber 1966; Bagi 1996). Tension is positive. Elastic forces and friction, no damping. Moments make it
/// unsymmetric, by no more than the moment on the particle that its neighbours leave. Of a part of a body,
/// which knows what is near within two radii, what its own bonds and touches make of it.  [energy]
PerParticle<Tensor> stress_times_volume(const Model& model, const BodyPart& body);
/// The part of it that particles make with each other: what walls do is left out.  [energy]
PerParticle<Tensor> stress_between_particles(const Model& model, const BodyPart& body);

/// Volume of a particle as a sphere, for the stress in the particle itself.  [volume]
double sphere_volume(const Model& model, ParticleId p);

/// Mean stress of a group that takes up this volume: the sum over its particles over the volume.
Tensor mean_stress(const BodyPart& body, const PerParticle<Tensor>& stress_times_volume,
                   const IdList<ParticleId>& group, double volume);

/// Green's strain (F^T F - 1)/2 of a group since the start, with the F that fits the displacements of its
/// particles best (least squares, Falk & Langer 1998 without masses): zero for any rigid motion. Not a number
/// for particles of one plane, line or point.
Tensor mean_strain(const Model& model, const BodyPart& body, const std::vector<ParticleId>& group);

}  // namespace vbond
