#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Particles that unbroken bonds hold together; contacts do not count, and a particle without bonds is one.
struct Fragment {
  ParticleId lowest;           ///< the smallest number of its particles
  std::int64_t particles = 0;  ///< how many
  double mass = 0;             ///< [mass]
};

struct Fragments {
  std::vector<Fragment> all;         ///< the heaviest first, of equal ones that with the lowest particle
  PerParticle<std::int64_t> number;  ///< of each particle's fragment, among all; -1: it is left out
};
/// without: particles that are of none, in increasing order. Of a body in parts all of its fragments, and the
/// numbers of the particles of this part, -1 for others. All parts call it; it takes messages of the size of
/// borders, and of the number of fragments.
Fragments find_fragments(const Model& model, const BodyPart& body,
                         const std::vector<ParticleId>& without = {});

/// What the history tells of them.
struct FragmentCount {
  std::int64_t number = 0;
  double largest_share = 0;  ///< of the mass
  friend bool operator==(const FragmentCount&, const FragmentCount&) = default;
};
/// The same, but that parts tell each other only of fragments that several have particles of.
FragmentCount count_fragments(const Model& model, const BodyPart& body,
                              const std::vector<ParticleId>& without = {});

/// Centres of mass and their velocities, one of each for each fragment, each as a whole: with the images that
/// bonds join, from where its lowest particle stands. No centre: it goes all through a periodic cell, and its
/// velocity is that of its particles. Of a body in parts, which is not periodic, all parts call it and get
/// those of all fragments.  [length], [length/time]
struct FragmentMotion {
  std::vector<std::optional<Vec3d>> centre;
  std::vector<Vec3d> velocity;
};
FragmentMotion motion_of(const Fragments& fragments, const Model& model, const BodyPart& body);

}  // namespace vbond
