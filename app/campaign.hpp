#pragma once
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "heartbeat.hpp"
#include "prepare.hpp"
#include "vbond/case/case.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/observe/plan.hpp"
#include "vbond/observe/summary.hpp"
#include "vbond/run/run.hpp"

namespace vbond::app {

using WallClock = std::chrono::steady_clock;

double seconds_since(WallClock::time_point start);

/// Prints in any case: a terminal that has gone away, as on SIGHUP, must not end a run.
void say(const std::string& text, std::FILE* out = stdout);

/// Everything a run in progress has at hand.
struct Campaign {
  const Case& c;
  Run& run;
  OutputPlan plan;
  int threads = 1;
  std::string program;  ///< as it was called
  FileObservers files;
  std::shared_ptr<TableObserver> table;
  std::shared_ptr<ProgressObserver> progress;  ///< on stderr if that is a terminal, and in status.json
  std::shared_ptr<Heartbeat> heartbeat;
  RunSummary summary;
  double building = 0;   ///< seconds of wall time
  double stepping = 0;   ///< seconds, without what observers did between the steps
  double balancing = 0;  ///< seconds of static stages and their modes, without what observers did
  StepTimes times;
  std::vector<StepAhead> ahead;  ///< of all stages, once one of dynamics has begun
  /// What is done at the end of the dynamics stage under way.
  std::function<void(const Simulation&, StopReason, const std::string& failure)> stage_end;

  /// Prints a report on stderr.
  void tell(const std::string& report) const;
  /// Takes the line on the progress off the terminal.
  void clear_progress() const;
  /// Seconds that all output has taken so far.
  double output_seconds() const;
};

/// Opens the output, new or, with a checkpoint, continued, and sets up the terminal. start: of the program.
/// From here on a signal does not end the program, but the run, with a checkpoint.
Campaign open_campaign(const Case& c, Run& run, OutputPlan plan, int threads, const std::string& program,
                       const Checkpoint* resume, WallClock::time_point start);

/// As a static stage began that is under way.
Clock start_of_static_stage(Clock now);

/// checkpoint.h5 within a stage of fracture that is under way, after the breaks until then.
void write_within(Campaign& campaign);

/// Hands all that the run tells to the campaign, which must stay where it is.
void listen(Campaign& campaign);

/// Writes run.json as the campaign stands, with its wall time by phase. All processes of the run call it.
void save_summary(Campaign& campaign);

}  // namespace vbond::app
