// Steps until a stage ends, those who look on, and what several processes tell each other meanwhile.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "vbond/dynamics/simulation.hpp"

namespace vbond {
namespace {

/// The fewest steps that any process would wait.
std::int64_t next_look_of_all(std::int64_t steps, const Exchange& exchange) {
  double sooner = -static_cast<double>(steps);
  exchange.max({&sooner, 1});
  return -sooner < static_cast<double>(steps) ? static_cast<std::int64_t>(-sooner) : steps;
}

}  // namespace

StopReason Simulation::run(const std::function<bool()>& interrupted, std::int64_t most) {
  if (state_.clock.stage_step == 0 || steps_to_look_ == 0) notify_observers();
  StopReason why = stop_reason();
  // never interrupted before the first step
  while (why == StopReason::running && most > 0 && !visit() && !has_outgrown_) {
    step(), --most, why = stop_reason();
    if (why == StopReason::running && is_time_to_meet() && meet(interrupted && interrupted()))
      why = StopReason::interrupted;
  }
  agree_on_failure();
  if (why != StopReason::running) finish(observers_, *this, why);
  return why;
}

void finish(const Observers& observers, const Simulation& run, StopReason why) {
  for (const auto& o : observers) run.processes().together([&] { o->finish(run, why); });
}

void Simulation::notify_observers() {
  steps_to_look_ = std::numeric_limits<std::int64_t>::max();
  if (observers_.empty()) return;  // events are then kept
  for (const auto& o : observers_) {
    exchange_.together([&] { o->observe(*this); });
    steps_to_look_ = std::min(steps_to_look_, std::max<std::int64_t>(1, o->steps_to_next_look(state_.clock)));
  }
  if (is_part_) steps_to_look_ = next_look_of_all(steps_to_look_, exchange_);
  events_.clear();
}

/// One process alone meets nobody, and may be interrupted after each step.
bool Simulation::is_time_to_meet() const {
  return !is_part_ || unmet_ >= exchange_.steps_between_meetings() || !(room_ > 0.0);
}

/// Between steps, now and then: whether one is interrupted, has failed, or has a particle that has gone too
/// far.
bool Simulation::meet(bool interrupted) {
  unmet_ = 0;
  if (!is_part_) {
    if (room_ > 0.0) return interrupted;
    room_ = ways_since_begin().room_left;
    has_outgrown_ = room_ < 0.0;
    return interrupted;
  }
  agree_on_failure();
  fold_brought_in();
  const Ways ways = ways_since_begin();
  room_ = ways.room_left;
  const bool is_far = ways.farthest > 0.5 * lost_beyond_;  // all may have gone there together
  has_outgrown_ = (room_ < 0.0 || is_far) && ways.farthest < lost_beyond_;
  return exchange_.leader_says(interrupted);
}

/// The largest energy that has been brought in after any step is that of the whole body.
void Simulation::fold_brought_in() const {
  exchange_.sum(brought_in_);
  double& largest = booked_.largest;
  for (const double energy : brought_in_) largest = std::max(largest, std::abs(energy));
  brought_in_.clear();
  exchange_.max({&largest, 1});
}

/// Lets bodies in and takes particles out, if that is due before the next step. Whether that has changed the
/// body: the state in which it has is for another simulation.
bool Simulation::visit() {
  if (state_.clock.stage_step != next_visit_) return false;
  agree_on_failure();
  survey();  // take_over() asks for the energy before the visit
  Handover next{state(), {}};
  next.passed = vbond::visit(model_, stage_, next.state);
  next_visit_ = next_visit(stage_, state_.clock.stage_step + 1);
  if (next.passed.changed)
    visited_ = std::move(next);
  else
    state_.sources = std::move(next.state.sources);  // more bodies may be due
  return visited_.has_value();
}

Handover Simulation::handover() && {
  if (visited_) return *std::exchange(visited_, {});
  return {give_state(), {}};
}

Handover Simulation::handover_of_part() && {
  if (visited_ || !part_bonds_.own_alone) return std::move(*this).handover();
  show_own();
  show_loads();
  books();
  std::vector<ParticleId> own = own_particles();
  make_room();
  return {std::move(state_),
          {},
          PartHandedOver{std::move(part_bonds_), std::move(shared_), std::move(own), mass_of_all_}};
}

void Simulation::take_over(Simulation& before, const Passage& passed, double seconds) {
  observers_ = std::move(before.observers_);
  steps_to_look_ = before.steps_to_look_;
  const int threads = std::exchange(times_, before.times_).threads;
  times_.threads = threads;
  times_.anew += seconds;
  next_visit_ = before.next_visit_;  // of the same step, which may have been visited already
  events_ = std::move(before.events_);
  events_.insert(events_.end(), passed.events.begin(), passed.events.end());
  if (!passed.events.empty()) steps_to_look_ = 1;
  if (passed.lost) {
    encounters_.take(before.encounters_, state_.dropped);
    has_changed();  // the state has no loads yet
    steps_to_look_ = 0;
  }
  if (passed.changed) book(passed, energies().total() - before.energies().total());
}

/// The energy of what came in is worked out; what went is the rest of the change, so that the balance closes
/// as it did before. Where nothing went, what came in is the change itself.
void Simulation::book(const Passage& passed, double change) {
  books_ahead_ = true;
  if (!leads()) return;
  if (passed.lost) {
    booked_.released -= change;
    return;
  }
  booked_.dissipated += passed.flowed;
  const double inserted = passed.any_gone ? passed.brought : change;
  booked_.inserted += inserted + passed.flowed;
  booked_.removed += inserted - change;
}

}  // namespace vbond
