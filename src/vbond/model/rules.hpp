#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "vbond/physics/bond_rules.hpp"

namespace vbond {

/// The same rules, kept for as long as the program runs: bonds point to them. Equal rules are one object.
const BondRules& kept(const BondRules& rules);

/// Rules as a row of numbers, for files: names of forms and criteria by their place, then parameters.
inline constexpr std::size_t rule_numbers = 40 + 3 * StretchTable::most;
using RuleNumbers = std::array<double, rule_numbers>;
RuleNumbers numbers_of(const BondRules& rules);
/// Nothing if these are numbers of no rules.
std::optional<BondRules> rules_of(const RuleNumbers& numbers);

}  // namespace vbond
