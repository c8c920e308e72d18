#pragma once
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vbond/dynamics/observer.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/due.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/history.hpp"
#include "vbond/observe/plan.hpp"
#include "vbond/observe/watch.hpp"

namespace vbond {

class BreaksObserver;

/// True if the stage came to its own end: the run goes on with the next stage.
bool stage_done(StopReason why);

/// An observer that knows how much wall time its work has taken.
class TimedObserver : public Observer {
 public:
  double seconds() const { return seconds_; }

 protected:
  /// Adds the wall time of a block to the observer; used only when there is something to do, since
  /// looking at the clock in every step would cost as much as a small step.
  class Timing {
   public:
    explicit Timing(TimedObserver& o) : observer_(o) {}
    ~Timing() {
      observer_.seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }
    Timing(const Timing&) = delete;
    Timing& operator=(const Timing&) = delete;

   private:
    TimedObserver& observer_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  };

 private:
  double seconds_ = 0;
};

/// Watches the run every OutputPlan::watch_every steps and at every row of the history, before it is
/// written: a row of an unphysical state is never written. Pairs deep in one another and particles that are
/// too fast it looks at in every step that has any, unless OutputPlan::overlap is 0. Throws Diverged, see
/// Watch.
class WatchObserver : public TimedObserver {
 public:
  WatchObserver(const OutputPlan& plan, Watch::Tell tell, WatchRecord record = {});
  void observe(const Simulation& run) override;
  std::int64_t steps_to_next_look(const Clock& now) const override;
  void finish(const Simulation& run, StopReason why) override;
  void observe_balance(const BodyView& body, const BalancePoint& balance) override;
  /// After a failure, for which finish is not called, the program may ask for the summary here.
  Watch& watch() { return watch_; }
  const Watch& watch() const { return watch_; }

 private:
  void look(const Simulation& run);
  void look_at_overlaps(const Simulation& run);
  void look_at_contacts(const Simulation& run);
  /// Looks at energies and bonds per look at overlaps, which takes about as long as ten steps.
  static constexpr std::int64_t looks_per_overlaps = 10;
  std::int64_t every_;
  double overlap_;
  Due history_due_;
  Watch watch_;
};

/// Writes history.csv.
class HistoryObserver : public TimedObserver {
 public:
  HistoryObserver(const OutputPlan& plan, std::optional<std::int64_t> resume_step);
  void observe(const Simulation& run) override;
  std::int64_t steps_to_next_look(const Clock& now) const override;
  void finish(const Simulation& run, StopReason why) override;
  void observe_balance(const BodyView& body, const BalancePoint&) override { write(body); }
  /// What it has written so far; null where others write.
  const HistoryWriter* writer() const { return writer_ ? &*writer_ : nullptr; }

 private:
  void write(const BodyView& body);
  OutputPlan plan_;
  std::optional<HistoryWriter> writer_;
  Due due_;
};

/// Writes the frames; made only if the plan has frames.
class FrameObserver : public TimedObserver {
 public:
  FrameObserver(const OutputPlan& plan, std::optional<std::int64_t> resume_step);
  void observe(const Simulation& run) override;
  std::int64_t steps_to_next_look(const Clock& now) const override;
  void finish(const Simulation& run, StopReason why) override;
  void observe_balance(const BodyView& body, const BalancePoint& balance) override;

 private:
  void write(const Simulation& run);
  FrameWriter writer_;
  Due due_;
};

/// Writes checkpoint.h5 at its interval and whenever a stage ends or is interrupted.
class CheckpointObserver : public TimedObserver {
 public:
  CheckpointObserver(const OutputPlan& plan, std::shared_ptr<const WatchObserver> watch,
                     std::string program_version);
  void observe(const Simulation& run) override;
  std::int64_t steps_to_next_look(const Clock& now) const override;
  void finish(const Simulation& run, StopReason why) override;
  void write(const Model& model, const State& state) {
    write(model, state, path_);
    last_step_ = state.clock.step;
  }
  /// The same under another name.
  void write(const Model& model, const State& state, const std::filesystem::path& path);
  /// Whether one is due at this point of a static stage from which it can go on: at its interval, in which a
  /// point counts as a step, or once the last one is a minute old, and a hundred times as long ago as it took
  /// to write.
  bool is_due_at_rest(const Clock& now) const;
  /// checkpoint.h5 within a stage of fracture.
  void write_within(const Model& model, const State& state, const FractureUnderWay& under_way);
  /// The step of the last checkpoint.h5 written here.
  const std::optional<std::int64_t>& last_step() const { return last_step_; }

 private:
  using WallClock = std::chrono::steady_clock;
  void write(const Model& model, const State& state, const std::filesystem::path& path,
             const FractureUnderWay* under_way);
  void write(const Simulation& run);
  template <class Work>
  void timed(Work write);

  std::optional<std::int64_t> last_step_;
  WallClock::time_point written_ = WallClock::now();
  WallClock::duration took_{};
  std::filesystem::path path_;
  std::optional<Due> due_;  // by interval; empty without one
  std::shared_ptr<const WatchObserver> watch_;
  std::string program_version_;
  bool writes_;
};

/// Prints the table of the run to a stream of the program, if there is one; a header once, and again after
/// static stages, which have their own.
class TableObserver : public TimedObserver {
 public:
  /// breaks: whether broken bonds have a column.
  explicit TableObserver(std::FILE* out, bool breaks = false) : out_(out), breaks_(breaks) {}
  void observe(const Simulation& run) override;
  std::int64_t steps_to_next_look(const Clock& now) const override;
  void finish(const Simulation& run, StopReason why) override;
  void observe_balance(const BodyView& body, const BalancePoint& balance) override;

 private:
  enum class Header : std::uint8_t { none, dynamics, statics };
  void print(const Simulation& run);
  std::FILE* out_;
  bool breaks_;
  Header header_ = Header::none;       // the last one printed
  std::optional<std::int32_t> stage_;  // the last one seen
  std::int64_t interval_ = 1;          // in that stage, in steps
  std::int64_t last_step_ = -1;
};

/// Keeps one line on the progress of the run up to date on a terminal, twice a second at most, and
/// clears it when a stage ends; tells a listener of it once a second. It reads the wall clock about ten times
/// a second, so that its cost does not depend on how long a step takes; of a body that several processes
/// step, the one that leads reads it, and no more often than they meet anyway. Before anything else is
/// printed there, clear() it.
class ProgressObserver : public TimedObserver {
 public:
  /// Seconds that the dynamics may still take at most; nothing if that is not known.
  using Beat = std::function<void(const Simulation&, std::optional<double> seconds_left)>;
  /// terminal: null if there is none. stage_steps: per stage, its steps if it does not end early; none as
  /// long as no step is known.
  ProgressObserver(std::FILE* terminal, std::vector<std::int64_t> stage_steps);
  void expect(std::vector<std::int64_t> stage_steps) { stage_steps_ = std::move(stage_steps); }
  /// Called once a second of wall time at most, not at the start.
  void on_beat(Beat beat) { beat_ = std::move(beat); }
  void observe(const Simulation& run) override;
  std::int64_t steps_to_next_look(const Clock& now) const override;
  void finish(const Simulation& run, StopReason why) override;
  void clear();

 private:
  using WallClock = std::chrono::steady_clock;
  void show_line(const Simulation& run, WallClock::time_point now);
  void beat(const Simulation& run, WallClock::time_point now);
  std::int64_t total_steps(const Clock& clock) const;
  double seconds_until(WallClock::time_point now) const;
  std::FILE* out_;
  std::vector<std::int64_t> stage_steps_;
  Beat beat_;
  std::optional<std::int64_t> first_step_;  // of the run, that was looked at
  std::int64_t last_look_ = 0, next_look_ = 0;
  WallClock::time_point start_, shown_, beaten_, looked_;
  bool visible_ = false;
};

/// All observers that write files, in the order in which they must be asked: the watch first, so that
/// nothing unphysical is written, and the checkpoint last, so that the files never lag behind it.
struct FileObservers {
  std::shared_ptr<WatchObserver> watch;
  std::shared_ptr<HistoryObserver> history;
  std::shared_ptr<BreaksObserver> breaks;  ///< null where no bond may break
  std::shared_ptr<FrameObserver> frames;   ///< null without frames
  std::shared_ptr<CheckpointObserver> checkpoint;
  std::vector<std::shared_ptr<Observer>> all() const;
  /// Wall time spent so far, by observer.
  std::vector<std::pair<std::string, double>> seconds() const;
};

/// Opens the output of a run: new files, or with a checkpoint the files it goes on with.
/// tell: takes the reports of the watch. Throws IoError.
FileObservers open_output(const OutputPlan& plan, Watch::Tell tell, const std::string& program_version,
                          const Checkpoint* resume = nullptr);

}  // namespace vbond
