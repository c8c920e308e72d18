#pragma once
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "status.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/run/run.hpp"

namespace vbond::app {

/// Keeps status.json up to date, where this process writes it. It never ends a run nor changes it: that the
/// file cannot be written is told once.
class Heartbeat {
 public:
  using WallClock = std::chrono::steady_clock;
  /// run: must live as long. start: of the program. tell: takes the one warning.
  Heartbeat(const Run& run, const OutputPlan& plan, const std::string& title, WallClock::time_point start,
            std::function<void(const std::string&)> tell);
  /// From now on each status is a line there, too.
  void print_to(std::FILE* lines) { lines_ = lines; }
  /// From now on it sees what these have written.
  void follow(FileObservers files);

  /// The run is in a stage that begins or goes on.
  void begin_stage();
  /// Once a second of dynamics, and at the end of a stage of it.
  void beat(const Simulation& stage, std::optional<double> seconds_left);
  /// For each balance of a static stage; writes once a second at most.
  void balance(const BodyView& body);
  void end_static_stage() { write(); }
  /// A report on stderr.
  void told(const std::string& report);
  /// The run ends; why, if it has failed.
  void end(RunState state, const std::string& failure = {});

 private:
  void look(const BodyView& body);
  void look_at_stage(const Simulation& stage);
  void look_at_files();
  void event(std::int64_t step, const std::string& what);
  void write();
  template <class Work>
  void try_to(Work work);

  const Run& run_;
  OutputPlan columns_;  // as far as it says which columns there are
  std::filesystem::path path_;
  bool writes_;
  WallClock::time_point start_, written_;
  std::function<void(const std::string&)> tell_;
  std::FILE* lines_ = nullptr;
  FileObservers files_;
  RunStatus status_;
  std::int64_t event_step_ = 0;
  std::optional<std::int64_t> checkpoint_;  // step of the last one that was seen
  bool broke_ = false, warned_ = false;
};

}  // namespace vbond::app
