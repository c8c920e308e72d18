#include <utility>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/observers.hpp"

namespace vbond {

CheckpointObserver::CheckpointObserver(const OutputPlan& plan, std::shared_ptr<const WatchObserver> watch,
                                       std::string program_version)
    : path_(plan.folder / "checkpoint.h5"),
      watch_(std::move(watch)),
      program_version_(std::move(program_version)),
      writes_(plan.writes_all()) {
  if (plan.checkpoint_every) due_.emplace(*plan.checkpoint_every);
}

void CheckpointObserver::observe(const Simulation& run) {
  const Clock& clock = run.clock();
  if (due_ && clock.stage_step > 0 && due_->now(clock)) write(run);
}

std::int64_t CheckpointObserver::steps_to_next_look(const Clock& now) const {
  return due_ ? due_->steps_to_next(now) : no_next_look;
}

void CheckpointObserver::finish(const Simulation& run, StopReason /*why*/) {
  write(run);
}

/// Where each process has its own share alone, they bring it together for the one that leads.
void CheckpointObserver::write(const Simulation& run) {
  const auto part = run.state_of_part();
  if (!part) return write(run.model(), run.state());
  timed([&] { write_checkpoint(path_, run.model(), *part, watch_->watch().record(), program_version_); });
  last_step_ = run.clock().step;
}

void CheckpointObserver::write(const Model& model, const State& state, const std::filesystem::path& path) {
  write(model, state, path, nullptr);
}

void CheckpointObserver::write_within(const Model& model, const State& state,
                                      const FractureUnderWay& under_way) {
  write(model, state, path_, &under_way);
  last_step_ = state.clock.step;
}

void CheckpointObserver::write(const Model& model, const State& state, const std::filesystem::path& path,
                               const FractureUnderWay* under_way) {
  if (!writes_) return;
  timed([&] { write_checkpoint(path, model, state, watch_->watch().record(), program_version_, under_way); });
}

template <class Work>
void CheckpointObserver::timed(Work write) {
  const Timing timing(*this);
  const auto begun = WallClock::now();
  write();
  written_ = WallClock::now();
  took_ = written_ - begun;
}

bool CheckpointObserver::is_due_at_rest(const Clock& now) const {
  constexpr std::chrono::minutes often(1);
  constexpr int share = 100;
  if (!writes_ || last_step_ == now.step) return false;
  if (due_ && due_->now(now)) return true;
  const auto since = WallClock::now() - written_;
  return since >= often && since >= share * took_;
}

}  // namespace vbond
