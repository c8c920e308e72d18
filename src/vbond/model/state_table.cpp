#include "vbond/model/state_table.hpp"

namespace vbond {
namespace {

/// Columns that all bodies have keep their length.
template <class Value>
void clear(Value& value, Filed filed) {
  if constexpr (is_column<Value>)
    value.assign(filed == Filed::always ? value.size() : 0, {});
  else
    value = {};
}

}  // namespace

void begin_anew(State& state, Anew when) {
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    auto& of = table.in(state);
    if constexpr (is_row_table<Table>) {
      if (table.traits.anew == when) of = {};
    } else {
      for_each_field(table, [&](const auto& f) {
        if (f.traits.anew == when) clear(of.*f.value, f.traits.filed);
      });
    }
  });
}

}  // namespace vbond
