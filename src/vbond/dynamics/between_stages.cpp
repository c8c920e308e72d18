#include "vbond/dynamics/between_stages.hpp"

#include <utility>

#include "vbond/dynamics/gather.hpp"

namespace vbond {

BondsFromSetUp open_part(PartHandedOver& part, RanksKeep keep, Model& model, State& state,
                         const Communicator& all) {
  if (keep == RanksKeep::own_motion) gather_places(state, part.particles, all);
  if (keep == RanksKeep::own_bonds) gather_particles(state, part.particles, all);
  if (keep == RanksKeep::own_first_places)
    gather_masses(model, part.particles, all);
  else
    gather_particles(model, part.particles, all);
  BondsFromSetUp bonds;
  bonds.all = &all;
  bonds.part = std::move(part.bonds);
  bonds.part.others = {};
  bonds.own.assign(model.particles(), 0);
  for (const ParticleId p : part.particles) bonds.own[p] = 1;
  count_bonds_of_each(bonds, state);
  bonds.whole = static_cast<std::size_t>(count_bonds(BodyPart(state, bonds)));
  return bonds;
}

PartHandedOver closed_part(PartHandedOver part, BondsFromSetUp bonds) {
  part.bonds = std::move(bonds.part);
  return part;
}

State whole_of(State state, BondsFromSetUp bonds, const PartHandedOver* part, Model& model) {
  const Communicator& all = *bonds.all;
  const std::vector<ParticleId> own = own_particles(bonds);
  if (!model.r_0.holds_all()) gather_particles(model, own, all);
  if (part != nullptr)
    gather_owned(state, own, {}, false, all);
  else if (!state.v.holds_all())
    gather_particles(state, own, all);
  return with_all_bonds(std::move(state), bonds.part, part != nullptr ? part->shared : shared_by(bonds), all);
}

}  // namespace vbond
