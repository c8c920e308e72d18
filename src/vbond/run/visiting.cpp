// A run in which bodies come in and particles are taken out.
#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/passage.hpp"
#include "vbond/run/run.hpp"

namespace vbond {

/// Goes on as from a checkpoint of the same moment in which this had happened already. All that is due comes
/// in at once, so that the loop is set up anew once for all of them. Processes that step parts of the body
/// all do the same with the whole of it.
void Run::visit() {
  const auto& stage = std::get<Stage>(*stage_);
  const double energy = simulation_->energies().total();
  State state = simulation_->state();
  const Passage passed = vbond::visit(model_, stage, state);
  if (!passed.changed) return simulation_->note_visit(std::move(state.sources));
  const std::unique_ptr<Simulation> before = std::exchange(simulation_, {});
  go_on_in(std::move(state));
  simulation_->take_over_observers(*before);
  simulation_->take_over(passed, energy);
}

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
