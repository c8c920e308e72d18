#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "lock.hpp"

namespace vbond::app {

/// The folder of a run, and the lock that keeps other runs out of it.
struct ClaimedFolder {
  std::filesystem::path path;
  FolderLock lock;
  std::vector<std::filesystem::path> old_inputs;  ///< copies of inputs that an earlier run has left
};

/// Makes the folder of a new run, or takes an old one. Without a wish it is CASE.out in the current folder,
/// or the first free one of CASE-2.out, CASE-3.out, ...; a wished one must be new or empty. With force the
/// wished folder, or CASE.out, is cleared of what a run writes; anything else in it stays. Copies of inputs
/// stay as well, since the new run may read them: see keep_inputs. Throws CaseError for an occupied folder,
/// IoError if files are in the way or another process uses it.
ClaimedFolder claim_folder(const std::filesystem::path& case_file,
                           const std::optional<std::filesystem::path>& wish, bool force);

}  // namespace vbond::app
