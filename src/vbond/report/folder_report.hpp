#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "vbond/report/page.hpp"

namespace vbond::page {

/// What the page of a run says that its output folder does not.
struct FolderReport {
  std::string version;         ///< of this program, where no stage has ended: run.json has that of the run
  std::string resume_command;  ///< how to go on with a run that was stopped
  std::optional<std::string> live;  ///< the page follows the run: see Report
};

/// Throws IoError if this is not an output folder.
void require_output(const std::filesystem::path& folder);

/// All that the page of a run shows, read from its output folder. Throws IoError; CaseError if resolved.toml
/// was edited into something wrong.
Report report_of(const std::filesystem::path& folder, FolderReport asked);

}  // namespace vbond::page
