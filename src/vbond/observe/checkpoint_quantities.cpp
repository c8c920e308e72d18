#include "vbond/observe/detail/checkpoint_tables.hpp"
#include "vbond/observe/detail/fracture_tables.hpp"
#include "vbond/observe/detail/h5_shared.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

template <class... Tables>
void list(const std::tuple<Tables...>& tables, std::vector<CheckpointQuantity>& to) {
  for_each_table(tables, [&](const auto& table) {
    for_each_field(table, [&](const auto& f) {
      to.push_back({std::string(table.path) + f.name, f.unit, f.meaning});
    });
  });
}

}  // namespace

std::span<const CheckpointQuantity> checkpoint_quantities() {
  static const std::vector<CheckpointQuantity> all = [] {
    std::vector<CheckpointQuantity> sets;
    list(state_table, sets);
    sets.push_back({law_names_path, unit::none, law_names_meaning});
    sets.push_back({rule_numbers_path, unit::none, rule_numbers_meaning});
    list(watch_table, sets);
    list(model_table, sets);
    list(cell_table, sets);
    list(under_way_table, sets);
    return sets;
  }();
  return all;
}

}  // namespace vbond
