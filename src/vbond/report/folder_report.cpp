#include "vbond/report/folder_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <system_error>
#include <utility>
#include <vector>

#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/mode_frames.hpp"
#include "vbond/observe/summary.hpp"
#include "vbond/report/case_of_page.hpp"
#include "vbond/report/facts.hpp"
#include "vbond/report/fit_frames.hpp"
#include "vbond/report/stage_holds.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::page {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code e;
  return fs::exists(path, e);
}

/// The stage that a time of the run lies in: the first that has not ended before it.
std::string stage_at(double time, const Case& c, const std::optional<RunSummary>& summary) {
  std::size_t k = 0;
  if (summary)
    while (k < summary->stages.size() && time > summary->stages[k].time) ++k;
  return c.stages[std::min(k, c.stages.size() - 1)].name;
}

std::string reaction_of(const CriticalLoad& c) {
  return c.reaction ? fmt::format(", displacement {:.6g}, reaction {:.6g}", *c.displacement, *c.reaction)
                    : "";
}

std::string note_of(const ListedMode& mode, const RunSummary& summary) {
  const bool si = summary.units == UnitSystem::si;
  for (const StageSummary& s : summary.stages) {
    if (s.name != mode.stage || !s.statics) continue;
    const StaticResult& r = s.statics->result;
    const auto k = static_cast<std::size_t>(mode.number - 1);
    if (k < r.critical_loads.size() && r.critical_loads[k].force != 0.0)
      return fmt::format("critical force {:.6g}{}, load factor {:.6g}", r.critical_loads[k].force,
                         si ? " N" : "", r.critical_loads[k].load_factor);
    if (k < r.critical_loads.size())
      return fmt::format("critical load factor {:.6g}{}", r.critical_loads[k].load_factor,
                         reaction_of(r.critical_loads[k]));
    if (k < r.modes.size() && r.modes[k].omega2 < 0.0) return "unstable: the body would leave this balance";
    if (k < r.modes.size())
      return fmt::format("frequency {:.6g}{}", r.modes[k].omega / (2.0 * std::numbers::pi), si ? " Hz" : "");
  }
  return {};
}

/// The run's frames first, then the modes in the order of the stages.
std::vector<SequenceFiles> sequence_files(const fs::path& folder, const Case& c,
                                          const std::optional<RunSummary>& summary) {
  std::vector<SequenceFiles> all;
  if (is_there(folder / "particles.pvd") && is_there(folder / "bonds.pvd")) {
    SequenceFiles run{SequenceKind::run, "Run", "", "",
                      listed_frames(folder / "particles.pvd", folder / "bonds.pvd")};
    if (is_there(folder / "walls.pvd")) add_walls(run.frames, folder / "walls.pvd");
    if (is_there(folder / "contacts.pvd")) add_contacts(run.frames, folder / "contacts.pvd");
    if (!run.frames.empty()) all.push_back(std::move(run));
  }
  const std::vector<ListedMode> modes = list_modes(folder);
  for (const StageSpec& stage : c.stages)
    for (const ListedMode& mode : modes) {
      if (mode.stage != stage.name || !is_there(mode.bonds)) continue;
      const char* kind = stage.kind == StageKind::buckling ? "Buckling mode" : "Mode";
      all.push_back({SequenceKind::mode, fmt::format("{} {} of stage \"{}\"", kind, mode.number, mode.stage),
                     summary ? note_of(mode, *summary) : std::string(), mode.stage,
                     listed_frames(mode.particles, mode.bonds)});
    }
  return all;
}

/// Modes that were the last thing asked for are what the reader looks for, else the run.
std::size_t shown_first(const std::vector<SequenceFiles>& all, const StageSpec& last) {
  const auto first =
      std::find_if(all.begin(), all.end(), [&last](const auto& s) { return s.stage == last.name; });
  return first == all.end() ? 0 : static_cast<std::size_t>(first - all.begin());
}

/// Why no sequence is left: of those that the folder lists, and those of them that can be read.
std::string why_no_frames(const Case& c, bool any_listed, bool any_readable) {
  if (any_readable) return "Not one of the modes fits into the page.";
  if (any_listed) return "None of the frames in the folder can be read: see the warnings.";
  if (!c.output.frames)
    return "The case asks for no frames, so the body is not shown. Give output.frames to have them.";
  return "The folder has no frames: the run has not written any yet, or they were not copied with it.";
}

/// Returns what is wrong with the files.
std::vector<Warning> add_sequences(const fs::path& folder, const Case& c,
                                   const std::optional<RunSummary>& summary, Report& r) {
  std::vector<SequenceFiles> files = sequence_files(folder, c, summary);
  const bool any_listed = !files.empty();
  std::vector<Warning> trouble = drop_unreadable_ends(files);
  const bool any_readable = !files.empty();
  fit_frames(files, PageLimits{}, r.left_out);
  r.first_shown = shown_first(files, c.stages.back());
  for (const SequenceFiles& s : files) r.sequences.push_back(read_sequence(s, r.body));
  if (files.empty()) r.no_frames = why_no_frames(c, any_listed, any_readable);
  if (!files.empty() && files[0].kind == SequenceKind::run)
    for (const FrameFiles& f : files[0].frames) r.stage_of_frame.push_back(stage_at(f.time, c, summary));
  for (const Sequence& s : r.sequences)
    if (s.walls.left_out > 0)
      r.left_out.push_back(
          fmt::format("The walls: their {} triangles are too many for a page, which shows {}. "
                      "ParaView shows them.",
                      s.walls.left_out, most_wall_triangles));
  if (r.body.bonds_without_length > 0)
    r.left_out.push_back(
        fmt::format("{} of the bonds have no length at rest: their elongation relative to it is shown as 0.",
                    r.body.bonds_without_length));
  return trouble;
}

}  // namespace

void require_output(const fs::path& folder) {
  if (!is_there(folder / "resolved.toml"))
    throw IoError(folder.string() + ": is not an output folder of vbond run: it has no resolved.toml");
}

Report report_of(const fs::path& folder, FolderReport asked) {
  require_output(folder);
  const Case c = read_case(folder / "resolved.toml");
  const Built built = build(c);
  std::optional<RunSummary> summary;
  if (is_there(folder / "run.json")) summary = read_summary(folder / "run.json");

  Report r;
  r.program = "vbond " + (summary ? summary->version : asked.version);
  r.title = c.title;
  r.units = c.units;
  r.command = "vbond run resolved.toml";
  CaseOfPage of_page = case_of_page(c, folder / "resolved.toml");
  r.case_text = std::move(of_page.text);
  if (!of_page.left_out.empty()) r.left_out.push_back(std::move(of_page.left_out));
  if (is_there(folder / "history.csv")) r.history = read_history(folder / "history.csv");
  if (is_there(folder / "breaks.csv")) {
    r.breaks = read_breaks(folder / "breaks.csv", listed_breaks);
    find_load_factors(r.breaks, c, folder);
  }
  std::vector<Warning> trouble = add_sequences(folder, c, summary, r);
  for (Warning& w : trouble) w.text = without_folder(std::move(w.text), folder);
  const StepFacts step = step_of(c, built, summary);
  r.facts = facts_of(c, built, summary, step);
  r.stages = holds_of(c, built.model);
  if (summary) r.results = results_of(*summary);
  r.warnings = warnings({.summary = summary,
                         .history = r.history,
                         .body = r.body,
                         .units = c.units,
                         .stages = c.stages.size(),
                         .resume_command = std::move(asked.resume_command),
                         .step = step,
                         .files = trouble,
                         .live = asked.live.has_value()});
  r.live = std::move(asked.live);
  return r;
}

}  // namespace vbond::page
