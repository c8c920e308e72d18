#pragma once
#include <vector>

#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/neighbours.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Makes bonds during the run by the stage's rules ([KA12] section V, step 1 of the algorithm).
class Bonding {
 public:
  /// Keeps references to all three.
  Bonding(const Model& model, const Stage& stage, const BondIndex& index);

  /// Bonds every pair that a rule joins and that is close enough, in the order of rules, then (i, j).
  /// Contact energy that a pair gives up because bonded pairs do not touch is booked as dissipated.
  /// Returns whether any bond was made. Throws Diverged if one would have no length, or if the new bonds make
  /// the step too large and the case does not insist on it.
  bool make_bonds(State& state);

 private:
  struct RuleList {
    const BondingRule* rule;
    NeighbourList near;
  };
  void check_step(const State& state) const;

  const Model& model_;
  const bool insist_;
  std::vector<RuleList> rules_;
};

}  // namespace vbond
