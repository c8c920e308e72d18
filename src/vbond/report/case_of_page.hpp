#pragma once
#include <filesystem>
#include <string>

#include "vbond/case/case.hpp"

namespace vbond::page {

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

}  // namespace vbond::page
