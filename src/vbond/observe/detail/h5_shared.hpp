#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vbond/model/bond.hpp"
#include "vbond/model/field_table.hpp"
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

/// A member of what is boxed in few bonds.
template <class Value>
using RareMember = MemberOfFew<Bond, RareOfBond, Value>;

/// How the number of a bond's law, and that of its rules, lie in a file.
using LawNumber = std::uint8_t;
using RulesNumber = std::uint32_t;

inline void write_laws(H5Writer& file, const std::vector<ShortPointer<BondLaw>>& laws) {
  file.of_each({law_names_path, unit::none, law_names_meaning}, laws,
               [](const BondLaw* law) { return law_name(law->name); });
}
inline void write_rules(H5Writer& file, const std::vector<ShortPointer<BondRules>>& rules) {
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

/// The one that has this number in a file.
template <class Shared>
const Shared& numbered_in(const std::string& path, const std::vector<Shared>& shared, std::size_t number) {
  if (number >= shared.size()) throw IoError("is damaged: " + path + " names what is not there");
  return shared[number];
}

// ---- columns of rows ----------------------------------------------------------------------------------

template <class Rows, class Row, class Value>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows, Value Row::*member) {
  file.of_each(set, rows, member);
}
template <class Rows>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows, ShortPointer<BondLaw> Bond::*member) {
  const auto [laws, numbers] = numbered<LawNumber>(rows, member);
  write_laws(file, laws);
  file.of_each(set, numbers, std::identity{});
}
template <class Rows>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows,
                  ShortPointer<BondRules> Bond::*member) {
  const auto [rules, numbers] = numbered<RulesNumber>(rows, member);
  write_rules(file, rules);
  file.of_each(set, numbers, std::identity{});
}

template <class Rows, class Value>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows, RareMember<Value> member) {
  file.of_each(set, rows, [member](const Bond& b) { return member.of(b); });
}
/// A frame in the body of j is in files also where it is that of i.
template <class Rows>
void write_column(H5Writer& file, const DataSet& set, const Rows& rows, RareMember<Quatd> /*frame_j*/) {
  file.of_each(set, rows, [](const Bond& b) { return frame_j(b); });
}

template <class Rows, class Row, class Value>
void read_column(H5Reader& file, const std::string& path, KnownLaws, Rows& rows, Value Row::*member) {
  file.of_each(path, rows, member);
}
inline std::vector<ShortPointer<BondLaw>> read_laws(H5Reader& file, KnownLaws known) {
  std::vector<ShortPointer<BondLaw>> laws;
  file.visit_rows<LawName>(law_names_path, file.rows(law_names_path), [&](std::size_t, const LawName& name) {
    laws.push_back(find_law(text_of(name), known));
    if (laws.back() == nullptr)
      throw IoError(fmt::format("has bonds of a law \"{}\" that this program does not know", text_of(name)));
  });
  return laws;
}
inline std::vector<ShortPointer<BondRules>> read_rules(H5Reader& file) {
  std::vector<ShortPointer<BondRules>> rules;
  file.visit_rows<RuleNumbers>(rule_numbers_path, file.rows(rule_numbers_path),
                               [&](std::size_t, const RuleNumbers& numbers) {
                                 const std::optional<BondRules> read = rules_of(numbers);
                                 if (!read) throw IoError("is damaged: rules of bonds that cannot be");
                                 rules.push_back(&kept(*read));
                               });
  return rules;
}
template <class Rows>
void read_column(H5Reader& file, const std::string& path, KnownLaws known, Rows& rows,
                 ShortPointer<BondLaw> Bond::*member) {
  const auto laws = read_laws(file, known);
  file.visit_rows<LawNumber>(path, rows.size(), [&](std::size_t k, LawNumber number) {
    rows[k].*member = numbered_in(path, laws, number);
  });
}
template <class Rows>
void read_column(H5Reader& file, const std::string& path, KnownLaws, Rows& rows,
                 ShortPointer<BondRules> Bond::*member) {
  const auto rules = read_rules(file);
  file.visit_rows<RulesNumber>(path, rows.size(), [&](std::size_t k, RulesNumber number) {
    rows[k].*member = numbered_in(path, rules, number);
  });
}
template <class Rows, class Value>
void read_column(H5Reader& file, const std::string& path, KnownLaws, Rows& rows, RareMember<Value> member) {
  file.visit_rows<Value>(path, rows.size(),
                         [&](std::size_t k, const Value& value) { member.set(rows[k], value); });
}
/// After those in the body of i.
template <class Rows>
void read_column(H5Reader& file, const std::string& path, KnownLaws, Rows& rows,
                 RareMember<Quatd> /*frame_j*/) {
  file.visit_rows<Quatd>(path, rows.size(), [&](std::size_t k, const Quatd& frame) {
    set_frames(rows[k], rows[k].frame_i, frame);
  });
}

}  // namespace vbond
