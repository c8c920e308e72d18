#pragma once
#include <string>

#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// The farthest that anything whose orientation is felt may turn in a step.  [rad]
///
/// Leap-frog takes forces and moments at the ends of a step only. Those that turn with a body, by theta in
/// the step, then come out (theta/2)/tan(theta/2) = 1 - theta^2/12 - ... of what they are (the trapezoidal
/// rule on a circle), and the way along a chord is 1 - theta^2/24 of that along the arc: half a radian is an
/// error of 2 per cent.
inline constexpr double longest_turn = 0.5;

/// What turns fastest as a stage begins, or by its supports and walls at any time of it: particles with bonds
/// or with bonds to come, particles whose moments of inertia differ, supports, walls. Particles that only
/// touch others feel no orientation.
struct FastestTurn {
  double rate = 0;     ///< [rad/time]; 0: nothing turns
  std::string source;  ///< e.g. "the turning of particle 3"
};
/// Whether the spins that particles have in a state count, besides what the stage turns. They do not against
/// a step that was given where the run has come to a state by itself: the watch tells of them.
enum class Spins : bool { left_out, counted };
inline Spins spins_against_given_step(const State& state) {
  return state.clock.step == 0 ? Spins::counted : Spins::left_out;
}
/// Whether the particles of a support are a rigid group with free turns.
inline bool turns_freely(const Support& s) {
  return is_free_grip(s) && !(s.held[3] && s.held[4] && s.held[5]);
}

FastestTurn fastest_turn(const Model& model, const BodyPart& body, const Stage& stage,
                         Spins spins = Spins::counted);

}  // namespace vbond
