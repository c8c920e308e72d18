#include "vbond/dynamics/gather.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>

#include "vbond/dynamics/owned_columns.hpp"

namespace vbond {
namespace {

/// The numbers by which a value is summed.
std::span<double> numbers_of(double& value) {
  return {&value, 1};
}
std::span<double> numbers_of(Losses& value) {
  return value.of;
}
template <class Value>
concept Summable = requires(Value& value) {
  numbers_of(value);
};

/// Brings the values that parts have of their own ids to all parts.
template <class IdType>
class Bring {
 public:
  Bring(const std::vector<IdType>& own, const Communicator& all) : own_(own), communicator_(all) {}

  template <class T>
  void operator()(Column<IdType, T>& column) {
    if (!all_) all_ = communicator_.gather(own_);
    std::vector<T> values;
    values.reserve(own_.size());
    for (const IdType id : own_) values.push_back(column[id]);
    const std::vector<T> of_all = communicator_.gather(values);
    if constexpr (may_hold_some<IdType>) column.hold({});
    for (std::size_t k = 0; k < of_all.size(); ++k) column[(*all_)[k]] = of_all[k];
  }

 private:
  const std::vector<IdType>& own_;
  const Communicator& communicator_;
  std::optional<std::vector<IdType>> all_;
};

}  // namespace

void sum_values(State& state, const Exchange& exchange) {
  std::vector<std::span<double>> summed;
  const auto add = [&summed](const auto& f, auto& of) {
    if constexpr (Summable<std::remove_reference_t<decltype(of.*f.value)>>)
      if (f.traits.known == Known::summed) summed.push_back(numbers_of(of.*f.value));
  };
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    auto& of = table.in(state);
    if constexpr (!is_row_table<Table>) {
      for_each_field(table, [&](const auto& f) { add(f, of); });
    } else if constexpr (!std::is_same_v<typename Table::Of, Bond>) {
      if (table.traits.known != Known::everywhere) return;
      for (auto& row : of) for_each_field(table, [&](const auto& f) { add(f, row); });
    }
  });
  std::vector<double> numbers;
  for (const std::span<double> s : summed) numbers.insert(numbers.end(), s.begin(), s.end());
  exchange.sum(numbers);
  auto next = numbers.begin();
  for (const std::span<double> s : summed) {
    std::copy_n(next, s.size(), s.begin());
    next += static_cast<std::ptrdiff_t>(s.size());
  }
}

void keep_particles(State& state, const std::shared_ptr<const IdSet<ParticleId>>& some) {
  for_each_owned_column<ParticleId>(state, [&some](auto& column) {
    if (!column.empty()) column.hold(some);
  });
}

void gather_particles(State& state, const std::vector<ParticleId>& own, const Communicator& all) {
  Bring<ParticleId> bring(own, all);
  for_each_owned_column<ParticleId>(state, [&bring](auto& column) {
    if (!column.empty()) bring(column);
  });
}

void keep_particles(Model& model, const std::shared_ptr<const IdSet<ParticleId>>& some) {
  for_each_shared_column(model, [&some](auto& column) { column.hold(some); });
}

void gather_particles(Model& model, const std::vector<ParticleId>& own, const Communicator& all) {
  Bring<ParticleId> bring(own, all);
  for_each_shared_column(model, [&bring](auto& column) { bring(column); });
}

void gather_masses(Model& model, const std::vector<ParticleId>& own, const Communicator& all) {
  Bring<ParticleId> bring(own, all);
  for_each_shared_column(model, [&](auto& column) {
    if (static_cast<const void*>(&column) != &model.r_0) bring(column);
  });
}

void gather_places(State& state, const std::vector<ParticleId>& own, const Communicator& all) {
  Bring<ParticleId>(own, all)(state.r);
}

void gather_owned(State& state, const std::vector<ParticleId>& own_particles,
                  const std::vector<BondId>& own_bonds, bool has_all_bonds, const Communicator& all) {
  gather_particles(state, own_particles, all);
  Bring<BondId> bring_bonds(own_bonds, all);
  if (has_all_bonds)
    for_each_owned_column<BondId>(state, [&bring_bonds](auto& column) {
      if (!column.empty()) bring_bonds(column);
    });
  for_each_list(state, [&all](auto& rows) { rows = in_order_of_places(all.gather(rows)); });
}

}  // namespace vbond
