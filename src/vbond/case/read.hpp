#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/case/case.hpp"

namespace vbond {

/// Reads and checks a case file.
/// "-" is the standard input. changes: keys with other values than in the file, each as "PATH=VALUE", see
/// change.hpp.
/// Throws CaseError with every mistake of the file at once; IoError if it cannot be read.
Case read_case(const std::filesystem::path& file, const std::vector<std::string>& changes = {});

/// What becomes of a change that sets a key, or a part of it, which an earlier change has set. On a command
/// line it is a mistake; a program may change a case again and again.
enum class SetTwice : std::uint8_t { refused, last_wins };

/// The same from text; `file` is used in messages and to resolve relative paths.
Case parse_case(std::string_view text, const std::filesystem::path& file,
                const std::vector<std::string>& changes = {}, SetTwice twice = SetTwice::refused);

/// The case with every default written out, as TOML that read_case accepts and that means the same
/// bit for bit (numbers with 17 digits, times in T0 kept as such, file names as they stand in the Case:
/// absolute after reading).
std::string to_toml(const Case& c);

/// Where the case names the files that it reads: every key whose value is a file name, in order of the keys.
std::vector<std::filesystem::path*> files_of(Case& c);

/// The reference of all keys as Markdown, from the same table that validates them.
std::string key_reference();

/// One key or table of the reference.
struct KeyEntry {
  std::string path;          ///< as in stage.supports.fix; names of tables are left out, as in groups.box
  std::string type;          ///< of its value
  std::string default_text;  ///< "required", the default, or empty
  std::string meaning;
  std::string condition;  ///< the choice that it belongs to, as in kind = "rod"; empty: any
};
/// All keys, in the order of the reference.
std::vector<KeyEntry> list_keys();

/// A JSON Schema (draft 07) of case files, from the same table: for completion and first checks in an editor.
/// What it refuses read_case refuses as well, not the other way round.
std::string case_schema();

}  // namespace vbond
