#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/loads.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/summary.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// The names of the columns of the terminal's table, one line. breaks: with that of broken bonds.
std::string table_header(bool breaks = false);

/// One line of the terminal's table, as wide as its header for every value.
std::string table_row(const Clock& clock, const EnergyBooks& books, const Energies& energies,
                      double balance_error, const RangeCounts& ranges,
                      std::optional<std::int64_t> broken = {});

/// The same for points of static stages.
std::string static_table_header();
std::string static_table_row(std::int64_t step, const BalancePoint& balance, const Energies& energies,
                             const RangeCounts& ranges);

/// "stable", "neutral: ...", "UNSTABLE in 2 directions" or that it is not known: the balance at the end.
std::string balance_in_words(const StaticResult& result);

/// What a static stage has found, for people: its balance, special points, critical loads or frequencies.
/// time_unit: " s" or "".
std::string static_report(StageKind kind, const StaticResult& result, const std::string& time_unit);

/// Steps between rows of the table so that a stage of this many steps gives about 25 of them.
std::int64_t table_interval(std::int64_t stage_steps);

/// Steps until a tenth of a second will have passed, if `steps` took this many seconds: at least one,
/// and at most twice `steps`, since a few fast ones promise little.
std::int64_t progress_interval(std::int64_t steps, double seconds);

/// Seconds of wall time that a run may still take at the speed it had so far, at most; nothing if that is not
/// known. The numbers are those of progress_line.
std::optional<double> seconds_left(std::int64_t step, std::int64_t first_step, std::int64_t total_steps,
                                   double seconds);

/// One line on how far the run is: stage, part done, speed and the time it may still take.
/// seconds: wall time since first_step; total_steps: of the whole run if no stage ends early; last_stage:
/// these steps are certain, those of later stages may turn out shorter.
std::string progress_line(const std::string& stage, std::int64_t step, std::int64_t first_step,
                          std::int64_t total_steps, double seconds, bool last_stage = true);

/// A breakdown of wall time, one line per phase with its share, and the sum.
std::string timing_table(const std::vector<PhaseTime>& phases);

/// A time for people: seconds below a minute, else h:mm:ss.
std::string hours(double seconds);

}  // namespace vbond
