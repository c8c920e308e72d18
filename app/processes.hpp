#pragma once
#include <functional>
#include <memory>
#include <string>

#include "memory.hpp"
#include "vbond/case/case.hpp"
#include "vbond/dynamics/partition.hpp"
#include "vbond/run/run.hpp"

namespace vbond::app {

/// The processes of a program that several of them run: all do the same, and one of them, which leads, prints
/// and writes.
class Processes {
 public:
  virtual ~Processes() = default;

  /// By which a run is spread over them.
  virtual Partition& partition() = 0;
  bool leads() { return partition().leads(); }
  /// Those that share this machine.
  virtual RanksHere here() const = 0;
  /// Does what all of them do, and returns the exit status. A failure of all is told by the one that leads;
  /// one of a single process is told by it and ends all.
  virtual int run(const std::function<int()>& work) = 0;
  /// To be called once by each, when it has found that it can begin. Throws what the case has that they
  /// cannot do, and if another one cannot begin.
  virtual void begin_together(const Case& c) = 0;
  /// The text of the one that leads.
  virtual std::string text_of_leader(const std::string& text) const = 0;
  /// What there is to say of them when the run has ended.
  virtual std::string remarks() const = 0;
};

// ---- what a build of the program has -----------------------------------------------------------------

/// What the program is called, and what it says besides its version.
extern const char* const program_name;
extern const char* const program_note;
/// Null: it is one process. To be called once, first of all.
std::unique_ptr<Processes> start_processes(int& argc, char**& argv);

}  // namespace vbond::app
