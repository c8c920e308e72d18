#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "vbond/model/stage.hpp"

namespace vbond {

/// Time is counted in whole steps: how the times of a stage and its step are brought together.

/// The longest step of at most `wanted` of which `every` (0: nothing) is a whole number, and the duration
/// too: alone always, beside `every` if their ratio is a fraction of small numbers. `wanted` itself if it
/// is one.  [time]
double fitting_step(double wanted, double duration, double every = 0.0);

/// The factor with all its bends on steps, equal to `f` wherever `f` has none between two steps. Beside a
/// bend between steps, or a jump, a step has the mean of `f` over half a step to either side, so that the
/// sums that leap-frog makes over the steps 0 to `last` are the integral of `f`: impulses and ways come out
/// right.
TimeFunction on_steps(const TimeFunction& f, double dt, std::int64_t last);

/// What the stage's step could not meet, a line each: the key, what was wanted and what it is.
std::vector<std::string> times_not_met(const Stage& stage);

}  // namespace vbond
