#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/problems.hpp"

namespace vbond {

/// Where an atom style keeps what we need, as positions in a line of the Atoms section.
struct AtomColumns {
  const char* style;
  std::size_t type, x, count;  ///< count without the three optional image flags
  std::size_t diameter = 0;    ///< 0: none; the density follows it
};

/// The columns of this style. Throws CaseError at `place`, where the case names it, for one that is not
/// known.
const AtomColumns& columns_of(const std::string& style, const SourcePlace& place);

/// The columns of the atoms in these lines of a file: of the style that the case asks for, or, if `asked` is
/// empty, of the one that the file names after "Atoms #". nullptr after a mistake, which is recorded, and if
/// there is no Atoms section.
const AtomColumns* choose_columns(const std::vector<std::string>& lines, const std::string& file,
                                  const std::string& asked, Problems& problems);

/// What a section is for; nothing for one that cannot be passed over. `write_data` writes coefficients unless
/// told not to, and lists of angles and the like for most molecules.
std::optional<std::string> use_of_passed_section(const std::string& name);

}  // namespace vbond
