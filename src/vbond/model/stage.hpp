#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/cell_drive.hpp"
#include "vbond/model/held_axes.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/source.hpp"
#include "vbond/model/time_function.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {

// What acts on a body in a stage goes with the progress of the stage: with time in motion, with the load
// factor at rest. A velocity is a rate per progress: at rest it is the way from where the stage found the
// body to where it stands at load factor 1. Factors are functions of time: stages at rest take none.

/// Degrees of freedom that are held, at rest or at a prescribed velocity. A rigid one is a grip: its
/// particles move as one rigid body, positions and orientations, on circles about a pivot that itself moves
/// at `velocity`. Degrees of freedom of that body which it does not hold are free: loads on its particles
/// move it along and about them. At rest a turn about some of the axes is that of the held components alone;
/// if all three are held it is the rotation by the vector, exactly.
struct Support {
  std::string group;  ///< name, for reports
  std::vector<ParticleId> particles;
  HeldDofs held{};
  Vec3d velocity;            ///< of held translations, or of the pivot  [length/time]; at rest [length]
  Vec3d angular_velocity;    ///< of held rotations, or of the grip  [rad/time]; at rest [rad]
  TimeFunction factor = {};  ///< of both
  bool rigid = false;
  /// Rigid: at the start of the stage; absent: the mean of its particles' positions then, or in motion, where
  /// it is free in some degree of freedom, their centre of mass  [length].
  std::optional<Vec3d> pivot = {};
  /// Of `held`, of what is not rigid; absent: the world's.
  std::optional<HeldAxes> axes = {};
};

/// Force and moment on each particle of a group: the same on each, and a part in proportion to mass, as
/// totals of a group are shared. Fixed in direction, or followers, which are given along the axes of the
/// particle and turn with it; at rest in equilibria and paths.
struct PointLoad {
  std::string group = {};
  std::vector<ParticleId> particles = {};
  Vec3d force = {};   ///< [force]
  Vec3d moment = {};  ///< [force*length]
  TimeFunction factor = {};
  Vec3d force_by_mass = {};   ///< [force/mass]
  Vec3d moment_by_mass = {};  ///< [force*length/mass]
  bool follower = false;
  bool constant = false;  ///< at rest: at full size from the start, not in proportion to the load factor

  Vec3d force_on(double mass) const { return force + mass * force_by_mass; }
  Vec3d moment_on(double mass) const { return moment + mass * moment_by_mass; }
};

/// How near two particles must be to be bonded: centres no farther apart than distance + factor (R_i + R_j).
/// By centres: factor 0; by the gap of surfaces: factor 1; by a factor of the radii: distance 0.
struct BondReach {
  double distance = 0;  ///< [length]
  double factor = 0;
  /// Spheres that touch but for rounding do touch: 1e-9 of the radii is within reach.
  double operator()(double R_i, double R_j) const {
    return factor > 0.0 ? distance + (factor + rounding) * (R_i + R_j) : distance;
  }
  /// What pairs are compared with: centres that are so far apart but for rounding are within a distance, too.
  double limit(double R_i, double R_j) const {
    return factor > 0.0 ? (*this)(R_i, R_j) : (1.0 + rounding) * distance;
  }

 private:
  static constexpr double rounding = 1e-9;
};

/// Which part of all pairs is bonded, by a number of each pair.
struct BondShare {
  double part = 1;  ///< > 0, <= 1
  std::uint64_t seed = 1;
};

/// Bonds made during the run: a pair of the two groups that comes within reach is bonded.
struct BondingRule {
  std::string name;              ///< of the bond set, for reports
  std::vector<char> in_a, in_b;  ///< per particle: belongs to the first / second group
  double distance = 0;           ///< with the factor: how near they must be, see BondReach  [length]
  BondRecipe recipe;
  double factor = 0;  ///< of the sum of the radii
  BondShare share = {};

  double reach(double R_i, double R_j) const { return BondReach{distance, factor}(R_i, R_j); }
  double limit(double R_i, double R_j) const { return BondReach{distance, factor}.limit(R_i, R_j); }
};

/// Stop when the distance between two particles passes a value.
struct DistanceStop {
  ParticleId i, j;
  double value;       ///< [length]
  bool below = true;  ///< stop at distance <= value, else at >= value
};

enum class PeakQuantity : std::uint8_t { compressive_force, reaction, wall_force };

/// Stop when the block average of a quantity has fallen by `drop` below its peak (buckling).
struct PeakStop {
  PeakQuantity quantity = PeakQuantity::compressive_force;
  std::vector<ParticleId> particles;  ///< compressive_force: mean over the bonds inside this group
  Vec3d direction;                    ///< reaction, wall_force: which component, unit vector
  double drop = 0.015;                ///< fraction, 0 < drop < 1
  double average_over = 0;            ///< length of a block  [time]
  std::size_t wall = 0;               ///< wall_force: that of particles on this one of Model::walls
  double above = 0;                   ///< smaller peaks do not count, >= 0  [force]
};

/// Stop when the kinetic energy has stayed below a bound. A swing passes through zero kinetic energy at each
/// turn, so `during` must be longer than the body's slowest half period.
struct RestStop {
  double kinetic_energy_below = 0;  ///< [energy]
  double during = 0;                ///< [time]
};

/// Stop when so many bonds have broken in the stage.
struct BreakStop {
  std::int64_t count = 1;  ///< > 0
};

/// When a stage ends: whichever comes first.
struct Stops {
  double duration = std::numeric_limits<double>::infinity();  ///< [time]
  std::optional<DistanceStop> distance;
  std::optional<PeakStop> peak;
  std::optional<RestStop> rest;
  std::optional<BreakStop> breaks;
};

/// What becomes of a run in which single particles have passed through others or through walls, or turn too
/// fast to be followed: it stops, or goes on without them.
enum class OnUnphysical : std::uint8_t { stop, drop };

/// One leg of the run, resolved: no names to look up, all in the units of the model.
struct Stage : StageTerms {
  std::string name;
  double dt = 0;        ///< [time]
  double critical = 0;  ///< the critical step that dt was chosen by; 0: not looked for  [time]
  /// dt may be above the critical step, or too long for what the stage moves to and fro (swing_bound.hpp).
  bool insist = false;
  OnUnphysical on_unphysical = OnUnphysical::stop;
  Vec3d gravity;             ///< [length/time^2]
  double b_translation = 0;  ///< viscous force -b v  [force*time/length]
  /// Cundall's local damping, 0 to below 1: this part of each component of the force and moment that is left
  /// on a particle acts against its motion. Not physical: to come to rest with few steps.
  double local_damping = 0;
  double b_rotation = 0;  ///< viscous moment -b omega  [force*length*time]
  std::vector<Support> supports;
  std::vector<PointLoad> loads;
  std::vector<BondingRule> bonding;
  CellDrive cell;  ///< of a periodic body
  std::vector<Inflow> inflows;
  std::vector<Sink> sinks;  ///< before the inflows, where both are due
  Stops stops;
};

/// Whether a support moves its particles as one rigid body that is free in some degrees of freedom; the
/// degrees of freedom that a support takes of each of its particles.
inline bool is_free_grip(const Support& s) {
  return s.rigid && s.held != all_held;
}
inline const HeldDofs& taken_by(const Support& s) {
  return s.rigid ? all_held : s.held;
}

/// A particle that the imposed strain would move and a rigid support carries.
inline std::optional<ParticleId> strained_and_gripped(const Stage& stage) {
  if (!stage.strain) return std::nullopt;
  const std::vector<ParticleId>& strained = stage.strain->particles;
  for (const Support& s : stage.supports)
    for (const ParticleId p : s.particles)
      if (s.rigid && std::find(strained.begin(), strained.end(), p) != strained.end()) return p;
  return std::nullopt;
}

/// How many steps make up a time, at least one; at most 2^62, so that counts of steps can be added.
inline std::int64_t steps_in(double time, double dt) {
  const double steps = time / dt + 0.5;
  if (!(steps < 0x1p62)) return std::int64_t{1} << 62;
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(steps));
}

}  // namespace vbond
