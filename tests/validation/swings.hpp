#pragma once
#include <cmath>

#include "vbond/dynamics/simulation.hpp"

namespace vbond::testing {

/// Angular frequency of a mode that was let go at rest: `amplitude`, 1 at the start, then follows
/// cos(W t), which is the exact solution of leap-frog too. Right after the crossing of zero number
/// 2 periods + 1 the phase is (2 periods + 1/2) pi plus asin of what is past zero: no fit is needed.
template <class Amplitude>
double frequency_of_mode(Simulation& run, Amplitude amplitude, int periods) {
  int crossings = 0;
  double y = amplitude(run.state());
  while (crossings < 2 * periods + 1) {
    const double before = y;
    run.step();
    y = amplitude(run.state());
    if ((before > 0.0) != (y > 0.0)) ++crossings;
  }
  return ((crossings - 0.5) * M_PI + std::asin(std::abs(y))) / run.state().clock.time();
}

/// The frequency at which leap-frog swings a mode of frequency omega (validation case D4).
inline double leap_frog_frequency(double omega, double dt) {
  return 2.0 / dt * std::asin(0.5 * omega * dt);
}

}  // namespace vbond::testing
