#include "vbond/observe/table_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vbond/core/printable.hpp"

namespace vbond {

std::string table_header(bool breaks) {
  return fmt::format("{:>12} {:>12} {:>12} {:>12} {:>12} {:>12} {:>12} {:>10} {:>8} {:>8}{}\n", "step",
                     "time", "kinetic", "potential", "dissipated", "work", "total", "balance", "strained",
                     "snapped", breaks ? "   broken" : "");
}

std::string table_row(const Clock& clock, const EnergyBooks& b, const Energies& e, double balance_error,
                      const RangeCounts& ranges, std::optional<std::int64_t> broken) {
  return fmt::format("{:12} {:12.6g} {:12.4e} {:12.4e} {:12.4e} {:12.4e} {:12.4e} {:10.2e} {:8} {:8}{}\n",
                     clock.step, clock.time(), e.kinetic(), e.potential(), b.dissipated,
                     b.work_loads + b.work_supports, e.total(), balance_error, ranges.strained,
                     ranges.snapped, broken ? fmt::format(" {:8}", *broken) : "");
}

std::int64_t table_interval(std::int64_t stage_steps) {
  constexpr std::int64_t intervals = 24;  // 25 rows with the first
  return std::max<std::int64_t>(1, (stage_steps + intervals - 1) / intervals);
}

std::int64_t progress_interval(std::int64_t steps, double seconds) {
  constexpr double between_looks = 0.1;  // seconds
  const double most = 2.0 * static_cast<double>(steps);
  const double wanted = seconds > 0.0 ? static_cast<double>(steps) * between_looks / seconds : most;
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::min(wanted, most)));
}

namespace {
/// Steps per second of wall time; 0: not known.
double speed_of(std::int64_t step, std::int64_t first_step, double seconds) {
  return seconds > 0.0 ? static_cast<double>(step - first_step) / seconds : 0.0;
}
}  // namespace

std::optional<double> seconds_left(std::int64_t step, std::int64_t first_step, std::int64_t total_steps,
                                   double seconds) {
  const double speed = speed_of(step, first_step, seconds);
  if (!(speed > 0.0)) return std::nullopt;
  return static_cast<double>(std::max<std::int64_t>(0, total_steps - step)) / speed;
}

std::string progress_line(const std::string& stage, std::int64_t step, std::int64_t first_step,
                          std::int64_t total_steps, double seconds, bool last_stage) {
  const double part =
      total_steps > 0 ? std::min(1.0, static_cast<double>(step) / static_cast<double>(total_steps)) : 0.0;
  std::string line = fmt::format("stage {}: step {}, {:.1f} %", printable(stage), step, 100.0 * part);
  if (const auto left = seconds_left(step, first_step, total_steps, seconds))
    line += fmt::format(", {:.3g} steps/s, {} {} left", speed_of(step, first_step, seconds),
                        last_stage ? "at most" : "about", hours(*left));
  return line;
}

std::string timing_table(const std::vector<PhaseTime>& phases) {
  double sum = 0.0;
  for (const PhaseTime& p : phases) sum += p.seconds;
  std::string table;
  for (const PhaseTime& p : phases)
    table += fmt::format("{:<24} {:10.3f} s {:6.1f} %\n", p.name, p.seconds,
                         sum > 0.0 ? 100.0 * p.seconds / sum : 0.0);
  return table + fmt::format("{:<24} {:10.3f} s\n", "total", sum);
}

std::string hours(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.2g} s", seconds);
  const auto s = static_cast<std::int64_t>(std::llround(std::min(seconds, 1e9)));
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace vbond
