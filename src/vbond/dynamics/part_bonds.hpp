#pragma once
#include <cstddef>
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/state.hpp"

/// Bonds of a part of a body: its state has those of its own first particles. A state of the whole body is
/// cut down to these, and made of them again.
namespace vbond {

/// What bonds of the whole body share. Parts tell each other places in these lists, which are the same in
/// all.
struct SharedByBonds {
  std::vector<const BondLaw*> laws;
  std::vector<const BondRules*> rules;

  void add(const Bond& bond);
};

/// All that a state has of bonds.
struct BondsOfState {
  PerBond<Bond> bonds;
  PerBond<BondHistory> history;
  std::vector<WarmBond> warm;

  void give_back(State& state);
};

/// Leaves a whole state its own bonds alone, of those of a part in this order. Returns what it had.
BondsOfState keep_own_bonds(State& state, const BodyPart& part, const Order& order, PartBonds& bonds,
                            SharedByBonds& shared);

/// Takes up what the whole body has of bonds from this one on, which are new.
void take_up_bonds(const State& whole, std::size_t first, const Order& order, State& state, PartBonds& bonds,
                   SharedByBonds& shared);

/// A copy of the state with the bonds of all parts, which call this together. They send each other some at a
/// time, in the order of their numbers in the whole body.
State with_all_bonds(State& state, const PartBonds& bonds, const SharedByBonds& shared,
                     const Exchange& exchange);

}  // namespace vbond
