#pragma once

namespace vbond::app {

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag; a second one of the same kind ends the program at
/// once. A SIGHUP that is ignored already, as under nohup, stays so.
void catch_signals();

/// The same for SIGPIPE, before a run prints its first line: nobody reads its output any more. A second one
/// is ignored, since the run still has more to say when it stops.
void catch_broken_pipe();

/// The signal received, or 0.
int caught_signal();

}  // namespace vbond::app
