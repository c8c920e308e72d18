// How a run hands its state on: to the simulation of a stage, to the next one, and to who asks for it; of
// several processes, each of which steps a part of the body, what they do for it together.
#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "vbond/dynamics/between_stages.hpp"
#include "vbond/model/holds.hpp"
#include "vbond/run/run.hpp"

namespace vbond {
namespace {

void require_of_parts(bool holds, const char* rule) {
  if (!holds) throw std::invalid_argument(std::string("Run: several processes step the body: ") + rule);
}

}  // namespace

/// Of this process; where it cannot be made, the run has its state back.
std::unique_ptr<Simulation> Run::part_of(State state, Share share) {
  share.model = &model_;
  try {
    return std::make_unique<Simulation>(model_, std::get<Stage>(*stage_), &state, std::move(share),
                                        *partition_);
  } catch (...) {
    state_ = std::move(state);
    throw;
  }
}

/// Each process begins the stage with its part of the body.
void Run::take_part() {
  const auto& stage = std::get<Stage>(*stage_);
  require_of_parts(stage.on_unphysical == OnUnphysical::stop, "none may drop particles");
  require_of_parts(stage.pressures.empty(), "no pressure may act; take one process, with threads");
  require_of_parts(std::none_of(stage.supports.begin(), stage.supports.end(), is_free_grip),
                   "no rigid group may be free in part");
  require_able_to_begin(model_, stage, state_);
  const Acquaintance before = std::exchange(known_, acquaintance(model_, stage, state_));
  if (part_ && known_ != before) current();  // spread as if for the first time
  Share share;
  if (part_) {
    PartHandedOver part = closed_part(*std::exchange(part_, {}), std::exchange(*own_, {}));
    share = partition_->migrate(model_, state_, std::move(part));
  } else {
    share = partition_->spread(model_, state_, known_.reach, known_.knows_all);
    if (own_ != nullptr && own_->all != nullptr) share.bonds = std::exchange(*own_, {});
  }
  share.begins = true;
  simulation_ = part_of(std::move(state_), std::move(share));
}

/// With another simulation of the stage under way, as from a checkpoint of the same moment. All bodies that
/// are due have come in at once, so that the loop is set up anew once for all of them.
void Run::set_up_anew() {
  const auto begun = std::chrono::steady_clock::now();
  Handover next = std::move(*simulation_).handover_of_part();
  const std::unique_ptr<Simulation> before = std::exchange(simulation_, {});
  if (partition_ == nullptr) {
    state_ = std::move(next.state);
    simulation_ = std::make_unique<Simulation>(model_, std::get<Stage>(*stage_), &state_, threads_);
  } else {
    Share share = next.part ? partition_->migrate(model_, next.state, *std::move(next.part))
                            : partition_->spread_anew(model_, next.state);
    simulation_ = part_of(std::move(next.state), std::move(share));
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
  simulation_->take_over(*before, next.passed, taken.count());
}

/// Each process keeps its part alone, if it has begun so.
void Run::hand_over() {
  Handover end = own_ != nullptr && partition_ != nullptr ? std::move(*simulation_).handover_of_part()
                                                          : std::move(*simulation_).handover();
  simulation_.reset();
  state_ = std::move(end.state);
  part_ = std::move(end.part);
  if (part_) *own_ = open_part(*part_, keep_, model_, state_, *partition_);
}

/// No stage asks for the whole body: the state is what there is to say of the end of this one, until somebody
/// does.
void Run::end_in_parts() {
  const State& known = simulation_->part(Show::bonds).state;
  State end;
  end.clock = known.clock;
  end.cell = known.cell;
  end.dropped = known.dropped, end.taken = known.taken, end.waiting = known.waiting;
  end.sources = known.sources;
  state_ = std::move(end);
  ended_ = std::move(simulation_);
}

const State& Run::current() const {
  if (simulation_) return simulation_->state();
  if (const std::unique_ptr<Simulation> last = std::move(ended_)) {
    State whole = std::move(*last).handover().state;
    whole.clock = state_.clock;
    whole.sources = std::move(state_.sources);
    state_ = std::move(whole);
  }
  if (own_ != nullptr && own_->all != nullptr)
    state_ = whole_of(std::move(state_), std::exchange(*own_, {}), part_ ? &*part_ : nullptr, model_);
  part_.reset();
  return state_;
}

}  // namespace vbond
