#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "vbond/dynamics/gather.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/observe/detail/h5_tables.hpp"

/// A body that several processes share, written by the one that leads.
namespace vbond {

/// What the process that leads does while the others send it what it needs: once something goes wrong it does
/// no more, and tells of it in the end, as they would wait for it.
class LeadersWork {
 public:
  explicit LeadersWork(bool leads) : goes_on_(leads) {}
  template <class Work>
  void operator()(Work&& work) {
    if (!goes_on_) return;
    try {
      work();
    } catch (...) {
      goes_on_ = false;
      failure_ = std::current_exception();
    }
  }
  /// Throws what has gone wrong.
  void end() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  bool goes_on_;
  std::exception_ptr failure_;
};

/// Writes what write_tables() writes of a whole model or state. All processes do so together: each sends what
/// is its own, some numbers at a time in the order of particles or bonds, so that nobody has the whole.
/// `file` gives the file where the work is done.
class BodyInPieces {
 public:
  BodyInPieces(const StateOfPart& part, LeadersWork& lead, std::function<H5Writer&()> file)
      : part_(part), all_(part.all), lead_(lead), file_(std::move(file)), bonds_(number_of_bonds(part)) {}

  template <class... Tables, class Whole>
  void write(const std::tuple<Tables...>& tables, const Whole& of) {
    for_each_table(tables, [&]<class Table>(const Table& table) {
      if constexpr (!is_row_table<Table>)
        for_each_field(table, [&](const auto& f) { write_field(table, f, table.in(of).*f.value); });
      else if constexpr (std::is_same_v<typename Table::Of, Bond>)
        for_each_field(table, [&](const auto& f) { write_bonds(table, f); });
      else
        write_rows_of_all(table, table.in(of));
    });
  }

 private:
  static std::size_t number_of_bonds(const StateOfPart& part) {
    auto bonds = static_cast<double>(part.state.bonds.size());
    part.all.sum({&bonds, 1});
    return static_cast<std::size_t>(bonds);
  }

  /// value(k) is that of the k-th of these ids, which are this process's own in increasing order.
  template <class T, class Ids, class Value>
  void write_column(const DataSet& set, std::size_t rows, const Ids& ids, Value value) {
    using Column = H5Writer::Column<T>;
    using Number = typename Column::Number;
    std::optional<Column> column;
    lead_([&] { column.emplace(file_(), set, rows); });
    std::size_t next = 0;
    auto id = ids.begin();
    for (std::size_t first = 0; first < rows; first += H5Writer::rows_at_once) {
      const std::size_t last = std::min(first + H5Writer::rows_at_once, rows);
      std::vector<std::uint32_t> places;
      std::vector<Number> numbers;
      for (; id != ids.end() && id->value < last; ++id, ++next) {
        places.push_back(static_cast<std::uint32_t>(id->value - first));
        numbers.resize(numbers.size() + Column::count);
        Stored<T>::put(value(next), &numbers[numbers.size() - Column::count]);
      }
      places = all_.send_to_leader(places);
      numbers = all_.send_to_leader(numbers);
      lead_([&] {
        std::vector<Number> piece((last - first) * Column::count);
        for (std::size_t k = 0; k < places.size(); ++k)
          std::copy_n(&numbers[k * Column::count], Column::count, &piece[places[k] * Column::count]);
        column->write(first, piece);
      });
    }
  }

  template <class Table, class Of, class Value>
  void write_field(const Table& table, const Field<Of, Value>& f, const Value& value) {
    if constexpr (is_column<Value>) {
      if (f.traits.known == Known::by_owner) return write_owned(data_set(table, f), f.traits, value);
    }
    lead_([&] { vbond::write_field(file_(), table, f, value); });
  }
  template <class T>
  void write_owned(const DataSet& set, const FieldTraits& traits, const PerParticle<T>& column) {
    if (traits.filed == Filed::where_any && column.empty()) return;
    write_column<T>(set, column.size(), part_.particles,
                    [&](std::size_t k) -> const T& { return column[part_.particles[k]]; });
  }
  /// Empty in one part it need not be so in others.
  template <class T>
  void write_owned(const DataSet& set, const FieldTraits& traits, const PerBond<T>& column) {
    if (traits.filed == Filed::where_any && !all_.any(!column.empty())) return;
    write_column<T>(set, bonds_, part_.names,
                    [&](std::size_t k) { return k < column.size() ? column[BondId{k}] : T{}; });
  }

  template <class Table, class Value, class Member>
  void write_bonds(const Table& table, const Field<Bond, Value, Member>& f) {
    const auto is_as_new = [&f](const Bond& b) { return value_of(b, f.value) == value_of(Bond{}, f.value); };
    const PerBond<Bond>& bonds = part_.state.bonds;
    if (f.traits.filed == Filed::where_any && !all_.any(!std::all_of(bonds.begin(), bonds.end(), is_as_new)))
      return;
    write_member(data_set(table, f), f.value);
  }
  template <class T, class Value>
  void write_of_bonds(const DataSet& set, Value value) {
    write_column<T>(set, bonds_, part_.names,
                    [&](std::size_t k) { return value(part_.state.bonds[BondId{k}]); });
  }
  template <class Value>
  void write_member(const DataSet& set, Value Bond::*member) {
    write_of_bonds<Value>(set, [member](const Bond& b) { return b.*member; });
  }
  void write_member(const DataSet& set, ShortPointer<BondLaw> Bond::* /*law*/) {
    lead_([&] { write_laws(file_(), part_.shared.laws); });
    write_of_bonds<LawNumber>(
        set, [this](const Bond& b) { return static_cast<LawNumber>(part_.shared.place_of_law(b)); });
  }
  void write_member(const DataSet& set, ShortPointer<BondRules> Bond::* /*rules*/) {
    lead_([&] { write_rules(file_(), part_.shared.rules); });
    write_of_bonds<RulesNumber>(set, [this](const Bond& b) { return part_.shared.place_of_rules(b); });
  }
  template <class Value>
  void write_member(const DataSet& set, RareMember<Value> member) {
    write_of_bonds<Value>(set, [member](const Bond& b) { return member.of(b); });
  }
  void write_member(const DataSet& set, RareMember<Quatd> /*frame_j*/) {
    write_of_bonds<Quatd>(set, [](const Bond& b) { return frame_j(b); });
  }

  template <class Table, class Rows>
  void write_rows_of_all(const Table& table, const Rows& rows) {
    if constexpr (std::is_same_v<typename Table::Of, WarmBond>) {
      const auto whole = in_order_of_bonds(all_.send_to_leader(by_name(rows, part_.names)));
      return lead_([&] { write_rows(file_(), table, whole); });
    } else if constexpr (requires { place_of(*rows.begin()); }) {
      if (table.traits.known == Known::listed) {
        const auto whole = in_order_of_places(all_.send_to_leader(rows));
        return lead_([&] { write_rows(file_(), table, whole); });
      }
    }
    lead_([&] { write_rows(file_(), table, rows); });
  }

  const StateOfPart& part_;
  const Communicator& all_;
  LeadersWork& lead_;
  std::function<H5Writer&()> file_;
  std::size_t bonds_;  // of the whole body
};

}  // namespace vbond
