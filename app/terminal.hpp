#pragma once

namespace vbond::app {

/// Characters in a line of the terminal that stdout is, at least 40; 80 if it is none.
int terminal_width();

}  // namespace vbond::app
