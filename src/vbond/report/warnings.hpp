#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/observe/summary.hpp"
#include "vbond/report/history_read.hpp"
#include "vbond/report/sequence.hpp"

/// What a reader of a run has to know before believing it, in plain words.
namespace vbond::page {

enum class Level : std::uint8_t { error, warning, note };

struct Warning {
  Level level = Level::note;
  std::string text;
};

/// "error", "warning", "note".
const char* to_text(Level level);

/// The time step of a run and what it is held against; 0: not known.  [time]
struct StepFacts {
  double dt = 0, critical = 0;
};

/// What the warnings are drawn from.
struct RunFacts {
  const std::optional<RunSummary>& summary;  ///< absent: no stage has ended
  const History& history;
  const Body& body;
  UnitSystem units = UnitSystem::reduced;
  std::size_t stages = 0;      ///< in the case
  std::string resume_command;  ///< how to go on with a run that was stopped
  StepFacts step;
  std::vector<Warning> files;  ///< what of the folder could not be read
  bool live = false;           ///< the page says itself how the run stands
};

/// |balance_error| above which there is a note: all examples stay below 1.4e-4 (README).
constexpr double notable_balance_error = 1e-3;

/// |balance_error| above which there is a warning. Leap-frog conserves v^2/2 + (1 - (dt/dt_critical)^2) U of
/// its fastest motion: at the default of a tenth of the critical step a hundredth of the energy is at stake,
/// if all of it is in that motion.
constexpr double worrying_balance_error = 1e-2;

/// Part of the critical step that is passed without a word.
constexpr double worrying_step = 0.9;

/// In order of weight.
std::vector<Warning> warnings(const RunFacts& run);

}  // namespace vbond::page
