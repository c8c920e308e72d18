#pragma once

namespace vbond::app {

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag; a second one of the same kind ends the program at
/// once. A SIGHUP that is ignored already, as under nohup, stays so.
void catch_signals();

/// The signal received, or 0.
int caught_signal();

}  // namespace vbond::app
