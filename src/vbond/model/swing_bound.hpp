#pragma once
#include <limits>
#include <string>

#include "vbond/model/stage.hpp"

namespace vbond {

/// What a stage moves to and fro, seen in steps: the path between two steps is taken as straight, at the mean
/// velocity of the step, so that the end of a swing is cut off, by 1 - cos(pi/n) at most with n steps a
/// period. The work of a shaken floor with friction (docs/walls.md, measured) comes out 2.4 % too small with
/// 20 steps a period, 22 % with 10, and with one step a period the floor stands still.
inline constexpr double steps_of_a_period = 20.0;   ///< an automatic step makes at least so many
inline constexpr double fewest_of_a_period = 10.0;  ///< a given step with fewer is refused

/// The fastest of the swings that a stage prescribes: oscillations of walls, and factors over time that rise
/// and fall again and again.
struct FastestSwing {
  double period = std::numeric_limits<double>::infinity();  ///< [time]
  std::string source;                                       ///< e.g. "the oscillation of wall \"floor\""
  double longest_step() const { return period / fewest_of_a_period; }
  double wanted_step() const { return period / steps_of_a_period; }
};

FastestSwing fastest_swing(const Stage& stage);

/// The shortest time from one peak of a factor to the next, or from one trough to the next; infinite if it
/// has less than two of both within `duration`. Rises and falls by less than 5 % of its range are left out.
double shortest_period(const TimeFunction& factor, double duration);

}  // namespace vbond
