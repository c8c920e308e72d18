#pragma once
#include <filesystem>
#include <string>

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

}  // namespace vbond::app
