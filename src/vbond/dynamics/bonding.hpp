#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/neighbours.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Makes bonds during the run by the stage's rules ([KA12] section V, step 1 of the algorithm).
class Bonding {
 public:
  /// Keeps references to all; `index` is asked when a list is rebuilt, so it may be replaced in place.
  Bonding(const Model& model, const Stage& stage, const Order& order, const BondIndex& index,
          const Exchange& exchange = one_rank());
  Bonding(const Model&&, const Stage&, const Order&, const BondIndex&) = delete;
  Bonding(const Model&, const Stage&&, const Order&, const BondIndex&) = delete;
  Bonding(const Model&, const Stage&, const Order&&, const BondIndex&) = delete;
  Bonding(const Model&, const Stage&, const Order&, const BondIndex&&) = delete;

  /// A pair to be bonded: i < j, or i = j and image_j > 0.
  struct Pair {
    std::uint32_t rule;  ///< its number in the stage
    ParticleId i, j;
    Image image_j;
  };
  const BondRecipe& recipe(std::uint32_t rule) const { return rules_[rule].rule->recipe; }
  /// Pairs that are nearer than this are listed.  [length]
  double reach() const {
    double most = 0.0;
    for (const RuleList& list : rules_) most = std::max(most, 1.2 * list.farthest);
    return most;
  }
  /// Every pair without a bond that a rule joins and that is close enough, once, in the order of rules, then
  /// (i, j, image). A pair whose own strength (Weibull's) does not bear the prestrain of the rule is left
  /// unbonded. One pose per row.
  std::vector<Pair> find(std::span<const PoseRow> pose, const Team& team);
  /// The last bond between i and this image of j is broken: they are bonded again if they are still close
  /// enough, in the next step as after a checkpoint.
  void unbonded(ParticleId i, ParticleId j, const Image& image_j);
  /// Bonds these pairs; the state is that of the poses in which they were found.
  /// Contact energy that a pair gives up because bonded pairs do not touch is booked as dissipated.
  /// Throws Diverged if a bond would have no length, or if the new bonds make the step too large and the case
  /// does not insist on it.
  void make(const std::vector<Pair>& pairs, State& state);

 private:
  struct RuleList {
    const BondingRule* rule;
    NeighbourList near;
    double farthest;  ///< of all pairs that it may bond  [length]
  };
  bool within_reach(const BondingRule& rule, std::span<const PoseRow> pose, Row i, Row j) const;
  void check_step(const State& state) const;
  bool holds(const BondRecipe& recipe, std::span<const PoseRow> pose, Row i, Row j) const;

  const Model& model_;
  const Order& order_;
  const Exchange& exchange_;
  const std::vector<WallDrive>& walls_;
  const std::vector<Support>& supports_;
  const bool insist_;
  std::vector<RuleList> rules_;
};

}  // namespace vbond
