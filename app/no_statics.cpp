#include <fmt/core.h>

#include "statics.hpp"
#include "vbond/core/error.hpp"

namespace vbond::app {
namespace {

[[noreturn]] void refuse(const SourcePlace& place, const std::string& what) {
  throw CaseError(
      {place, what, "this vbond was built without statics",
       "build it with -DVBOND_STATICS=ON, which needs libsuitesparse-dev, libopenblas-pthread-dev, "
       "libeigen3-dev and libspectra-dev"});
}

}  // namespace

void require_statics(const Case& c) {
  for (const StageSpec& s : c.stages)
    if (is_static(s.kind)) refuse(s.place, fmt::format("stage \"{}\" is static", s.name));
  if (c.time.step && !c.time.given()) refuse(c.time.step->place, "time.step = \"exact\"");
}

ExactCriticalStep exact_step() {
  return {};
}

std::optional<NoEquilibrium> refusal_of(const Model&, const StaticStage&, const State&) {
  return {};  // not reached: require_statics has refused the case
}

SolverChoice solver_of(const Model&, const StaticStage&, const State&) {
  return {};  // not reached
}

bool run_static_leg(Campaign& campaign, const StaticStage& stage, const State&, State& state) {
  refuse(campaign.c.stages[static_cast<std::size_t>(state.clock.stage)].place,
         fmt::format("stage \"{}\" is static", stage.name));
}

}  // namespace vbond::app
