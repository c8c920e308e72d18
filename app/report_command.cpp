#include "report_command.hpp"

#include <cstdlib>
#include <system_error>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "lock.hpp"
#include "shell.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/report/folder_report.hpp"

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

/// live: see live_report.
page::Report report_of(const fs::path& folder, std::optional<std::string> live) {
  page::require_output(folder);
  return page::report_of(
      folder, {.version = VBOND_VERSION,
               .resume_command = "vbond resume " + shell_word(fs::canonical(folder).filename().string()),
               .live = std::move(live)});
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
  page::require_output(folder);
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
