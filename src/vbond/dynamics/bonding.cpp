#include "vbond/dynamics/bonding.hpp"

#include <fmt/core.h>

#include <set>
#include <string>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond {
namespace {

bool joins(const BondingRule& rule, ParticleId i, ParticleId j) {
  return (rule.in_a[i.value] && rule.in_b[j.value]) || (rule.in_a[j.value] && rule.in_b[i.value]);
}

std::string pair_name(ParticleId i, ParticleId j) {
  return "particles " + std::to_string(i.value) + " and " + std::to_string(j.value);
}

Bond bond_between(const BondRecipe& recipe, const Model& model, const State& s, ParticleId i, ParticleId j) {
  if (const auto bond = make_bond(recipe, bond_site(model, s, i), bond_site(model, s, j))) return *bond;
  throw Diverged(s.clock.step, s.clock.time(), pair_name(i, j),
                 "came within bonding distance, but their bonded points are no apart (a <= 0)",
                 "attach the bonds at the centres, or bond at a larger distance than R_i + R_j");
}

}  // namespace

Bonding::Bonding(const Model& model, const Stage& stage, const BondIndex& index)
    : model_(model), insist_(stage.insist) {
  for (const BondingRule& rule : stage.bonding)
    rules_.push_back({&rule, NeighbourList(
                                 rule.distance, 0.2 * rule.distance,
                                 [&rule](ParticleId i, ParticleId j) {
                                   return joins(rule, i, j) ? rule.distance : -rule.distance;
                                 },
                                 [&index](ParticleId i, ParticleId j) { return index.bonded(i, j); })});
}

void Bonding::check_step(const State& state) const {
  const StepBound bound = step_bound(model_, state);
  if (insist_ || state.clock.dt <= bound.dt) return;
  throw Diverged(state.clock.step, state.clock.time(), "new bonds",
                 fmt::format("the time step {:.6g} is above the critical step {:.6g}, from {}",
                             state.clock.dt, bound.dt, bound.source),
                 "choose a smaller time.step or time.fraction");
}

bool Bonding::make_bonds(State& state) {
  std::set<std::pair<ParticleId, ParticleId>> made;
  for (RuleList& list : rules_) {
    const BondingRule& rule = *list.rule;
    list.near.refresh(state.r);
    for (const ParticleId i : state.r.ids())
      for (const ParticleId j : list.near.of(i)) {
        if (!(i < j) || norm2(state.r[j] - state.r[i]) > sq(rule.distance)) continue;
        if (!made.insert({i, j}).second) continue;
        add_bond(model_, bond_between(rule.recipe, model_, state, i, j), state);
      }
  }
  if (made.empty()) return false;
  for (RuleList& list : rules_) list.near.invalidate();
  check_step(state);
  return true;
}

}  // namespace vbond
