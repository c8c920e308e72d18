#include "refusals.hpp"

#include <algorithm>

#include "vbond/core/error.hpp"

namespace vbond::app {

void refuse_beyond_ranks(const Case& c) {
  if (std::any_of(c.stages.begin(), c.stages.end(), [](const StageSpec& s) { return !is_static(s.kind); }))
    return;
  throw CaseError({{c.file, 0, 0},
                   "static stages only",
                   "vbond-lammps spreads motion over the ranks: each of them solves static stages by itself",
                   "run the case with vbond"});
}

}  // namespace vbond::app
