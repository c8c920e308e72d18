#include "vbond/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "vbond/model/bond_sums.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/holds.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/terms/heat/heat.hpp"
#include "vbond/terms/pressure/pressed.hpp"

namespace vbond {
namespace {

void require(bool holds, const std::string& rule) {
  if (!holds) throw std::invalid_argument("Run: " + rule);
}

/// What supports hold keeps its rates; a rigid group that is free in part finds those it has as a whole.
void keep_held(const std::vector<Support>& supports, const State& before, PerParticle<Vec3d>& v,
               PerParticle<Vec3d>& omega) {
  for (const Hold& h : holds_of(supports)) {
    if (is_free_grip(supports[h.support])) continue;
    for (std::size_t dof = 0; dof < h.held.size(); ++dof) {
      if (!h.held[dof]) continue;
      const Vec3d& axis = axis_of(h.axes.get(), dof);
      Vec3d& rate = dof < 3 ? v[h.particle] : omega[h.particle];
      rate += dot((dof < 3 ? before.v : before.omega)[h.particle] - rate, axis) * axis;
    }
  }
}

}  // namespace

Run::Run(Model model, State state, std::vector<AnyStage> stages, int threads)
    : Run(std::move(model), std::move(state), given_stages(std::move(stages)), threads) {}

Run::Run(Model model, State state, std::unique_ptr<const Stages> stages, int threads)
    : model_(std::move(model)), state_(std::move(state)), stages_(std::move(stages)), threads_(threads) {
  require(threads >= 1, fmt::format("threads = {}: it must be >= 1", threads));
  require(stages_ && stages_->size() > 0, "there is no stage to run");
  require(model_.particles() > 0, "the model has no particles");
  refuse("Run", mistakes_in(model_));
  refuse("Run", mistakes_in(model_, state_));
  refuse("Run", mistakes_in_values(model_, state_));
  require(stage_index() <= stages_->size() && !(complete() && state_.clock.stage_step > 0),
          fmt::format("the state is in stage {} (counted from 0), and there are {} stages",
                      state_.clock.stage, stages_->size()));
}

void Run::add_observer(std::shared_ptr<Observer> observer) {
  require(observer != nullptr, "the observer is null");
  if (simulation_) simulation_->add_observer(observer);
  observers_.push_back(std::move(observer));
}

void Run::require_able() const {
  require(failure_.empty(),
          "it has failed and cannot go on; begin a new one from an earlier state: " + failure_);
  require(!complete(), "all its stages are behind it");
}

bool Run::any_dynamics() const {
  for (std::size_t k = 0; k < stages_->size(); ++k)
    if (!is_static(stages_->kind(k))) return true;
  return false;
}

/// Those that prepare() has made.
void Run::take_back_bonds(State& state) const {
  keep_bonds(state, bonds_before_);
  state.bond_history.resize(std::min(state.bond_history.size(), histories_before_));
  state.books = books_before_;
}

const AnyStage& Run::prepare() {
  require_able();
  if (stage_) return *stage_;
  bonds_before_ = state_.bonds.size();
  histories_before_ = state_.bond_history.size();
  books_before_ = state_.books;
  try {
    exchange().together([&] { stage_ = stages_->make(stage_index(), model_, state_); });
  } catch (...) {  // as if nothing had been tried
    take_back_bonds(state_);
    throw;
  }
  return *stage_;
}

std::vector<std::string> Run::notes_on_stage() const {
  if (!stage_ || simulation_ || state_.clock.stage_step > 0) return {};
  std::vector<std::string> lines = stages_->notes(stage_index(), state_, bonds_before_);
  for (const Pressure& p : std::visit(
           [](const auto& s) -> const auto& { return s.pressures; }, *stage_))
    lines.push_back(fmt::format("stage \"{}\": pressure on {}", name_of(*stage_), in_words(p, state_.r)));
  return lines;
}

void Run::tell_notes_once() {
  if (std::exchange(noted_stage_, stage_index()) == stage_index() || !hooks_.tell) return;
  for (const std::string& line : notes_on_stage()) hooks_.tell(line);
}

State Run::start_of_stage() const {
  require(!simulation_ && !under_way_ && (restart_ || state_.clock.stage_step == 0),
          "the stage is under way");
  State start = restart_ ? *restart_ : current();
  if (!stage_) return start;
  take_back_bonds(start);
  return start;
}

void Run::begin() {
  if (!checked_) check();
  const AnyStage& stage = prepare();
  if (simulation_ || !std::holds_alternative<Stage>(stage)) return;
  tell_notes_once();
  for (const Support& s : std::get<Stage>(stage).supports)
    require(std::none_of(s.particles.begin(), s.particles.end(),
                         [this](ParticleId p) { return is_waiting(state_, p); }),
            fmt::format("stage \"{}\" holds particles of group \"{}\" that have not come in yet",
                        name_of(stage), s.group));
  if (const auto& distance = std::get<Stage>(stage).stops.distance)
    for (const ParticleId p : {distance->i, distance->j}) {
      require(!is_waiting(state_, p),
              fmt::format("stage \"{}\" ends by the distance to particle {}, which has not come in yet",
                          name_of(stage), p.value));
      require(!is_dropped(state_, p),
              fmt::format("stage \"{}\" ends by the distance to particle {}, which was dropped before it",
                          name_of(stage), p.value));
    }
  if (partition_ != nullptr)
    take_part();
  else
    simulation_ = std::make_unique<Simulation>(model_, std::get<Stage>(stage), &state_, threads_);
  for (const auto& o : observers_) simulation_->add_observer(o);
}

const std::vector<StageResult>& Run::run() {
  require_able();
  while (!complete())
    if (run_stage().interrupted()) break;
  return results_;
}

StageResult Run::run_stage() {
  require_able();
  begin();
  if (std::holds_alternative<StaticStage>(*stage_)) return run_static();
  const StopReason why = advance(std::numeric_limits<std::int64_t>::max());
  return why == StopReason::interrupted ? result_of_dynamics(why) : results_.back();
}

std::int64_t Run::step(std::int64_t n) {
  require(n >= 0, fmt::format("step({}): the number of steps must be >= 0", n));
  require_able();
  const auto* statics = std::get_if<StaticStage>(&prepare());
  require(statics == nullptr, "stage \"" + name_of(*stage_) + "\" is static: run_stage() runs it as a whole");
  begin();
  const std::int64_t before = clock().step;
  if (n > 0) advance(n);
  return clock().step - before;
}

void Run::end_stage() {
  require_able();
  require(simulation_ != nullptr, "no stage of dynamics is under way");
  finish(observers_, *simulation_, StopReason::duration);
  close_stage(StopReason::duration);
}

/// Steps until the stage ends, is interrupted, or `most` steps are made.
StopReason Run::advance(std::int64_t most) {
  StopReason why = StopReason::running;
  try {
    why = steps_of_stage(most);
  } catch (const Diverged& e) {
    sum_up_dropped();
    fail(e.what());
    results_.push_back(result_of_dynamics(StopReason::diverged));
    tell_stage_end(StopReason::diverged, e.what());
    throw;
  } catch (const std::exception& e) {
    fail(e.what());
    throw;
  }
  if (why == StopReason::interrupted) tell_stage_end(why, {});
  if (why != StopReason::running && why != StopReason::interrupted) close_stage(why);
  return why;
}

void Run::tell_stage_end(StopReason why, const std::string& failure) {
  if (hooks_.stage_end && simulation_)  // there is none where the body diverged as it was spread anew
    exchange().together([&] { hooks_.stage_end(*simulation_, why, failure); });
}

/// The same, without particles that are lost on the way, if the stage drops such.
StopReason Run::steps_of_stage(std::int64_t most) {
  const std::int64_t first = clock().step;
  while (true) try {
      const StopReason why = simulation_->run(hooks_.interrupted, most - (clock().step - first));
      if (why != StopReason::running || clock().step - first == most) return why;
      set_up_anew();
    } catch (const ParticlesLost& found) {
      if (!drop(found)) throw;
    }
}

void Run::close_stage(StopReason why) {
  sum_up_dropped();
  tell_stage_end(why, {});
  results_.push_back(result_of_dynamics(why));
  if (partition_ != nullptr && stage_index() + 1 == stages_->size())
    end_in_parts();
  else
    hand_over();
  const auto& stage = std::get<Stage>(*stage_);
  const double time = static_cast<double>(state_.clock.stage_step) * stage.dt;
  if (hooks_.tell)
    for (const std::string& sentence : stresses_not_reached(stage.cell, state_, time))
      hooks_.tell(fmt::format("stage \"{}\" ends before the cell has given way: {}", stage.name, sentence));
  end_sources();
  stage_.reset();
  begin_next_stage(state_.clock);
}

StageResult Run::result_of_dynamics(StopReason why) const {
  StageResult result;
  result.name = name_of(*stage_);
  result.stop = why;
  result.steps = clock().stage_step;
  result.time = clock().time();
  result.peak = simulation_ ? simulation_->peak() : state_.peak;
  result.failure = failure_;
  return result;
}

void Run::fail(const std::string& why) {
  failure_ = why.empty() ? "unknown" : why;
}

void Run::set_velocities(const PerParticle<Vec3d>& v, const PerParticle<Vec3d>& omega) {
  require_able();
  State moved = at_rest(model_);
  moved.v = v;
  moved.omega = omega;
  refuse("Run::set_velocities", mistakes_in(model_, moved));
  refuse("Run::set_velocities", mistakes_in_values(model_, moved));
  change_motion(std::move(moved.v), std::move(moved.omega));
}

void Run::set_velocity(const std::vector<ParticleId>& particles, const Vec3d& v, const Vec3d& omega) {
  require_able();
  require(is_finite(v) && is_finite(omega), "set_velocity: velocities must be finite");
  for (const ParticleId p : particles)
    require(p.value < model_.particles(),
            fmt::format("set_velocity: particle {} of {}, from 0", p.value, model_.particles()));
  PerParticle<Vec3d> all_v = current().v, all_omega = current().omega;
  for (const ParticleId p : particles) all_v[p] = v, all_omega[p] = omega;
  change_motion(std::move(all_v), std::move(all_omega));
}

void Run::change_motion(PerParticle<Vec3d> v, PerParticle<Vec3d> omega) {
  require(!restart_ && !under_way_, "a static stage was interrupted: it begins and ends at rest");
  if (simulation_) {
    state_ = std::move(*simulation_).handover().state;
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    for (GripState& g : state_.grips) g.velocity = {unknown, unknown, unknown};
    keep_held(std::get<Stage>(*stage_).supports, state_, v, omega);
  }
  const double before = kinetic_energy_beside_flow(model_, state_);
  for (const ParticleId p : absent(state_)) v[p] = state_.v[p], omega[p] = state_.omega[p];
  state_.v = std::move(v);
  state_.omega = std::move(omega);
  if (state_.clock.step > 0) {  // else the books are opened as the run begins
    const double change = kinetic_energy_beside_flow(model_, state_) - before;
    state_.books.work_loads += change;
    books_before_.work_loads += change;
  }
  begin_again();
}

/// The time loop anew, after a change.
void Run::begin_again() {
  if (!simulation_) return;
  simulation_.reset();
  begin();
}

void Run::add_load(const PointLoad& load) {
  AnyStage loaded = prepare();
  std::visit(
      [&](auto& stage) {
        stage.loads.push_back(load);
        refuse("Run::add_load", mistakes_in(model_, stage));
      },
      loaded);
  stage_ = std::move(loaded);
  if (simulation_) state_ = std::move(*simulation_).handover().state;
  begin_again();
}

}  // namespace vbond
