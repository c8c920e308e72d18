// What a run tells of sources as a stage ends.
#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/passage.hpp"
#include "vbond/run/run.hpp"

namespace vbond {

/// As a stage ends: how many of those that were due are not in, and why. Never fewer without a word.
void Run::end_sources() {
  const auto& stage = std::get<Stage>(*stage_);
  const std::int64_t end = state_.clock.stage_step;
  const auto due_now = [this, &stage] {
    std::vector<std::size_t> due;
    for (const Inflow& inflow : stage.inflows) due.push_back(bodies_due(model_, inflow.source, state_));
    return due;
  };
  const std::vector<std::size_t> tried = due_now();
  count_due_at_end(model_, stage, state_);
  const std::vector<std::size_t> due = due_now();
  if (!hooks_.tell) return;
  for (std::size_t k = 0; k < due.size(); ++k) {
    const Inflow& inflow = stage.inflows[k];
    const Source& source = model_.sources[inflow.source];
    const bool visited = next_visit(inflow, stage.dt, 1) < end;
    const std::size_t in = bodies_in(source, state_), found_no_room = visited ? tried[k] : 0,
                      too_late = due[k] - found_no_room;
    std::string text = fmt::format("stage \"{}\": source \"{}\": {} of {} bodies have come in", stage.name,
                                   source.name, in, source.bodies);
    if (found_no_room > 0)
      text += fmt::format(
          "; {} more found no room: at a visit {} places are tried for the next one, and something was in "
          "the "
          "way at all of them",
          found_no_room, source.tries);
    if (too_late > 0 && visited)
      text += fmt::format("; {} became due after its last visit, and {} not tried", too_late,
                          too_late == 1 ? "was" : "were");
    if (!visited && in < source.bodies)
      text += fmt::format("; it was not visited: its visits are {} steps apart",
                          steps_between(inflow.visits, stage.dt));
    else if (due[k] == 0 && in < source.bodies)
      text += "; the others are not due yet";
    hooks_.tell(text);
  }
}

}  // namespace vbond
