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
  const auto is_due = [when](Anew anew) {
    return anew == when || (anew == Anew::any_stage && when == Anew::stage);
  };
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    auto& of = table.in(state);
    if constexpr (is_row_table<Table>) {
      if (is_due(table.traits.anew)) of = {};
    } else {
      for_each_field(table, [&](const auto& f) {
        if (is_due(f.traits.anew)) clear(of.*f.value, f.traits.filed);
      });
    }
  });
}

}  // namespace vbond
