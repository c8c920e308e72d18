// What a summary says of a run.
#include <algorithm>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/observe/summary.hpp"

namespace vbond {

PassageSummary summarise_passage(const Model& model, const State& state) {
  PassageSummary p{
      static_cast<std::int64_t>(present(state)), state.mass, state.books.inserted, state.books.removed, {}};
  for (std::size_t k = 0; k < model.sources.size(); ++k) {
    const Source& s = model.sources[k];
    p.sources.push_back({s.name, static_cast<std::int64_t>(s.bodies),
                         static_cast<std::int64_t>(bodies_in(s, state)),
                         static_cast<std::int64_t>(bodies_due(model, k, state))});
  }
  return p;
}

CellSummary summarise_cell(const Model& model, const BodyPart& body) {
  const CellEdges& cell = body.state.cell;
  return {{cell[0].along, cell[1].along, cell[2].along}, cell_values(model, body)};
}

std::vector<PhaseTime> split_steps(double seconds, const StepTimes& t) {
  const double sum = t.bonds + t.contacts + t.integrate;
  const double in_steps = std::max(0.0, seconds - t.anew), scale = sum > 0.0 ? in_steps / sum : 0.0;
  std::vector<PhaseTime> phases{{"steps", in_steps}};
  if (sum > 0.0)
    phases = {
        {"bonds", scale * t.bonds}, {"contacts", scale * t.contacts}, {"integrate", scale * t.integrate}};
  if (t.anew > 0.0) phases.push_back({"set_up_anew", seconds - in_steps});
  return phases;
}

StageSummary summarise_stage(const Simulation& run, StopReason stop) {
  const Clock& clock = run.clock();
  StageSummary s{run.stage().name, stop, clock.stage_step, run.stage().dt, clock.time(), {}, {}, {}, {}};
  if (stop == StopReason::peak) {
    s.critical_force = run.peak().peak;
    s.peak_time = run.peak().peak_time;
  }
  return s;
}

const char* to_text(StopReason reason) {
  switch (reason) {
    case StopReason::running: return "running";
    case StopReason::duration: return "duration";
    case StopReason::distance: return "distance";
    case StopReason::peak: return "peak";
    case StopReason::rest: return "rest";
    case StopReason::breaks: return "breaks";
    case StopReason::diverged: return "diverged";
    case StopReason::interrupted: return "interrupted";
  }
  return "running";
}

bool any_dynamics(const RunSummary& summary) {
  return std::any_of(summary.stages.begin(), summary.stages.end(),
                     [](const StageSummary& s) { return !s.statics; });
}

}  // namespace vbond
