#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "vbond/core/boxed.hpp"
#include "vbond/core/column.hpp"
#include "vbond/core/members.hpp"
#include "vbond/model/units.hpp"

/// How what changes in a run is declared: tables of fields. A table is made for one struct, the whole: what
/// it says of it is what files, reports, sizes and parts of a body follow from. The one of State is
/// state_table.hpp, that of the watch observe/detail/watch_table.hpp.
namespace vbond {

/// Which part of a body knows a field, where parts are stepped by several processes.
enum class Known : std::uint8_t {
  everywhere,  ///< all parts, and they agree
  collected,   ///< as everywhere, once State has been collected from what the steps are made of
  by_owner,    ///< of a particle, the part that moves it; of a bond, that of its first particle
  listed,      ///< each part lists its own; those of the body follow in the order of place_of()
  summed,      ///< the body has the sum of all parts
};

/// When a field is again as in a new body.
enum class Anew : std::uint8_t {
  never,
  stage,      ///< as a stage of dynamics begins
  at_rest,    ///< as a stage begins in which the body is at rest
  any_stage,  ///< as a stage of either kind begins
};

/// Whether files always have a field.
enum class Filed : std::uint8_t {
  always,
  where_any,  ///< not where it is empty, or as in a new body everywhere
};

struct FieldTraits {
  Known known = Known::everywhere;
  Anew anew = Anew::never;
  Filed filed = Filed::always;
  const char* word = nullptr;  ///< the name of its array in Python, if it has one
};

/// A member of what few of many rows have, boxed in a member of theirs: see Boxed.
template <class Of, class Few, class Value>
struct MemberOfFew {
  static constexpr std::size_t members = member_count<Few>();
  static constexpr Few as_new{};
  Boxed<Few> Of::*box;
  Value Few::*member;

  const Value& of(const Of& row) const {
    const Few& few = row.*box ? *(row.*box) : as_new;  // (... ? ... : ...).*member copies, in GCC 12
    return few.*member;
  }
  void set(Of& row, const Value& value) const { set_of_few(row.*box, member, value); }
};

/// A member of Of: its name in files, unit and meaning.
template <class Of, class Value, class Member = Value Of::*>
struct Field {
  const char* name;
  Member value;
  Unit unit;
  const char* meaning;
  FieldTraits traits;
};
template <class Of, class Value>
constexpr Field<Of, Value> field(const char* name, Value Of::*value, Unit unit, const char* meaning,
                                 FieldTraits traits = {}) {
  return {name, value, unit, meaning, traits};
}
template <class Of, class Few, class Value>
constexpr Field<Of, Value, MemberOfFew<Of, Few, Value>> field(const char* name,
                                                              MemberOfFew<Of, Few, Value> value, Unit unit,
                                                              const char* meaning, FieldTraits traits = {}) {
  return {name, value, unit, meaning, traits};
}

template <class T>
inline constexpr bool is_of_few = false;
template <class... T>
inline constexpr bool is_of_few<MemberOfFew<T...>> = true;

/// The value of a field of a row.
template <class Of, class Value>
const Value& value_of(const Of& row, Value Of::*member) {
  return row.*member;
}
template <class Of, class Few, class Value>
const Value& value_of(const Of& row, const MemberOfFew<Of, Few, Value>& member) {
  return member.of(row);
}

/// Fields of Whole itself, or of one of its members: single values, or columns of particles and bonds.
template <class Struct, class Place, class... Values>
struct FieldTable {
  using Of = Struct;
  const char* path;  ///< in front of the names
  Place place;       ///< a pointer to the member; std::identity: the whole itself
  std::tuple<Field<Of, Values>...> fields;

  template <class Whole>
  constexpr auto& in(Whole& whole) const {
    return std::invoke(place, whole);
  }
};
template <class Of, class... Values>
constexpr FieldTable<Of, std::identity, Values...> fields_of(const char* path, Field<Of, Values>... fields) {
  return {path, {}, {fields...}};
}
template <class Whole, class Of, class... Values>
constexpr FieldTable<Of, Of Whole::*, Values...> fields_of(const char* path, Of Whole::*member,
                                                           Field<Of, Values>... fields) {
  return {path, member, {fields...}};
}

/// Rows: a member of Whole that holds any number of structs. Its traits are those of all its fields.
template <class Whole, class Container, class Row, class... Fields>
struct RowTable {
  using Of = Row;
  const char* path;
  Container Whole::*member;
  FieldTraits traits;
  std::tuple<Fields...> fields;

  template <class W>
  constexpr auto& in(W& whole) const {
    return whole.*member;
  }
};
template <class Whole, class Container, class Row, class... Values, class... Members>
constexpr RowTable<Whole, Container, Row, Field<Row, Values, Members>...> rows_of(
    const char* path, Container Whole::*member, FieldTraits traits, Field<Row, Values, Members>... fields) {
  return {path, member, traits, {fields...}};
}

template <class Table, class Visit>
constexpr void for_each_field(const Table& table, Visit&& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, table.fields);
}
template <class... Tables, class Visit>
constexpr void for_each_table(const std::tuple<Tables...>& tables, Visit&& visit) {
  std::apply([&](const auto&... table) { (visit(table), ...); }, tables);
}

/// "bonds" of "/bonds/".
template <class Table>
constexpr std::string_view name_of(const Table& table) {
  const std::string_view path = table.path;
  return path.substr(1, path.size() - 2);
}

template <class T>
inline constexpr bool is_row_table = false;
template <class... T>
inline constexpr bool is_row_table<RowTable<T...>> = true;

/// Columns of particles and bonds, as opposed to single values.
template <class T>
inline constexpr bool is_column = false;
template <class IdType, class T>
inline constexpr bool is_column<Column<IdType, T>> = true;
template <class T>
inline constexpr bool is_particle_column = false;
template <class T>
inline constexpr bool is_particle_column<PerParticle<T>> = true;

}  // namespace vbond
