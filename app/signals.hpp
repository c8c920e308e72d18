#pragma once

namespace vbond::app {

/// From now on SIGINT and SIGTERM only set a flag; a second one of the same kind ends the program at once.
void catch_signals();

/// The signal received, or 0.
int caught_signal();

}  // namespace vbond::app
