#pragma once
#include <filesystem>
#include <vector>

#include "vbond/case/case.hpp"

namespace vbond::app {

/// The sub-folder of an output folder with copies of the files that its case reads.
inline constexpr const char* inputs_folder = "inputs";

/// The copies that an earlier run has left in an output folder: those that its resolved.toml names. None if
/// it has no such file, or one that cannot be read.
std::vector<std::filesystem::path> copies_in(const std::filesystem::path& folder);

/// Copies every file that the case reads into the output folder. From then on the case reads the copies,
/// since bonds of later stages are read as these begin; returned is the same case with their names relative
/// to that folder. Files of one name get numbers. `old` are copies of an earlier run: they are replaced or
/// removed; any other file keeps its place and content. Throws IoError.
Case keep_inputs(Case& c, const std::filesystem::path& folder, const std::vector<std::filesystem::path>& old);

/// Whether a case reads files with the same content as another one, whose files are copies in its folder; it
/// then has the names of these copies, relative to that folder. Throws IoError.
bool reads_the_same(Case& c, Case other);

}  // namespace vbond::app
