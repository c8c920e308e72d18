#include "report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <numbers>
#include <system_error>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "lock.hpp"
#include "shell.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/mode_frames.hpp"
#include "vbond/observe/page/fit.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code e;
  return fs::exists(path, e);
}

/// Where the template may stand: named by the user, installed, or in the build tree.
std::vector<fs::path> template_places() {
  if (const char* named = std::getenv("VBOND_PAGE"); named && *named) return {named};
  std::error_code e;
  const fs::path folder = fs::read_symlink("/proc/self/exe", e).parent_path();
  if (e) return {};
  return {folder.parent_path() / "share/vbond/report.html", folder.parent_path() / "page/report.html"};
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
std::vector<page::SequenceFiles> sequence_files(const fs::path& folder, const Case& c,
                                                const std::optional<RunSummary>& summary) {
  std::vector<page::SequenceFiles> all;
  if (is_there(folder / "particles.pvd") && is_there(folder / "bonds.pvd")) {
    page::SequenceFiles run{page::SequenceKind::run, "Run", "", "",
                            page::listed_frames(folder / "particles.pvd", folder / "bonds.pvd")};
    if (is_there(folder / "walls.pvd")) page::add_walls(run.frames, folder / "walls.pvd");
    if (is_there(folder / "contacts.pvd")) page::add_contacts(run.frames, folder / "contacts.pvd");
    if (!run.frames.empty()) all.push_back(std::move(run));
  }
  const std::vector<ListedMode> modes = list_modes(folder);
  for (const StageSpec& stage : c.stages)
    for (const ListedMode& mode : modes) {
      if (mode.stage != stage.name || !is_there(mode.bonds)) continue;
      const char* kind = stage.kind == StageKind::buckling ? "Buckling mode" : "Mode";
      all.push_back({page::SequenceKind::mode,
                     fmt::format("{} {} of stage \"{}\"", kind, mode.number, mode.stage),
                     summary ? note_of(mode, *summary) : std::string(), mode.stage,
                     page::listed_frames(mode.particles, mode.bonds)});
    }
  return all;
}

/// Modes that were the last thing asked for are what the reader looks for, else the run.
std::size_t shown_first(const std::vector<page::SequenceFiles>& all, const StageSpec& last) {
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
std::vector<page::Warning> add_sequences(const fs::path& folder, const Case& c,
                                         const std::optional<RunSummary>& summary, page::Report& r) {
  std::vector<page::SequenceFiles> files = sequence_files(folder, c, summary);
  const bool any_listed = !files.empty();
  std::vector<page::Warning> trouble = page::drop_unreadable_ends(files);
  const bool any_readable = !files.empty();
  page::fit_frames(files, page::PageLimits{}, r.left_out);
  r.first_shown = shown_first(files, c.stages.back());
  for (const page::SequenceFiles& s : files) r.sequences.push_back(page::read_sequence(s, r.body));
  if (files.empty()) r.no_frames = why_no_frames(c, any_listed, any_readable);
  if (!files.empty() && files[0].kind == page::SequenceKind::run)
    for (const page::FrameFiles& f : files[0].frames)
      r.stage_of_frame.push_back(stage_at(f.time, c, summary));
  for (const page::Sequence& s : r.sequences)
    if (s.walls.left_out > 0)
      r.left_out.push_back(
          fmt::format("The walls: their {} triangles are too many for a page, which shows {}. "
                      "ParaView shows them.",
                      s.walls.left_out, page::most_wall_triangles));
  if (r.body.bonds_without_length > 0)
    r.left_out.push_back(
        fmt::format("{} of the bonds have no length at rest: their elongation relative to it is shown as 0.",
                    r.body.bonds_without_length));
  return trouble;
}

void require_output(const fs::path& folder) {
  if (!is_there(folder / "resolved.toml"))
    throw IoError(folder.string() + ": is not an output folder of vbond run: it has no resolved.toml");
}

/// All that the page of a run shows; live: see live_report. Throws as write_report does.
page::Report report_of(const fs::path& folder, std::optional<std::string> live) {
  require_output(folder);
  const Case c = read_case(folder / "resolved.toml");
  const Built built = build(c);
  std::optional<RunSummary> summary;
  if (is_there(folder / "run.json")) summary = read_summary(folder / "run.json");

  page::Report r;
  r.program = "vbond " + (summary ? summary->version : std::string(VBOND_VERSION));
  r.title = c.title;
  r.units = c.units;
  r.command = "vbond run resolved.toml";
  CaseOfPage of_page = case_of_page(c, folder / "resolved.toml");
  r.case_text = std::move(of_page.text);
  if (!of_page.left_out.empty()) r.left_out.push_back(std::move(of_page.left_out));
  if (is_there(folder / "history.csv")) r.history = page::read_history(folder / "history.csv");
  if (is_there(folder / "breaks.csv")) r.breaks = read_breaks(folder / "breaks.csv", page::listed_breaks);
  std::vector<page::Warning> trouble = add_sequences(folder, c, summary, r);
  for (page::Warning& w : trouble) w.text = without_folder(std::move(w.text), folder);
  const page::StepFacts step = step_of(c, built, summary);
  r.facts = facts_of(c, built, summary, step);
  r.stages = holds_of(c, built.model);
  if (summary) r.results = results_of(*summary);
  r.warnings = page::warnings(
      {.summary = summary,
       .history = r.history,
       .body = r.body,
       .units = c.units,
       .stages = c.stages.size(),
       .resume_command = "vbond resume " + shell_word(fs::canonical(folder).filename().string()),
       .step = step,
       .files = trouble,
       .live = live.has_value()});
  r.live = std::move(live);
  return r;
}

}  // namespace

std::string page_template() {
  std::string looked;
  for (const fs::path& place : template_places()) {
    if (is_there(place)) return read_all(place);
    looked += "\n  looked for " + place.string();
  }
  throw IoError(
      "the report page was not built with this program" + looked +
      "\n  install nodejs and npm, then ./run builds it into build/page; or name one by VBOND_PAGE");
}

void require_page() {
  page_template();
}

Written write_report(const fs::path& folder) {
  const std::string html = page_template();
  require_output(folder);
  const FolderLock lock(folder, report_lock);
  const page::Report r = report_of(folder, {});
  replace_file(folder / "report.html", page::report_page(html, r, {}), Sync::none);
  return {folder / "report.html", r.no_frames};
}

std::string live_report(const fs::path& folder, const std::string& version) {
  const std::string html = page_template();
  return page::report_page(html, report_of(folder, version), {});
}

int report(const fs::path& folder) {
  say("report in " + write_report(folder).page.string() + "\n");
  return done;
}

}  // namespace vbond::app
