#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <tuple>
#include <type_traits>
#include <vector>

#include "vbond/model/body_part.hpp"
#include "vbond/observe/detail/h5_tables.hpp"

/// A checkpoint, read by one of several processes that each keep their own bonds alone.
namespace vbond {

/// Reads what read_tables() reads of a state, but only its own bonds, and of what parts of a body know of
/// particles that of some. Places are read of all: before a stage begins each process has them. Columns are
/// read some rows at a time.
class StateInPart {
 public:
  /// some: the particles that the state is to know more of than their places; null: all.
  StateInPart(H5Reader& file, FileSizes sizes, const PerBond<BondId>& names, PerParticle<double>::Some some,
              KnownLaws laws)
      : file_(file), sizes_(sizes), names_(names.values()), some_(std::move(some)), laws_(laws) {
    if (some_ != nullptr) some_->for_each([this](ParticleId p) { particles_.push_back(p); });
  }

  /// The state has the bonds as the case makes them. They get what has become of them; whether all else of
  /// them is in the file as it is here.
  template <class... Tables>
  bool read(const std::tuple<Tables...>& tables, State& state) {
    bool same = true;
    for_each_table(tables, [&]<class Table>(const Table& table) {
      auto& of = table.in(state);
      if constexpr (!is_row_table<Table>)
        for_each_field(table, [&](const auto& f) { read_field(table, f, of.*f.value); });
      else if constexpr (std::is_same_v<typename Table::Of, Bond>)
        for_each_field(table, [&](const auto& f) { same &= read_bonds(table, f, of); });
      else
        read_rows(file_, table, laws_, of);
    });
    return same;
  }

 private:
  template <class Table, class Of, class Value>
  void read_field(const Table& table, const Field<Of, Value>& f, Value& value) {
    if constexpr (is_column<Value>)
      if (f.traits.known == Known::by_owner && !is_left_out(file_, table, f) && !is_of_all(f))
        return read_owned(data_set(table, f).path, value);
    vbond::read_field(file_, table, f, sizes_, value);
  }
  template <class Of, class Value>
  bool is_of_all(const Field<Of, Value>& f) const {
    if constexpr (std::is_same_v<Value Of::*, decltype(&State::r)>)
      if (f.value == &State::r) return true;
    return is_particle_column<Value> && some_ == nullptr;
  }
  template <class T>
  void read_owned(const std::string& path, PerParticle<T>& column) {
    column.hold(some_);
    const auto at = column.begin();
    file_.visit_some<T>(path, sizes_.particles, particles_,
                        [&](std::size_t k, const T& value) { at[static_cast<std::ptrdiff_t>(k)] = value; });
  }
  template <class T>
  void read_owned(const std::string& path, PerBond<T>& column) {
    column.resize(names_.size());
    file_.visit_some<T>(path, sizes_.bonds, names_,
                        [&](std::size_t k, const T& value) { column[BondId{k}] = value; });
  }

  template <class Table, class Value, class Member>
  bool read_bonds(const Table& table, const Field<Bond, Value, Member>& f, PerBond<Bond>& bonds) {
    if (is_left_out(file_, table, f))
      return std::all_of(bonds.begin(), bonds.end(),
                         [&](const Bond& b) { return value_of(b, f.value) == value_of(Bond{}, f.value); });
    return read_member(data_set(table, f).path, bonds, f.value);
  }
  /// Whether is_same(bond, value) holds for all of its own.
  template <class T, class IsSame>
  bool compare(const std::string& path, PerBond<Bond>& bonds, IsSame is_same) {
    bool same = true;
    file_.visit_some<T>(path, sizes_.bonds, names_,
                        [&](std::size_t k, const T& value) { same &= is_same(bonds[BondId{k}], value); });
    return same;
  }
  template <class Value>
  bool read_member(const std::string& path, PerBond<Bond>& bonds, Value Bond::*member) {
    return compare<Value>(path, bonds, [member](Bond& b, const Value& value) {
      if (may_change(member)) b.*member = value;
      return b.*member == value;
    });
  }
  static bool may_change(bool Bond::*member) { return member == &Bond::broken; }
  static bool may_change(BreakMode Bond::*member) { return member == &Bond::mode; }
  template <class Value>
  static bool may_change(Value Bond::* /*member*/) {
    return false;
  }
  bool read_member(const std::string& path, PerBond<Bond>& bonds, ShortPointer<BondLaw> Bond::* /*law*/) {
    return compare<LawNumber>(path, bonds,
                              [&, laws = read_laws(file_, laws_)](const Bond& b, LawNumber number) {
                                return numbered_in(path, laws, number) == b.law;
                              });
  }
  bool read_member(const std::string& path, PerBond<Bond>& bonds, ShortPointer<BondRules> Bond::* /*rules*/) {
    return compare<RulesNumber>(path, bonds,
                                [&, rules = read_rules(file_)](const Bond& b, RulesNumber number) {
                                  return numbered_in(path, rules, number) == b.rules;
                                });
  }
  template <class Value>
  bool read_member(const std::string& path, PerBond<Bond>& bonds, RareMember<Value> member) {
    return compare<Value>(path, bonds,
                          [member](const Bond& b, const Value& value) { return member.of(b) == value; });
  }
  bool read_member(const std::string& path, PerBond<Bond>& bonds, RareMember<Quatd> /*frame_j*/) {
    return compare<Quatd>(path, bonds, [](const Bond& b, const Quatd& frame) { return frame_j(b) == frame; });
  }

  H5Reader& file_;
  FileSizes sizes_;
  const std::vector<BondId>& names_;
  PerParticle<double>::Some some_;
  std::vector<ParticleId> particles_;  // these
  KnownLaws laws_;
};

}  // namespace vbond
