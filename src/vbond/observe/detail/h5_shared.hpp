#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vbond/model/bond.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/observe/detail/h5_file.hpp"

/// What many bonds share stands once in a file, and each bond has its number: laws by name, rules by numbers.
namespace vbond {

inline constexpr const char* law_names_path = "/laws/name";
inline constexpr const char* rule_numbers_path = "/rules/numbers";
inline constexpr const char* law_names_meaning =
    "names of the bond laws, 48 bytes each, filled up with zeros";
inline constexpr const char* rule_numbers_meaning =
    "stretching, strength and damping that bonds share, in the units of the case; only where bonds have "
    "rules";

/// The laws that a file may name.
using KnownLaws = std::span<const BondLaw* const>;

/// How the number of a bond's law, and that of its rules, lie in a file.
using LawNumber = std::uint8_t;
using RulesNumber = std::uint32_t;

inline void write_laws(H5Writer& file, const std::vector<const BondLaw*>& laws) {
  file.of_each({law_names_path, unit::none, law_names_meaning}, laws,
               [](const BondLaw* law) { return law_name(law->name); });
}
inline void write_rules(H5Writer& file, const std::vector<const BondRules*>& rules) {
  file.of_each({rule_numbers_path, unit::none, rule_numbers_meaning}, rules,
               [](const BondRules* r) { return numbers_of(*r); });
}

/// Different values of a member, in the order in which rows have them, and for each row the number of its
/// own.
template <class Number, class Rows, class Row, class Shared>
std::pair<std::vector<Shared>, std::vector<Number>> numbered(const Rows& rows, Shared Row::*member) {
  std::vector<Shared> seen;
  std::vector<Number> numbers;
  for (const Row& row : rows) {
    const auto at = std::find(seen.begin(), seen.end(), row.*member);
    numbers.push_back(static_cast<Number>(at - seen.begin()));
    if (at == seen.end()) seen.push_back(row.*member);
  }
  return {seen, numbers};
}

template <class Number, class Rows, class Shared>
void give_numbered(H5Reader& file, const std::string& path, const std::vector<Shared>& shared, Rows& rows,
                   Shared Bond::*member) {
  std::vector<Number> numbers(rows.size());
  file.of_each(path, numbers, std::identity{});
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (numbers[k] >= shared.size()) throw IoError("is damaged: " + path + " names what is not there");
    rows[k].*member = shared[numbers[k]];
  }
}

// ---- columns of rows ----------------------------------------------------------------------------------

template <class Rows, class Row, class Value>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows, Value Row::*member) {
  file.of_each(set, rows, member);
}
template <class Rows>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows, const BondLaw* Bond::*member) {
  const auto [laws, numbers] = numbered<LawNumber>(rows, member);
  write_laws(file, laws);
  file.of_each(set, numbers, std::identity{});
}
template <class Rows>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows, const BondRules* Bond::*member) {
  const auto [rules, numbers] = numbered<RulesNumber>(rows, member);
  write_rules(file, rules);
  file.of_each(set, numbers, std::identity{});
}

/// A frame in the body of j is in files also where it is that of i.
template <class Rows>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows, Boxed<Quatd> Bond::* /*frame_j*/) {
  file.of_each(set, rows, [](const Bond& b) { return frame_j(b); });
}

template <class Rows, class Row, class Value>
void read_column(H5Reader& file, const std::string& path, KnownLaws, Rows& rows, Value Row::*member) {
  file.of_each(path, rows, member);
}
template <class Rows>
void read_column(H5Reader& file, const std::string& path, KnownLaws known, Rows& rows,
                 const BondLaw* Bond::*member) {
  std::vector<LawName> names(file.rows(law_names_path));
  file.of_each(law_names_path, names, std::identity{});
  std::vector<const BondLaw*> laws;
  for (const LawName& name : names) {
    laws.push_back(find_law(text_of(name), known));
    if (laws.back() == nullptr)
      throw IoError(fmt::format("has bonds of a law \"{}\" that this program does not know", text_of(name)));
  }
  give_numbered<LawNumber>(file, path, laws, rows, member);
}
template <class Rows>
void read_column(H5Reader& file, const std::string& path, KnownLaws, Rows& rows,
                 const BondRules* Bond::*member) {
  std::vector<RuleNumbers> numbers(file.rows(rule_numbers_path));
  file.of_each(rule_numbers_path, numbers, std::identity{});
  std::vector<const BondRules*> rules;
  for (const RuleNumbers& row : numbers) {
    const std::optional<BondRules> read = rules_of(row);
    if (!read) throw IoError("is damaged: rules of bonds that cannot be");
    rules.push_back(&kept(*read));
  }
  give_numbered<RulesNumber>(file, path, rules, rows, member);
}
/// After those in the body of i.
template <class Rows>
void read_column(H5Reader& file, const std::string& path, KnownLaws, Rows& rows,
                 Boxed<Quatd> Bond::* /*frame_j*/) {
  std::vector<Quatd> frames(rows.size());
  file.of_each(path, frames, std::identity{});
  for (std::size_t k = 0; k < frames.size(); ++k) set_frames(rows[k], rows[k].frame_i, frames[k]);
}

}  // namespace vbond
