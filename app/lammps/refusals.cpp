#include "refusals.hpp"

#include <algorithm>

#include "vbond/core/error.hpp"

namespace vbond::app {

void refuse_beyond_ranks(const Case& c) {
  for (const StageSpec& stage : c.stages)
    for (const SupportSpec& s : stage.supports)
      if (!is_static(stage.kind) && s.rigid && s.held != all_held)
        throw CaseError({s.place, "the rigid group \"" + s.group.value + "\" is free in part",
                         "its particles would be on several ranks, which do not know what it weighs",
                         "run the case with vbond, or hold all of it"});
  if (c.watch.on_unphysical == OnUnphysical::drop)
    throw CaseError({{c.file, 0, 0},
                     "watch.on_unphysical = \"drop\"",
                     "a particle that one rank drops would still be on others",
                     "run the case with vbond, or use on_unphysical = \"stop\""});
  if (std::any_of(c.stages.begin(), c.stages.end(), [](const StageSpec& s) { return !is_static(s.kind); }))
    return;
  throw CaseError({{c.file, 0, 0},
                   "static stages only",
                   "vbond-lammps spreads motion over the ranks: each of them solves static stages by itself",
                   "run the case with vbond"});
}

}  // namespace vbond::app
