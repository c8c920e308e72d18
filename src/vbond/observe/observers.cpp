#include "vbond/observe/observers.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/breaks_observer.hpp"
#include "vbond/observe/table_text.hpp"

namespace vbond {
namespace {

std::int64_t steps_of(const Stage& stage, std::int64_t otherwise) {
  return std::isfinite(stage.stops.duration) ? steps_in(stage.stops.duration, stage.dt) : otherwise;
}

constexpr const char* clear_line = "\r\033[K";  // to the line's start; erase to its end (ECMA-48)

/// Text to the stream that the program handed over. A terminal that has gone away must not end a run.
void show(const std::string& text, std::FILE* out) {
  if (out == nullptr) return;
  std::fwrite(text.data(), 1, text.size(), out);
  std::fflush(out);
}

/// A run with such bonds has had a list of breaks.
bool any_may_have_broken(const State& state) {
  return std::any_of(state.bonds.begin(), state.bonds.end(),
                     [](const Bond& b) { return b.broken || can_break(b); });
}

}  // namespace

bool stage_done(StopReason why) {
  switch (why) {
    case StopReason::duration:
    case StopReason::distance:
    case StopReason::peak:
    case StopReason::rest:
    case StopReason::breaks: return true;
    case StopReason::running:
    case StopReason::diverged:
    case StopReason::interrupted: return false;
  }
  return false;
}

// ---- watch ------------------------------------------------------------------------------------------

WatchObserver::WatchObserver(const OutputPlan& plan, Watch::Tell tell, WatchRecord record)
    : every_(plan.watch_every),
      overlap_(plan.overlap),
      history_due_(plan.history_every),
      watch_(plan.energy_error, std::move(tell), std::move(record)) {}

void WatchObserver::observe(const Simulation& run) {
  const Clock& clock = run.clock();  // a pair that has passed is the cause of a balance that is off
  if (run.deep().particles.any() || run.deep().capsules.deep()) look_at_contacts(run);
  if (clock.stage_step % every_ == 0 || history_due_.now(clock)) look(run);
  if (clock.stage_step % (looks_per_overlaps * every_) == 0) look_at_overlaps(run);
}

std::int64_t WatchObserver::steps_to_next_look(const Clock& now) const {
  return std::min(steps_to_multiple(now, every_), history_due_.steps_to_next(now));
}

void WatchObserver::finish(const Simulation& run, StopReason why) {
  if (stage_done(why)) {
    look(run);
    look_at_overlaps(run);
    watch_.look_at_servos(run);
  }
  watch_.summarise();
}

void WatchObserver::look(const Simulation& run) {
  const Timing timing(*this);
  if (const auto& turn = run.survey().fast_turn) watch_.look_at_turns(*turn, run.clock(), run.stage().insist);
  constexpr double deep = 0.1;  // of the radius: much more than a step that follows the contact lets happen
  watch_.look(run, [&run] { return Watch::in_wall(run.model(), run.deep().walls.deeper_than(deep)); });
}

void WatchObserver::observe_balance(const BodyView& body, const BalancePoint& /*balance*/) {
  const Timing timing(*this);
  watch_.look(body);
  if (overlap_ > 0.0) watch_.look_at_overlaps(body, overlap_);
}

void WatchObserver::look_at_overlaps(const Simulation& run) {
  if (overlap_ == 0.0) return;
  const Timing timing(*this);
  watch_.look_at_overlaps(run, overlap_);
  watch_.look_at_walls(run.model(), run.deep().walls.deeper_than(overlap_), run.clock());
  watch_.look_at_capsules(run.deep().capsules.deeper_than(overlap_), run.clock());
}

void WatchObserver::look_at_contacts(const Simulation& run) {
  if (overlap_ == 0.0) return;
  const Timing timing(*this);
  const Deep deep = run.deep();
  if (const auto& fastest = deep.particles.fastest()) watch_.look_at_speed(*fastest, run.clock());
  watch_.look_at_capsules(deep.capsules.deeper_than(overlap_), run.clock());
  watch_.look_at_encounters(run.model(), deep.particles.found(), run.clock(), overlap_,
                            [&run]() -> const State& { return run.state(); });
}

// ---- history ----------------------------------------------------------------------------------------

HistoryObserver::HistoryObserver(const OutputPlan& plan, std::optional<std::int64_t> resume_step)
    : plan_(plan), due_(plan.history_every) {
  if (!plan.writes_all()) return;
  writer_.emplace(plan, resume_step);
  due_.written(writer_->last_step());
}

void HistoryObserver::observe(const Simulation& run) {
  if (run.processes().leader_says(due_.now(run.clock()))) write(run);
}

std::int64_t HistoryObserver::steps_to_next_look(const Clock& now) const {
  return due_.steps_to_next(now);
}

void HistoryObserver::finish(const Simulation& run, StopReason why) {
  if (stage_done(why) && run.processes().leader_says(due_.at_stage_end(run.clock()))) write(run);
}

void HistoryObserver::write(const BodyView& body) {
  const Timing timing(*this);
  const HistoryValues values = history_values(plan_, body);
  if (writer_) writer_->write(values);
  due_.written(values.clock.step);
}

// ---- frames -----------------------------------------------------------------------------------------

FrameObserver::FrameObserver(const OutputPlan& plan, std::optional<std::int64_t> resume_step)
    : writer_(plan.folder, plan.lammps_dump, resume_step, plan.format_of_frames(), plan.writes_all()),
      due_(plan.frames_every.value(), writer_.last_step()) {}

void FrameObserver::observe(const Simulation& run) {
  if (run.processes().leader_says(due_.now(run.clock()))) write(run);
}

std::int64_t FrameObserver::steps_to_next_look(const Clock& now) const {
  return due_.steps_to_next(now);
}

void FrameObserver::finish(const Simulation& run, StopReason why) {
  if (stage_done(why) && run.processes().leader_says(due_.at_stage_end(run.clock()))) write(run);
}

void FrameObserver::write(const Simulation& run) {
  const Timing timing(*this);
  writer_.write(run);
  due_.written(run.clock().step);
}

void FrameObserver::observe_balance(const BodyView& body, const BalancePoint& balance) {
  const Timing timing(*this);
  writer_.write(body.model(), body.state(), balance.load_factor);
  due_.written(body.clock().step);
}

// ---- table and progress -----------------------------------------------------------------------------

void TableObserver::observe(const Simulation& run) {
  const Clock& clock = run.clock();
  if (clock.stage != stage_ || clock.stage_step == 0) {
    // without a known end a stage has no fixed number of rows: then one in a thousand steps
    interval_ = table_interval(steps_of(run.stage(), 24000));
    stage_ = clock.stage;
  }
  if (clock.stage_step % interval_ == 0) print(run);
}

std::int64_t TableObserver::steps_to_next_look(const Clock& now) const {
  return steps_to_multiple(now, interval_);
}

void TableObserver::finish(const Simulation& run, StopReason /*why*/) {
  print(run);
}

void TableObserver::print(const Simulation& run) {
  if (run.clock().step == last_step_) return;
  last_step_ = run.clock().step;
  const Timing timing(*this);
  std::optional<std::int64_t> broken;
  if (breaks_) broken = count_broken(run.part(Show::bonds));
  std::string text =
      std::exchange(header_, Header::dynamics) == Header::dynamics ? "" : table_header(breaks_);
  text += table_row(run.clock(), run.books(), run.energies(), run.balance_error(), count_ranges(run), broken);
  show(text, out_);
}

void TableObserver::observe_balance(const BodyView& body, const BalancePoint& balance) {
  const Timing timing(*this);
  std::string text = std::exchange(header_, Header::statics) == Header::statics ? "" : static_table_header();
  show(text + static_table_row(body.clock().step, balance, body.energies(), count_ranges(body)), out_);
  last_step_ = body.clock().step;
}

ProgressObserver::ProgressObserver(std::FILE* terminal, std::vector<std::int64_t> stage_steps)
    : out_(terminal), stage_steps_(std::move(stage_steps)) {}

void ProgressObserver::observe(const Simulation& run) {
  constexpr std::chrono::milliseconds refresh(500), pulse(1000);
  const Clock& clock = run.clock();
  const bool begins = !first_step_ || clock.stage_step == 0;  // its steps may be slower than those before
  const Communicator& all = run.processes();
  if (all.leader_says(!begins && clock.step < next_look_)) return;  // this step was asked for by others
  const auto now = WallClock::now();
  if (!first_step_) {
    first_step_ = clock.step;
    start_ = shown_ = beaten_ = now;
  }
  const double seconds = std::chrono::duration<double>(now - looked_).count();
  const std::int64_t interval = begins ? 1 : progress_interval(clock.step - last_look_, seconds);
  next_look_ = !all.leads() ? no_next_look : clock.step + std::max(interval, all.steps_between_meetings());
  last_look_ = clock.step;
  looked_ = now;
  if (out_ != nullptr && now - shown_ >= refresh) show_line(run, now);
  if (beat_ && all.leader_says(now - beaten_ >= pulse)) beat(run, now);
}

std::int64_t ProgressObserver::steps_to_next_look(const Clock& now) const {
  return std::max<std::int64_t>(1, next_look_ - now.step);
}

void ProgressObserver::show_line(const Simulation& run, WallClock::time_point now) {
  const Timing timing(*this);
  const Clock& clock = run.clock();
  shown_ = now;
  const std::string line =
      progress_line(run.stage().name, clock.step, *first_step_, total_steps(clock), seconds_until(now),
                    static_cast<std::size_t>(clock.stage) + 1 >= stage_steps_.size());
  show(clear_line + line, out_);
  visible_ = true;
}

void ProgressObserver::beat(const Simulation& run, WallClock::time_point now) {
  const Timing timing(*this);
  const Clock& clock = run.clock();
  beaten_ = now;
  beat_(run, seconds_left(clock.step, *first_step_, total_steps(clock), seconds_until(now)));
}

/// Stages that ended early count as they went: what is left is this stage's rest and the later ones.
std::int64_t ProgressObserver::total_steps(const Clock& clock) const {
  const auto stage = std::min(static_cast<std::size_t>(clock.stage), stage_steps_.size());
  return clock.step + std::accumulate(stage_steps_.begin() + static_cast<std::ptrdiff_t>(stage),
                                      stage_steps_.end(), -clock.stage_step);
}

double ProgressObserver::seconds_until(WallClock::time_point now) const {
  return std::chrono::duration<double>(now - start_).count();
}

void ProgressObserver::finish(const Simulation& /*run*/, StopReason /*why*/) {
  clear();
}

void ProgressObserver::clear() {
  if (!std::exchange(visible_, false)) return;
  show(clear_line, out_);
}

// ---- all of them ------------------------------------------------------------------------------------

std::vector<std::shared_ptr<Observer>> FileObservers::all() const {
  std::vector<std::shared_ptr<Observer>> observers{watch, history};
  if (breaks) observers.push_back(breaks);
  if (frames) observers.push_back(frames);
  observers.push_back(checkpoint);
  return observers;
}

std::vector<std::pair<std::string, double>> FileObservers::seconds() const {
  return {{"watch", watch->seconds()},
          {"history", history->seconds() + (breaks ? breaks->seconds() : 0.0)},
          {"frames", frames ? frames->seconds() : 0.0},
          {"checkpoint", checkpoint->seconds()}};
}

FileObservers open_output(const OutputPlan& plan, Watch::Tell tell, const std::string& program_version,
                          const Checkpoint* resume) {
  std::optional<std::int64_t> step;
  if (resume) step = resume->state.clock.step;
  FileObservers o;
  o.history = std::make_shared<HistoryObserver>(plan, step);
  std::optional<Clock> resumed;
  if (resume) resumed = resume->state.clock;
  if (plan.breaks)
    o.breaks = std::make_shared<BreaksObserver>(plan, resumed, resume && resume->under_way);
  else if (resumed && plan.writes_all())
    cut_breaks(plan, *resumed);
  const auto tell_anew = [&](bool anew, const char* name, const char* why) {
    if (anew && tell) tell((plan.folder / name).string() + why + ": a new one begins here");
  };
  tell_anew(o.history->writer() != nullptr && o.history->writer()->begun_anew(), "history.csv",
            " is not there any more");
  tell_anew(o.breaks && o.breaks->begun_anew(), "breaks.csv",
            resume && any_may_have_broken(resume->state) ? " is not there any more"
                                                         : " is not there, no bond could break so far");
  o.watch = std::make_shared<WatchObserver>(plan, std::move(tell), resume ? resume->watch : WatchRecord{});
  if (plan.frames_every)
    o.frames = std::make_shared<FrameObserver>(plan, step);
  else if (std::error_code e;
           step && plan.writes_all() && std::filesystem::exists(plan.folder / "particles.pvd", e))
    FrameWriter(plan.folder, false, step,
                plan.format_of_frames());  // no more are wanted, but late ones of a killed run go
  o.checkpoint = std::make_shared<CheckpointObserver>(plan, o.watch, program_version);
  return o;
}

}  // namespace vbond
