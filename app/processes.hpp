#pragma once
#include <functional>
#include <memory>
#include <string>

#include "vbond/case/case.hpp"
#include "vbond/dynamics/partition.hpp"
#include "vbond/run/memory_needed.hpp"
#include "vbond/run/run.hpp"

namespace vbond::app {

/// The processes of a program that several of them run: all do the same, and one of them, which leads, prints
/// and writes. In this form it is one alone.
class Processes {
 public:
  virtual ~Processes() = default;

  /// By which a run is spread over them; null: it is not.
  virtual Partition* partition() { return nullptr; }
  const Exchange& exchange() {
    if (const Partition* const spreads = partition()) return *spreads;
    return one_rank();
  }
  bool leads() { return exchange().leads(); }
  /// Those that share this machine.
  virtual RanksHere here() const { return {}; }
  /// Does what all of them do, and returns the exit status. A failure of all is told by the one that leads;
  /// one of a single process is told by it and ends all.
  virtual int run(const std::function<int()>& work) { return work(); }
  /// To be called by each that has come so far, before they do anything together. Throws if another one has
  /// failed.
  virtual void meet() {}
  /// To be called once by each, when it has found that it can begin. Throws what the case has that they
  /// cannot do, and if another one cannot begin.
  virtual void begin_together(const Case& /*c*/) {}
  /// The text of the one that leads.
  virtual std::string text_of_leader(const std::string& text) const { return text; }
  /// Whether the program may start others, which would take themselves for one of these processes.
  virtual bool may_start_programs() const { return true; }
  /// What there is to say of them when the run has ended.
  virtual std::string remarks() const { return {}; }
};

// ---- what a build of the program has -----------------------------------------------------------------

/// What the program is called, and what it says besides its version.
extern const char* const program_name;
extern const char* const program_note;
/// To be called once, first of all.
std::unique_ptr<Processes> start_processes(int& argc, char**& argv);
/// Whether runs are spread over processes, not over threads.
extern const bool has_ranks;

}  // namespace vbond::app
