#pragma once
#include "campaign.hpp"

namespace vbond::app {

/// Runs the static stage that was prepared as a whole, with its output. The checkpoint is that of the state
/// before its bonds were made until it has ended. Returns true if it has come to its end, false if it was
/// interrupted. Throws NoEquilibrium or Diverged, with results up to there written.
bool run_static_leg(Campaign& campaign);

}  // namespace vbond::app
