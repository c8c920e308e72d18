#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/build/build.hpp"
#include "vbond/case/case.hpp"
#include "vbond/observe/page/page.hpp"
#include "vbond/observe/summary.hpp"

namespace vbond::app {

struct Written {
  std::filesystem::path page;
  std::string no_frames;  ///< why the page shows no body; empty if it does
};

/// Writes report.html into the folder of a run. Throws IoError, also if the page was not
/// built with the program; CaseError if resolved.toml was edited into something wrong.
Written write_report(const std::filesystem::path& folder);

/// The page of a run that goes on, for a server that this page asks for newer data: version says which these
/// are. Throws as write_report does.
std::string live_report(const std::filesystem::path& folder, const std::string& version);

/// The page without a run in it. Throws IoError as require_page.
std::string page_template();

/// Throws IoError with what to install if the page was not built with the program.
void require_page();

/// The run in rows for people: what was run, and what came out.
page::Lines facts_of(const Case& c, const Built& built, const std::optional<RunSummary>& summary,
                     const page::StepFacts& step);
page::Lines results_of(const RunSummary& summary);

/// What each stage of the case holds and loads; stages that do neither are left out.
std::vector<page::StageHolds> holds_of(const Case& c, const Model& model);

/// The step of the first stage of dynamics, as far as it is known.
page::StepFacts step_of(const Case& c, const Built& built, const std::optional<RunSummary>& summary);

/// A case as its page shows it, which tells nothing of the machine it was run on.
struct CaseOfPage {
  std::string text;
  std::string left_out;  ///< what it tells no more; empty if it is the file itself
};

/// The text of resolved.toml, or, where it names files, the case with their names in its folder, or their
/// names alone. Throws IoError.
CaseOfPage case_of_page(Case c, const std::filesystem::path& resolved);

/// A text in which files of this folder are named without it.
std::string without_folder(std::string text, const std::filesystem::path& folder);

}  // namespace vbond::app
