#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/bond.hpp"

// Bodies that come in during a run, and particles that are taken out of it: model/passage.hpp does both.
namespace vbond {

/// A part of space.
struct Space {
  BoundingBox box;  ///< around it, or with infinite sides  [length]
  /// Whether it holds a sphere of this radius as a whole; of radius 0: the point.
  std::function<bool(const Vec3d& centre, double radius)> holds;
};

/// A bond that a body brings along, between its particles number i and j.
struct SourceBond {
  std::uint32_t i = 0, j = 0;
  std::uint32_t recipe = 0;  ///< in Source::recipes
  Vec3d offset_i, offset_j;  ///< from the centres to what is bonded, as the first body stands  [length]
  double R_i = 0, R_j = 0;   ///< radii there  [length]
};

/// Bodies that are all alike and come in one after another, in the order of their numbers. They are among the
/// particles of the model from the start, and wait (State::waiting), without bonds, as the first of them
/// stands there: what one brings along is worked out from that pose.
struct Source {
  std::string name;
  std::vector<ParticleId> body;  ///< the particles of the first one, in increasing order
  ParticleId copies;             ///< the first particle of the second one; those of the others follow
  std::size_t bodies = 1;        ///< with the first
  std::vector<SourceBond> bonds;
  std::vector<BondRecipe> recipes;

  std::shared_ptr<const Space> region;  ///< where they come in; its box is finite
  bool whole = true;                    ///< the region holds all of a body; else its centre of mass
  bool turned = true;                   ///< at random, uniformly over all rotations; else as the first stands
  Vec3d velocity;                       ///< of the centre of mass  [length/time]
  Vec3d angular_velocity;               ///< of the body about it  [rad/time]
  double velocity_spread = 0;           ///< standard deviation of each component  [length/time]
  double angular_velocity_spread = 0;   ///< the same  [rad/time]
  std::uint64_t seed = 1;
  std::int64_t tries = 100;  ///< places that are tried for a body at each visit, >= 1

  ParticleId particle(std::size_t body_number, std::size_t k) const {
    return body_number == 0 ? body[k] : ParticleId{copies.value + (body_number - 1) * body.size() + k};
  }
  std::size_t particles() const { return bodies * body.size(); }
  /// The number of the body that a particle belongs to; nothing: it is of none.
  std::optional<std::size_t> body_of(ParticleId p) const {
    if (std::binary_search(body.begin(), body.end(), p)) return 0;
    if (bodies < 2 || p < copies || p.value >= copies.value + (bodies - 1) * body.size()) return std::nullopt;
    return 1 + (p.value - copies.value) / body.size();
  }
};

/// When something is visited in a stage: at steps that are multiples of so many, but not as it begins.
struct Visits {
  double from = 0, until = std::numeric_limits<double>::infinity();  ///< time of the stage
  double every = 0;                                                  ///< [time]; 0: default_steps
  static constexpr std::int64_t default_steps = 500;
};

/// A source that lets bodies in during a stage.
struct Inflow {
  std::size_t source = 0;  ///< in Model::sources
  double rate = 0;         ///< bodies per time, from `from` on; 0: all of them are due at once
  Visits visits;
};

/// Takes out particles whose centres are in a region at a visit, or outside of it. Those that a support of
/// the stage holds, and those whose distance ends it, stay.
struct Sink {
  std::string name;
  std::shared_ptr<const Space> region;
  bool outside = false;
  std::vector<char> particles;  ///< for each whether it may go; empty: all
  Visits visits;
};

}  // namespace vbond
