#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/turn_bound.hpp"

namespace vbond {

/// The largest time step that is safe, and what sets it.
struct StepBound {
  double dt;                   ///< [time]; infinite if nothing is elastic
  std::optional<BondId> bond;  ///< the bond that sets it; none if contacts or a bonding rule do
  std::string source;          ///< e.g. "shear and bending of bond 3 (particles 3, 4)"
};

/// Largest stable step of leap-frog, 2 / sqrt(lambda), by an element-by-element bound: never above the
/// critical step of the undeformed body, a few per cent below it. Each particle's mass is shared
/// evenly among its n bonds. The same is asked of bonds under the axial forces that they bear as they stand:
/// by prestrain, temperature, or from what went before.
///
/// What is not there yet is estimated. Contacts: one of each particle, with an overlap of 10 % of the sum of
/// the radii, or as many as it has now, with the largest overlap of these (contact_bound.hpp); their lambda
/// is added to that of the bonds. Bonding rules: particles that a rule can bond count as having at least 12
/// bonds, and a bond as long as the rule's distance between the lightest of them is included.
/// supports: of the stage; contacts of clumps and of what is held are damped by other masses.
/// body: all of it, of whose bonds each of several processes may have its own.
StepBound step_bound(const Model& model, const BodyPart& body, const std::vector<BondingRule>& rules = {},
                     const std::vector<WallDrive>& drives = {}, double contacts_to_come = 1.0,
                     const std::vector<Support>& supports = {});
/// With the supports, bonding rules and terms of a stage, and no more than turns may take (within_turns).
StepBound step_bound(const Model& model, const BodyPart& body, const Stage& stage,
                     Spins spins = Spins::counted);

/// The bound, shorter by what the terms of the stage add: a bound of the same kind, of an exact step as well.
StepBound with_terms(StepBound bound, const Model& model, const State& state, const Stage& stage);

/// The bound, or the step in which what turns fastest in the stage turns by longest_turn if that is shorter.
StepBound within_turns(StepBound bound, const Model& model, const BodyPart& body, const Stage& stage,
                       Spins spins = Spins::counted);

}  // namespace vbond
