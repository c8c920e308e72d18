#pragma once
#include <array>
#include <span>
#include <string_view>

#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Two particles that touch, as a law of touching pairs sees them; vectors in the world frame.
struct TouchingPair {
  Vec3d r_ij;       ///< r_j - r_i  [length]
  double R_i, R_j;  ///< radii  [length]
  double overlap;   ///< R_i + R_j - |r_ij|, > 0  [length]
  double m_i, m_j;  ///< [mass]
  Vec3d v_ij;       ///< v_j - v_i of the centres, half a step ago  [length/time]
  Vec3d w_i, w_j;   ///< angular velocities, half a step ago  [rad/time]
};

/// What a pair does to its particles: force on i (j feels -F) and moments about their own centres.
struct PairLoads {
  Vec3d F;         ///< [force]
  Vec3d M_i, M_j;  ///< [force*length]
};

/// How stiff a pair is and how strongly it damps, for the bound of the time step; turning included.
struct PairSlopes {
  double stiffness;  ///< [force/length]
  double damping;    ///< [force*time/length]
};

/// What a touching pair remembers, as long as it touches.
using PairHistory = std::array<double, 8>;

/// What a step makes of it, and the energy that is lost by that, as by sliding: not what motion stores.
struct PairStep {
  PairHistory history{};
  double dissipated = 0;  ///< [energy], >= 0
};

/// What the pair of two particles, i < j, remembers.
struct PairMemory {
  ParticleId i, j;
  PairHistory history{};
  friend bool operator==(const PairMemory&, const PairMemory&) = default;
};

struct PairSweep;

/// What touching particles do besides repelling each other: damping, friction. One object per law;
/// dynamics/pair_loops.hpp makes it. Not in statics.
struct PairLaw {
  std::string_view name;
  std::span<const std::string_view> history;  ///< names of what a pair remembers, at most 8
  const void* law;                            ///< the law itself, first argument of the functions
  double (*energy)(const void* law, const TouchingPair&, const PairHistory&);
  PairLoads (*loads)(const void* law, const TouchingPair&, const PairHistory&);  ///< those of the energy
  PairSlopes (*slopes)(const void* law, const TouchingPair&);
  /// Adds the loads of all pairs that touch rows of the sweep. Returns what histories have dissipated.
  double (*add_loads)(const void* law, const PairSweep&);
};

}  // namespace vbond
