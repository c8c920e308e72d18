#pragma once
#include <algorithm>
#include <memory>
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

/// State of a whole body in all of its parts, field by field as state_table.hpp says who knows it. All
/// parts call these in the same order.
namespace vbond {

/// What parts have listed, as the whole body has it.
template <class Row>
std::vector<Row> in_order_of_places(std::vector<Row> rows) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return place_of(a) < place_of(b); });
  return rows;
}

/// What parts add up becomes the sum, on all of them.
void sum_values(State& state, const Exchange& exchange);

/// Of all that belongs to particles, the state has that of these alone from now on.
void keep_particles(State& state, const std::shared_ptr<const IdSet<ParticleId>>& some);
/// It has that of all again: each part brings what it has of its own.
void gather_particles(State& state, const std::vector<ParticleId>& own, const Communicator& all);

/// The same of masses, least moments of inertia, first places and specimens of a model. All else of it is
/// still whole.
void keep_particles(Model& model, const std::shared_ptr<const IdSet<ParticleId>>& some);
void gather_particles(Model& model, const std::vector<ParticleId>& own, const Communicator& all);
/// All of these but first places.
void gather_masses(Model& model, const std::vector<ParticleId>& own, const Communicator& all);

/// Of what belongs to particles the state has all places again, and else what it had.
void gather_places(State& state, const std::vector<ParticleId>& own, const Communicator& all);

/// What belongs to particles and bonds, and what parts list, comes to all parts. What is this part's own has
/// been collected from its rows. has_all_bonds: else bonds are left as they are.
void gather_owned(State& state, const std::vector<ParticleId>& own_particles,
                  const std::vector<BondId>& own_bonds, bool has_all_bonds, const Communicator& all);

}  // namespace vbond
