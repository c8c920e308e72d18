#pragma once
#include "vbond/case/case.hpp"

namespace vbond::app {

/// Throws CaseError with all that this case has and runs on many ranks cannot do yet.
void refuse_beyond_ranks(const Case& c);

}  // namespace vbond::app
