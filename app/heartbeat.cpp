#include "heartbeat.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <string_view>
#include <utility>
#include <variant>

#include "campaign.hpp"
#include "lock.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/breaks_observer.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::optional<double> number_of(const Cell& cell) {
  const double* x = std::get_if<double>(&cell);
  return x != nullptr ? std::optional(*x) : std::nullopt;
}

}  // namespace

Heartbeat::Heartbeat(const Run& run, const OutputPlan& plan, const std::string& title,
                     WallClock::time_point start, std::function<void(const std::string&)> tell)
    : run_(run),
      path_(plan.folder / "status.json"),
      writes_(plan.writes_all()),
      start_(start),
      written_(start),
      tell_(std::move(tell)) {
  columns_.breaks = plan.breaks;
  columns_.statics = plan.statics;
  status_.version = VBOND_VERSION;
  status_.process = getpid();
  status_.host = host_name();
  status_.name = title.empty() ? fs::absolute(plan.folder).filename().string() : title;
  status_.stage.count = static_cast<std::int64_t>(run.stages().size());
  for (std::size_t k = 0; k < run.stages().size(); ++k) status_.stage.names.push_back(run.stages().name(k));
}

void Heartbeat::follow(FileObservers files) {
  files_ = std::move(files);
  broke_ = files_.breaks && files_.breaks->record().first_time;
}

template <class Work>
void Heartbeat::try_to(Work work) {
  try {
    work();
  } catch (const std::exception& e) {
    if (!std::exchange(warned_, true) && tell_)
      tell_("warning: the run goes on, but nobody can watch it: " + first_line(e.what()));
  }
}

void Heartbeat::begin_stage() {
  std::optional<std::int64_t> broken;  // asked by all processes, whatever fails below
  if (run_.simulation() == nullptr && columns_.breaks) broken = count_broken(run_.body_at_start());
  try_to([this, broken] {
    const std::size_t k = run_.stage_index();
    const Clock& clock = run_.clock();
    look_at_files();
    event(clock.step, "stage " + run_.stages().name(k) + (clock.stage_step > 0 ? " goes on" : " begins"));
    status_.stage.index = static_cast<std::int64_t>(k);
    status_.stage.name = run_.stages().name(k);
    status_.stage.kind = run_.stages().kind(k);
    status_.stage.steps = clock.stage_step;
    status_.stage.end_time = {};
    status_.step = clock.step;
    status_.time = clock.time();
    status_.seconds_left = {};
    if (const Simulation* stage = run_.simulation())
      look_at_stage(*stage);
    else if (broken)
      status_.broken = *broken;
  });
  write();
}

void Heartbeat::beat(const Simulation& stage, std::optional<double> seconds_left) {
  try_to([&] {
    look_at_stage(stage);
    bool steps_alone = true;  // what static stages will take is not known
    for (std::size_t k = run_.stage_index(); k < run_.stages().size(); ++k)
      steps_alone = steps_alone && !is_static(run_.stages().kind(k));
    status_.seconds_left = steps_alone ? seconds_left : std::nullopt;
  });
  write();
}

void Heartbeat::balance(const BodyView& body) {
  try_to([&] { look(body); });
  if (WallClock::now() - written_ >= std::chrono::seconds(1)) write();
}

void Heartbeat::look(const BodyView& body) {
  const HistoryValues values = history_values(OutputPlan{}, body);
  if (columns_.breaks) status_.broken = count_broken(body.part(Show::bonds));
  status_.step = values.clock.step;
  status_.time = values.clock.time();
  status_.stage.steps = values.clock.stage_step;
  status_.energies.clear();
  for (const HistoryQuantity& q : history_quantities())
    if (q.unit.si == std::string_view(unit::energy.si) && is_in(q.cases, columns_))
      status_.energies.emplace_back(q.name, number_of(q.value(values)));
}

void Heartbeat::look_at_stage(const Simulation& stage) {
  look(stage);
  const double duration = stage.stage().stops.duration;
  if (std::isfinite(duration)) status_.stage.end_time = stage.clock().stage_start + duration;
}

void Heartbeat::told(const std::string& report) {
  event(run_.clock().step, first_line(report));
}

void Heartbeat::look_at_files() {
  if (files_.breaks && !broke_ && files_.breaks->record().first_time) {
    broke_ = true;
    event(status_.step,
          fmt::format("the first bond broke, at t = {:.6g}", *files_.breaks->record().first_time));
  }
  if (!files_.checkpoint || files_.checkpoint->last_step() == checkpoint_) return;
  checkpoint_ = files_.checkpoint->last_step();
  event(*checkpoint_, fmt::format("checkpoint written at step {}", *checkpoint_));
}

/// What was before the last one is no news.
void Heartbeat::event(std::int64_t step, const std::string& what) {
  if (step < event_step_) return;
  event_step_ = step;
  status_.last_event = what;
}

void Heartbeat::end(RunState state, const std::string& failure) {
  look_at_files();
  status_.state = state;
  status_.seconds_left = {};
  status_.failure = failure;
  status_.last_event = state == RunState::complete ? "the run is complete"
                       : state == RunState::failed ? first_line(failure)
                                                   : "stopped by a signal";
  write();
}

void Heartbeat::write() {
  if (!writes_) return;
  try_to([this] {
    look_at_files();
    written_ = WallClock::now();
    status_.wall_seconds = seconds_since(start_);
    status_.written = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    if (lines_ != nullptr) say(to_json_line(status_), lines_);
    replace_file(path_, to_json(status_), Sync::none);
  });
}

}  // namespace vbond::app
