#include "vbond/dynamics/gather.hpp"

#include <algorithm>
#include <optional>
#include <type_traits>

#include "vbond/model/state_table.hpp"

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

/// Brings the values that parts have of their own ids to their places in the whole.
template <class IdType>
class Bring {
 public:
  Bring(const std::vector<IdType>& own, const Exchange& exchange, bool everyone)
      : own_(own), exchange_(exchange), everyone_(everyone) {}

  template <class T>
  void operator()(const Column<IdType, T>& from, Column<IdType, T>& to) {
    if (!all_) all_ = exchange_.gather(own_, everyone_);
    std::vector<T> values;
    values.reserve(own_.size());
    for (const IdType id : own_) values.push_back(from[id]);
    const std::vector<T> of_all = exchange_.gather(values, everyone_);
    if (!of_all.empty()) to.resize(from.size());
    for (std::size_t k = 0; k < of_all.size(); ++k) to[(*all_)[k]] = of_all[k];
  }

 private:
  const std::vector<IdType>& own_;
  const Exchange& exchange_;
  bool everyone_;
  std::optional<std::vector<IdType>> all_;
};

}  // namespace

void gather_values(const State& part, const Exchange& exchange, std::span<double> more, State& whole) {
  std::vector<std::span<double>> summed;
  const auto add = [&summed](const auto& f, auto& of) {
    if constexpr (Summable<std::remove_reference_t<decltype(of.*f.value)>>)
      if (f.traits.known == Known::summed) summed.push_back(numbers_of(of.*f.value));
  };
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    auto& to = table.in(whole);
    const auto& from = table.in(part);
    if constexpr (!is_row_table<Table>) {
      for_each_field(table, [&](const auto& f) {
        if (f.traits.known == Known::everywhere || f.traits.known == Known::summed)
          to.*f.value = from.*f.value;
        add(f, to);
      });
    } else if constexpr (!std::is_same_v<typename Table::Of, Bond>) {
      if (table.traits.known != Known::everywhere) return;
      to = from;
      for (auto& row : to) for_each_field(table, [&](const auto& f) { add(f, row); });
    }
  });
  summed.push_back(more);
  std::vector<double> numbers;
  for (const std::span<double> s : summed) numbers.insert(numbers.end(), s.begin(), s.end());
  exchange.sum(numbers);
  auto next = numbers.begin();
  for (const std::span<double> s : summed) {
    std::copy_n(next, s.size(), s.begin());
    next += static_cast<std::ptrdiff_t>(s.size());
  }
}

void gather_owned(const State& part, const std::vector<ParticleId>& own_particles,
                  const std::vector<BondId>& own_bonds, const Exchange& exchange, bool everyone,
                  State& whole) {
  Bring<ParticleId> bring_particles(own_particles, exchange, everyone);
  Bring<BondId> bring_bonds(own_bonds, exchange, everyone);
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    auto& to = table.in(whole);
    const auto& from = table.in(part);
    if constexpr (is_row_table<Table>) {
      if (table.traits.known == Known::collected) to = from;
      if constexpr (requires { place_of(*from.begin()); })
        if (table.traits.known == Known::listed) {
          to = exchange.gather(from, everyone);
          std::stable_sort(to.begin(), to.end(),
                           [](const auto& a, const auto& b) { return place_of(a) < place_of(b); });
        }
    } else {
      for_each_field(table, [&]<class Of, class Value>(const Field<Of, Value>& f) {
        if (f.traits.known != Known::by_owner) return;
        if constexpr (is_column<Value>) {
          if ((from.*f.value).empty())
            to.*f.value = {};
          else if constexpr (is_particle_column<Value>)
            bring_particles(from.*f.value, to.*f.value);
          else
            bring_bonds(from.*f.value, to.*f.value);
        }
      });
    }
  });
}

}  // namespace vbond
