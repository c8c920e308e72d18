#pragma once
#include <type_traits>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/state_table.hpp"

/// What belongs to each particle or bond, and a part of a body may have of some of them alone.
namespace vbond {

/// Those that are known to the part that has the particle, or the bond.
template <class IdType, class Visit>
void for_each_owned_column(State& state, Visit visit) {
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    if constexpr (!is_row_table<Table>) {
      auto& of = table.in(state);
      for_each_field(table, [&]<class Of, class Value>(const Field<Of, Value>& f) {
        if constexpr (is_column<Value>)
          if constexpr (is_particle_column<Value> == std::is_same_v<IdType, ParticleId>)
            if (f.traits.known == Known::by_owner) visit(of.*f.value);
      });
    }
  });
}

/// Those of a model that parts may have of some particles alone.
template <class Visit>
void for_each_shared_column(Model& model, Visit visit) {
  visit(model.mass), visit(model.inertia), visit(model.r_0);
  if (!model.specimen.empty()) visit(model.specimen);
}

/// The rows that each part lists of its own, and that follow each other in the order of place_of().
template <class Visit>
void for_each_list(State& state, Visit visit) {
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    if constexpr (is_row_table<Table>) {
      auto& rows = table.in(state);
      if constexpr (requires { place_of(*rows.begin()); })
        if (table.traits.known == Known::listed) visit(rows);
    }
  });
}

}  // namespace vbond
