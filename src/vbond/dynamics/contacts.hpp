#pragma once
#include <optional>

#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/neighbours.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/physics/contact.hpp"

namespace vbond {

/// Repulsion between overlapping particles, over a neighbour list of its own.
class Contacts {
 public:
  /// Keeps references to the model; `index` is asked at a rebuild, so it may be replaced in place.
  Contacts(const Model& model, const BondIndex& index);

  /// Brings the list up to date.
  void refresh(const State& state);
  /// The set of bonded pairs is no longer the same.
  void bonds_changed();
  void add_loads(const State& state, int threads, Loads& loads) const;
  /// [energy]
  double energy(const State& state) const;

 private:
  const Model& model_;
  const BondIndex& index_;
  std::optional<NeighbourList> list_;  // none without contacts
};

}  // namespace vbond
