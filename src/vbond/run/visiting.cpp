// A run in which bodies come in and particles are taken out.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

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

/// As a stage ends: how many of those that were due are not in. Never fewer without a word.
void Run::tell_of_sources() const {
  if (!hooks_.tell) return;
  const auto& stage = std::get<Stage>(*stage_);
  for (const Inflow& inflow : stage.inflows) {
    const Source& source = model_.sources[inflow.source];
    const std::size_t in = bodies_in(source, state_), due = bodies_due(model_, inflow.source, state_);
    std::string text = fmt::format("stage \"{}\": source \"{}\": {} of {} bodies have come in", stage.name,
                                   source.name, in, source.bodies);
    if (due > 0)
      text += fmt::format(
          "; {} more {} due: at a visit {} places are tried for the next one, and something was in the way "
          "at all of "
          "them, or no visit has come since",
          due, due == 1 ? "was" : "were", source.tries);
    else if (in < source.bodies)
      text += "; the others are not due yet";
    hooks_.tell(text);
  }
}

}  // namespace vbond
