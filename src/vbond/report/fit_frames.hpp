#pragma once
#include <string>
#include <vector>

#include "vbond/report/page.hpp"
#include "vbond/report/sequence.hpp"
#include "vbond/report/warnings.hpp"

/// Which of the frames in a folder are read for its page.
namespace vbond::page {

/// Takes away the frames at the end of the run that cannot be opened, as a killed run or a half-copied folder
/// leaves them, and modes that end so. What cannot be read before them is left to read_sequence to refuse.
std::vector<Warning> drop_unreadable_ends(std::vector<SequenceFiles>& all);

/// Takes away frames of the run evenly until limits.frames and limits.packed_bytes are kept, but never the
/// first and the last. Modes count and stay whole; only if they alone are too many the last ones go. Says so
/// in left_out. The run stands before the modes. Throws IoError.
void fit_frames(std::vector<SequenceFiles>& all, const PageLimits& limits,
                std::vector<std::string>& left_out);

}  // namespace vbond::page
