#include "vbond/report/warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace vbond::page {
namespace {

using Warnings = std::vector<Warning>;

double largest(const History& h, const char* column) {
  double most = 0.0;
  if (const HistoryColumn* c = h.find(column))
    for (const double x : c->values) most = std::max(most, std::abs(x));
  return most;
}

std::int64_t count(double x) {
  return std::llround(x);
}

/// When something was so: by load factor in static stages, otherwise by time.
std::string when(const RunFacts& run, double time) {
  const HistoryColumn *times = run.history.find("time"), *factors = run.history.find("load_factor");
  if (times && factors) {
    const auto at =
        std::find_if(times->values.begin(), times->values.end(), [time](double t) { return t >= time; });
    const auto row = static_cast<std::size_t>(at - times->values.begin());
    if (at != times->values.end() && !std::isnan(factors->values[row]))
      return fmt::format("load factor {:.6g}", factors->values[row]);
  }
  return fmt::format("t = {:.6g}{}", time, run.units == UnitSystem::si ? " s" : "");
}

/// " First seen at ...": by the frames, which know the bond, or by history.csv, which is denser.
std::string first_seen(const RunFacts& run, const BondSighting& sighting, const char* column) {
  std::string text;
  const HistoryColumn *times = run.history.find("time"), *counts = run.history.find(column);
  if (times && counts) {
    const auto at =
        std::find_if(counts->values.begin(), counts->values.end(), [](double n) { return n > 0; });
    if (at != counts->values.end())
      text += " First seen at " +
              when(run, times->values[static_cast<std::size_t>(at - counts->values.begin())]) + '.';
  }
  if (sighting.bond >= 0)
    text += fmt::format(" The first in the frames is bond {} (particles {}, {}) at {}.", sighting.bond,
                        sighting.i, sighting.j, when(run, sighting.time));
  return text;
}

/// A report of the program with its advice, which stands on a line of its own there.
std::string one_line(std::string report) {
  constexpr std::string_view line_end = "\n  ";
  for (std::size_t at; (at = report.find(line_end)) != std::string::npos;)
    report.replace(at, line_end.size(), "; ");
  return report;
}

/// Snapped bonds as the run stands: run.json tells it at the end of a stage, history.csv on the way.
std::int64_t snapped_now(const RunFacts& run) {
  const HistoryColumn *times = run.history.find("time"), *column = run.history.find("snapped");
  const bool rows = times && column && !times->values.empty();
  const bool ended = run.summary && !run.summary->stages.empty() &&
                     (!rows || run.summary->stages.back().time >= times->values.back());
  if (ended) return run.summary->snapped;
  return rows ? count(column->values.back()) : 0;
}

void add_endings(const RunFacts& run, Warnings& all) {
  const std::size_t ended = run.summary ? run.summary->stages.size() : 0;
  bool stopped = false;
  for (std::size_t k = 0; k < ended; ++k) {
    const StageSummary& s = run.summary->stages[k];
    const std::string reason = one_line(s.statics ? s.statics->failure : s.failure);
    const bool static_failed = s.statics && s.statics->result.ended == "failed";
    if (s.stop == StopReason::diverged)
      all.push_back(
          {Level::error,
           fmt::format("The run became unphysical in stage \"{}\" and was stopped at {}: its numbers make no "
                       "sense from there on.{}{}",
                       s.name, when(run, s.time), reason.empty() ? "" : " The program said: ", reason)});
    if (static_failed)
      all.push_back(
          {Level::error,
           fmt::format("Stage \"{}\" failed after load factor {:.6g}; what is shown ends there. The "
                       "program said: {}",
                       s.name, s.statics->result.load_factor, reason)});
    const bool interrupted =
        s.statics ? s.statics->result.ended == "interrupted" : s.stop == StopReason::interrupted;
    if (interrupted)
      all.push_back(
          {Level::note, fmt::format("The run was stopped by a signal in stage \"{}\" and is not complete. "
                                    "Go on with: {}",
                                    s.name, run.resume_command)});
    stopped |= s.stop == StopReason::diverged || static_failed || interrupted;
  }
  if (!stopped && !run.live && ended < run.stages)
    all.push_back(
        {Level::note, fmt::format("The run is not complete: {} of {} stages have ended. It is still "
                                  "running, or was killed; then go on with: {}",
                                  ended, run.stages, run.resume_command)});
}

void add_snapped(const RunFacts& run, Warnings& all) {
  const std::int64_t now = snapped_now(run);
  const auto ever =
      std::max(run.summary ? run.summary->ever_snapped : 0, count(largest(run.history, "snapped")));
  const std::int64_t bonds = std::max<std::int64_t>(run.summary ? run.summary->bonds : 0,
                                                    static_cast<std::int64_t>(run.body.bonds.size() / 2));
  const std::string means =
      " Ends of such a bond have turned by more than 90 degrees: its energy has passed its peak, and it "
      "pulls towards a wrong shape instead of back.";
  const std::string first = first_seen(run, run.body.first_snapped, "snapped");
  if (now > 0)
    all.push_back(
        {Level::error, fmt::format("{} of {} bonds {} snapped at the end.{} Shapes and forces from then on "
                                   "are not to be trusted.{}",
                                   now, bonds, now == 1 ? "is" : "are", means, first)});
  else if (ever > 0)
    all.push_back(
        {Level::warning, fmt::format("{} of {} bonds snapped on the way and came back.{} Look at what "
                                     "happens around that time before you believe the rest.{}",
                                     ever, bonds, means, first)});
}

void add_strained(const RunFacts& run, Warnings& all) {
  const auto most =
      std::max(run.summary ? run.summary->ever_strained : 0, count(largest(run.history, "strained")));
  if (most == 0) return;
  all.push_back(
      {Level::warning,
       fmt::format("{} bond{} strained at some time: bent or twisted so far, past 45 degrees (90 for the "
                   "law evm), that moments no longer grow with the angle.{}",
                   most, most == 1 ? " was" : "s were",
                   first_seen(run, run.body.first_strained, "strained"))});
}

void add_stretched(const RunFacts& run, Warnings& all) {
  const std::int64_t bonds = run.summary ? run.summary->ever_stretched : 0;
  if (bonds == 0) return;
  all.push_back({Level::warning,
                 fmt::format("{} bond{} longer than twice the length at rest at some time and held: no real "
                             "bond does, so give it a strength. The terminal named the first ones.",
                             bonds, bonds == 1 ? " was" : "s were")});
}

void add_too_fast(const RunFacts& run, Warnings& all) {
  const double ratio = run.summary ? run.summary->too_fast : 0.0;
  if (ratio == 0.0) return;
  all.push_back(
      {Level::warning,
       fmt::format("Particles moved up to {:.2g} times as far in a step as contacts can follow: they may "
                   "have passed through one another. Use a time.step smaller by that factor.",
                   ratio)});
}

void add_overlapping(const RunFacts& run, Warnings& all) {
  const std::int64_t pairs = run.summary ? run.summary->ever_overlapping : 0;
  if (pairs == 0) return;
  all.push_back(
      {Level::warning,
       fmt::format("{} pair{} of particles that are not bonded overlapped more than watch.overlap allows: "
                   "bodies may have slipped through one another. Contacts, stiffer ones if the case has "
                   "some, or a finer body, keep them apart; the terminal named the first pairs.",
                   pairs, pairs == 1 ? "" : "s")});
}

void add_energy(const RunFacts& run, Warnings& all) {
  const double error =
      std::max(run.summary ? run.summary->energy_balance_error : 0.0, largest(run.history, "balance_error"));
  if (error <= notable_balance_error) return;
  const bool worrying = error > worrying_balance_error;
  all.push_back(
      {worrying ? Level::warning : Level::note,
       fmt::format("The balance of energies is off by up to {:.2g} of the energy in the run{}. A smaller "
                   "time.step makes it better.",
                   error,
                   worrying ? ", more than the time step alone explains"
                            : ": more than in slow motion, usual where the fastest motions prevail")});
}

void add_step(const RunFacts& run, Warnings& all) {
  const auto& [dt, critical] = run.step;
  if (!(critical > 0.0) || dt <= worrying_step * critical) return;
  const bool above = dt > critical;
  all.push_back(
      {above ? Level::error : Level::warning,
       fmt::format(
           "The time step is {:.3g} of the critical one: {} Use a smaller time.step or time.fraction.",
           dt / critical,
           above ? "above it motion grows without bound, and results are worthless."
                 : "so close to it the fastest motions are wrong, and a stiffer body would blow up.")});
}

void add_unstable(const RunFacts& run, Warnings& all) {
  if (!run.summary) return;
  for (const StageSummary& s : run.summary->stages) {
    if (!s.statics) continue;
    const StaticResult& r = s.statics->result;
    if (s.statics->kind == StageKind::equilibrium && r.unstable.value_or(0) > 0)
      all.push_back({Level::warning, fmt::format("The balance that stage \"{}\" has found is unstable in {} "
                                                 "direction{}: a real body would leave it.",
                                                 s.name, *r.unstable, *r.unstable == 1 ? "" : "s")});
    if (r.jumped)
      all.push_back(
          {Level::note, fmt::format("In stage \"{}\" the body lost its balance and jumped to another one: "
                                    "kind = \"path\" follows what lies between.",
                                    s.name)});
    if (r.most_used && r.most_used->utilisation >= 1.0)
      all.push_back(
          {Level::warning,
           fmt::format(
               "In stage \"{}\" bond {} (particles {}, {}) is at {:.4g} of its strength at load factor "
               "{:.6g}: it would have broken. kind = \"fracture\" breaks bonds at rest.",
               s.name, r.most_used->bond.value, r.most_used->i.value, r.most_used->j.value,
               r.most_used->utilisation, r.most_used->load_factor)});
    if (s.statics->kind == StageKind::path && r.unstable.value_or(0) > 0)
      all.push_back(
          {Level::note, fmt::format("The path of stage \"{}\" ends at an unstable balance: a real body "
                                    "leaves it where stability was lost, at the limit points and "
                                    "bifurcations among the results.",
                                    s.name)});
    const auto unstable = std::count_if(r.modes.begin(), r.modes.end(),
                                        [](const NaturalMode& m) { return !m.rigid && m.omega2 < 0.0; });
    if (unstable > 0)
      all.push_back(
          {Level::warning, fmt::format("Stage \"{}\" has {} unstable mode{}: the body would leave this "
                                       "balance instead of swinging about it.",
                                       s.name, unstable, unstable == 1 ? "" : "s")});
  }
}

}  // namespace

const char* to_text(Level level) {
  switch (level) {
    case Level::error: return "error";
    case Level::warning: return "warning";
    case Level::note: return "note";
  }
  return "note";
}

Warnings warnings(const RunFacts& run) {
  Warnings all = run.files;
  add_endings(run, all);
  add_snapped(run, all);
  add_step(run, all);
  add_energy(run, all);
  add_strained(run, all);
  add_stretched(run, all);
  add_too_fast(run, all);
  add_overlapping(run, all);
  add_unstable(run, all);
  std::stable_sort(all.begin(), all.end(),
                   [](const Warning& a, const Warning& b) { return a.level < b.level; });
  return all;
}

}  // namespace vbond::page
