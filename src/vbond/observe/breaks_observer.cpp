#include "vbond/observe/breaks_observer.hpp"

#include "vbond/dynamics/simulation.hpp"

namespace vbond {

BreaksObserver::BreaksObserver(const OutputPlan& plan, const std::optional<Clock>& resumed, bool at_rest) {
  if (!plan.reactions.empty()) loaded_ = plan.reactions.front();
  if (!plan.writes_all()) return;
  std::optional<std::int64_t> last;  // a bond that breaks at rest breaks after its point: not yet at this one
  if (resumed) last = resumed->step - (at_rest ? 1 : 0);
  breaks_.emplace(plan, last);
  fragments_.emplace(plan, resumed ? std::optional<std::int64_t>(resumed->stage) : std::nullopt);
}

void BreaksObserver::observe(const Simulation& run) {
  std::optional<double> load;  // the same for all that broke in a step
  for (const BondEvent& event : run.events()) {
    if (event.kind != BondEvent::Kind::broken) continue;
    const Timing timing(*this);
    if (loaded_ && !load) load = norm(run.reaction(loaded_->particles, LastBreaks::counted).force);
    if (!breaks_) continue;
    Clock then = run.clock();
    then.stage_step += event.step - then.step;
    then.step = event.step;
    breaks_->write(then, event, load);
  }
}

std::int64_t BreaksObserver::steps_to_next_look(const Clock& /*now*/) const {
  return no_next_look;  // it is shown every step in which bonds break
}

void BreaksObserver::finish(const Simulation& run, StopReason why) {
  if (!stage_done(why)) return;
  const bool periodic = run.model().cell.any();  // bonds join its fragments around the cell
  end_stage(run.model(), periodic ? BodyPart(run.state()) : run.part(), run.clock().stage);
}

void BreaksObserver::observe_balance(const BodyView& body, const BalancePoint& /*balance*/) {
  const Timing timing(*this);
  if (loaded_) load_at_rest_[body.clock().step] = norm(body.reaction(loaded_->particles).force);
}

void BreaksObserver::end_stage(const Model& model, const BodyPart& body, std::int64_t stage) {
  const Timing timing(*this);
  load_at_rest_.clear();
  added_at_rest_ = 0;
  if (!fragments_ && body.is_whole()) return;
  const Fragments fragments = find_fragments(model, body, left_out(body.state));
  const FragmentMotion motion = motion_of(fragments, model, body);
  if (fragments_) fragments_->write(body.state.clock, stage, fragments, motion);
}

void BreaksObserver::add_breaks_at_rest(const Clock& start, const State& state,
                                        const std::vector<BrokenBond>& breaks) {
  if (!breaks_) return;
  const Timing timing(*this);
  for (; added_at_rest_ < breaks.size(); ++added_at_rest_) {
    const BrokenBond& b = breaks[added_at_rest_];
    const Bond& bond = state.bonds[b.use.bond];
    Clock then = start;
    then.step += b.point;
    BondEvent e = event_of(BondEvent::Kind::broken, bond, b.use.bond, then.step);
    e.energy = b.held;
    const StrengthShares& s = b.shares;
    e.failure = {s.tension, s.shear, s.bending, s.torsion, s.compression, b.use.utilisation};
    e.loads = {b.section.N, b.section.V, b.section.M_b, b.section.M_t};
    e.middle = b.middle, e.direction = b.direction;
    e.cause = break_cause_of(bond, e.failure, e.loads.N);
    const auto load = load_at_rest_.find(then.step);
    breaks_->write(then, e, load != load_at_rest_.end() ? std::optional(load->second) : std::nullopt);
  }
}

}  // namespace vbond
