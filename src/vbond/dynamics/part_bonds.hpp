#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "vbond/core/communicator.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

/// Bonds of a part of a body: its state has those of its own first particles. A state of the whole body is
/// cut down to these, and made of them again.
namespace vbond {

/// What bonds of the whole body share. Parts tell each other places in these lists, which are the same in
/// all.
struct SharedByBonds {
  std::vector<ShortPointer<BondLaw>> laws;
  std::vector<ShortPointer<BondRules>> rules;

  void add(const Bond& bond);
  std::uint32_t place_of_law(const Bond& bond) const;
  std::uint32_t place_of_rules(const Bond& bond) const;
};

/// What one of several processes has of the state of a body, each bond with its first particle: for those who
/// bring the whole together a piece at a time. Keeps references.
struct StateOfPart {
  /// Up to date for what is its own; what all parts add up is of the whole body.
  const State& state;
  std::vector<ParticleId> particles;  ///< its own, increasing; those that are absent are the leader's
  const PerBond<BondId>& names;       ///< of its bonds, in increasing order
  const SharedByBonds& shared;        ///< in the order in which the bonds of the whole body have them
  const Communicator& all;
};

/// The same with the numbers that bonds have in the whole body; and in order of these.
std::vector<WarmBond> by_name(std::vector<WarmBond> warm, const PerBond<BondId>& names);
std::vector<WarmBond> in_order_of_bonds(std::vector<WarmBond> warm);

/// Leaves a whole state the bonds alone that are a part's own in this order; of particles that are absent,
/// they are the leader's.
PartBonds keep_own_bonds(State& state, const Order& order, bool leads, SharedByBonds& shared);

/// The same of a state that has these of its own already; all parts call this together. Throws
/// std::logic_error if they are not those of this order.
PartBonds keep_known_bonds(BondsFromSetUp own, const State& state, const Order& order, SharedByBonds& shared);
/// What parts have of bonds, numbered in the order of their names, of which an end is known here besides.
/// All parts call this together.
std::vector<BondEnds> ends_of_others(const PerBond<BondId>& names, const State& state, const Order& order,
                                     const Communicator& all);
/// What the bonds of the whole body share.
SharedByBonds shared_by(const BondsFromSetUp& own);

/// Bonds go with their first particles to the parts that have these from now on: goes_to(p) is that part, or
/// nothing where p stays. `others` are left as they are. All parts call this together.
using GoesTo = std::function<std::optional<std::size_t>(ParticleId)>;
void move_bonds(const GoesTo& goes_to, State& state, PartBonds& bonds, const SharedByBonds& shared,
                const Communicator& all);

/// The particles that the state of a part has: those that it knows, both ends of its bonds, also where these
/// have broken, members of grips, and whoever is absent.
std::shared_ptr<const IdSet<ParticleId>> particles_of_part(const State& state, const Stage& stage,
                                                           const Order& order);

/// Takes up what the whole body has of bonds from this one on, which are new.
void take_up_bonds(const State& whole, std::size_t first, const Order& order, State& state, PartBonds& bonds,
                   SharedByBonds& shared);

/// A copy of the state with the bonds of all parts, which call this together. They send each other some at a
/// time, in the order of their numbers in the whole body.
State with_all_bonds(State& state, const PartBonds& bonds, const SharedByBonds& shared,
                     const Communicator& all);
/// The same of a state that is not needed as it is.
State with_all_bonds(State&& state, const PartBonds& bonds, const SharedByBonds& shared,
                     const Communicator& all);

}  // namespace vbond
