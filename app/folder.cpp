#include "folder.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "inputs.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/frame_names.hpp"
#include "vbond/observe/mode_frames.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const char* what, const fs::path& path, const std::error_code& e) {
  throw IoError(std::string("cannot ") + what + " " + path.string() + ": " + e.message());
}

bool is_present(const fs::path& path) {
  std::error_code e;
  const fs::file_status status = fs::symlink_status(path, e);
  if (status.type() == fs::file_type::none) fail("look at", path, e);
  return fs::exists(status);
}

void take_away(const fs::path& path) {
  std::error_code e;
  fs::remove(path, e);
  if (e) fail("remove", path, e);
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::error_code e;
  std::vector<fs::path> paths;
  for (fs::directory_iterator at(folder, e), end; !e && at != end; at.increment(e))
    paths.push_back(at->path());
  if (e) fail("read", folder, e);
  return paths;
}

void take_away_if_empty(const fs::path& folder) {
  std::error_code e;
  if (fs::is_directory(folder, e) && entries(folder).empty()) take_away(folder);
}

/// Lists of frames go before the frames that they name.
void remove_output(const fs::path& folder) {
  const FolderLock nobody_reports(folder, report_lock);
  for (const char* name : {"history.csv",     "history.columns.json",
                           "breaks.csv",      "breaks.columns.json",
                           "fragments.csv",   "fragments.columns.json",
                           "fracture.csv",    "dispersion.csv",
                           "run.json",        "status.json",
                           "resolved.toml",   "checkpoint.h5",
                           "particles.pvd",   "bonds.pvd",
                           "walls.pvd",       "contacts.pvd",
                           "cell.pvd",        "dump.lammpstrj",
                           "last_balance.h5", "report.html",
                           "report.png"}) {
    take_away(folder / name);
    take_away(temporary_name(folder / name));
  }
  std::error_code e;
  if (fs::is_directory(folder / "frames", e))
    for (const fs::path& path : entries(folder / "frames"))
      if (step_of_frame(path.filename().string())) take_away(path);
  remove_mode_frames(folder);
  for (const char* name : {"frames", "modes"}) take_away_if_empty(folder / name);
}

/// What a crashed run leaves of its locks does not count.
bool is_occupied(const fs::path& folder) {
  const std::vector<fs::path> all = entries(folder);
  return std::any_of(all.begin(), all.end(), [](const fs::path& path) {
    return path.filename() != run_lock && path.filename() != report_lock;
  });
}

[[noreturn]] void refuse_occupied(const fs::path& folder) {
  throw CaseError({{},
                   folder.string() + " already exists and is not empty",
                   "an earlier output is never overwritten by itself",
                   "choose another folder with -o, or replace this one with --force"});
}

fs::path first_free(const std::string& stem) {
  for (int k = 1;; ++k) {
    const fs::path folder = stem + (k == 1 ? "" : "-" + std::to_string(k)) + ".out";
    if (is_present(folder)) continue;
    std::error_code e;
    if (fs::create_directory(folder, e)) return folder;  // not so if another run was faster
    if (e) fail("make the folder", folder, e);
  }
}

}  // namespace

ClaimedFolder claim_folder(const fs::path& case_file, const std::optional<fs::path>& wish, bool force) {
  if (!wish && !force) {
    const fs::path folder = first_free(case_file.stem().string());
    return {folder, FolderLock(folder, run_lock), {}};
  }
  fs::path folder = wish.value_or(case_file.stem().string() + ".out");
  if (is_present(folder)) {
    std::error_code e;
    if (!fs::is_directory(folder, e))
      throw IoError(folder.string() + ": is not a folder, so a run cannot write into it");
    if (!force && is_occupied(folder)) {  // looked at before anything is written there
      require_free(folder, run_lock);
      refuse_occupied(folder);
    }
  }
  make_folder(folder);
  FolderLock lock(folder, run_lock);
  if (!force && is_occupied(folder)) refuse_occupied(folder);  // another run was faster, and has ended
  std::vector<fs::path> old_inputs = copies_in(folder);
  if (force) remove_output(folder);
  return {std::move(folder), std::move(lock), std::move(old_inputs)};
}

}  // namespace vbond::app
