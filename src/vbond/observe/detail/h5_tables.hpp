#pragma once
#include <functional>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "vbond/model/field_table.hpp"
#include "vbond/observe/detail/h5_file.hpp"
#include "vbond/observe/detail/h5_shared.hpp"

/// Tables of fields, written to a checkpoint and read back: one data set per field.
namespace vbond {

template <class Table, class Of, class Value, class Member>
DataSet data_set(const Table& table, const Field<Of, Value, Member>& f) {
  return {std::string(table.path) + f.name, f.unit, f.meaning};
}

/// Rows of a map are its values, each with its own place.
template <class Rows>
const Rows& in_order(const Rows& rows) {
  return rows;
}
template <class Key, class Row>
std::vector<Row> in_order(const std::map<Key, Row>& rows) {
  std::vector<Row> values;
  for (const auto& [place, row] : rows) values.push_back(row);
  return values;
}
template <class Rows, class Row>
void put_back(std::vector<Row> from, Rows& to) {
  if constexpr (std::is_constructible_v<Rows, std::vector<Row>>)
    to = Rows(std::move(from));
  else
    to = Rows(from.begin(), from.end());
}
template <class Key, class Row>
void put_back(const std::vector<Row>& from, std::map<Key, Row>& to) {
  for (const Row& row : from) to[place_of(row)] = row;
}

template <class Table, class Rows>
void write_rows(H5Writer& file, const Table& table, const Rows& of) {
  using Of = typename Table::Of;
  if (table.traits.filed == Filed::where_any && of.empty()) return;
  const auto& rows = in_order(of);
  for_each_field(table, [&](const auto& f) {
    const auto as_new = [&](const Of& row) { return value_of(row, f.value) == value_of(Of{}, f.value); };
    if (f.traits.filed == Filed::always || !std::all_of(rows.begin(), rows.end(), as_new))
      write_column(file, data_set(table, f), rows, f.value);
  });
}

template <class Table, class Of, class Value>
void write_field(H5Writer& file, const Table& table, const Field<Of, Value>& f, const Value& value) {
  if (f.traits.filed == Filed::where_any && value == Of{}.*f.value) return;
  if constexpr (is_column<Value>)
    file.of_each(data_set(table, f), value, std::identity{});
  else
    file(data_set(table, f), value);
}

template <class... Tables, class Whole>
void write_tables(H5Writer& file, const std::tuple<Tables...>& tables, const Whole& whole) {
  for_each_table(tables, [&]<class Table>(const Table& table) {
    const auto& of = table.in(whole);
    if constexpr (is_row_table<Table>)
      write_rows(file, table, of);
    else
      for_each_field(table, [&](const auto& f) { write_field(file, table, f, of.*f.value); });
  });
}

/// How many rows the columns of a file have.
struct FileSizes {
  std::size_t particles = 0, bonds = 0;
  template <class T>
  std::size_t of(const PerParticle<T>&) const {
    return particles;
  }
  template <class T>
  std::size_t of(const PerBond<T>&) const {
    return bonds;
  }
};

/// What the file does not have, and need not.
template <class Table, class Of, class Value, class Member>
bool is_left_out(const H5Reader& file, const Table& table, const Field<Of, Value, Member>& f) {
  return f.traits.filed == Filed::where_any && !file.has(data_set(table, f).path);
}

template <class Table, class Rows>
void read_rows(H5Reader& file, const Table& table, KnownLaws laws, Rows& of) {
  const std::string first = data_set(table, std::get<0>(table.fields)).path;
  if (table.traits.filed == Filed::where_any && !file.has(first)) return;
  std::vector<typename Table::Of> rows(file.rows(first));
  for_each_field(table, [&](const auto& f) {
    if (!is_left_out(file, table, f)) read_column(file, data_set(table, f).path, laws, rows, f.value);
  });
  put_back(std::move(rows), of);
}

template <class Table, class Of, class Value>
void read_field(H5Reader& file, const Table& table, const Field<Of, Value>& f, FileSizes sizes,
                Value& value) {
  if (is_left_out(file, table, f)) return;
  if constexpr (is_column<Value>) {
    value.resize(sizes.of(value));
    file.of_each(data_set(table, f).path, value, std::identity{});
  } else {
    file(data_set(table, f).path, value);
  }
}

/// What is left out stays as it is in `whole`, which is new.
template <class... Tables, class Whole>
void read_tables(H5Reader& file, const std::tuple<Tables...>& tables, FileSizes sizes, KnownLaws laws,
                 Whole& whole) {
  for_each_table(tables, [&]<class Table>(const Table& table) {
    auto& of = table.in(whole);
    if constexpr (is_row_table<Table>)
      read_rows(file, table, laws, of);
    else
      for_each_field(table, [&](const auto& f) { read_field(file, table, f, sizes, of.*f.value); });
  });
}

}  // namespace vbond
