#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "vbond/model/bond.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// What the bonds of a list share.
struct BondKind {
  const BondLaw* law = &bond_law<VModel>;  ///< never null
  const BondRules* rules = &no_rules;      ///< never null

  friend bool operator==(const BondKind&, const BondKind&) = default;
};

/// Unbroken bonds as a text file for other programs. The first line is "vbond bonds 1"; then a line per kind,
/// "kind NUMBER LAW" and the numbers of its rules (model/rules.hpp); then a line per bond: its particles and
/// its kind, all counted from 1, a, R_i, R_j, the frames of both ends (w x y z each) and the coefficients in
/// the order of the law's fields.
struct BondList {
  std::vector<BondKind> kinds;
  std::vector<Bond> bonds;
  std::vector<std::uint32_t> kind;  ///< of each bond, in kinds
};

/// The unbroken bonds of a body. Each particle counts as not turned: its orientation goes into the frames.
BondList bond_list(const State& state);

std::string to_text(const BondList& list);

/// Throws IoError, with path and line, for a text that is no such list.
BondList read_bond_list(const std::filesystem::path& path);

}  // namespace vbond
