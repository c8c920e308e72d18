#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "vbond/model/state.hpp"
#include "vbond/statics/fracture_under_way.hpp"

namespace vbond::test {

/// What a stage of fracture of this body may know at a point of it, with nothing left out: of 12 unknowns,
/// with bond 1 broken, and a kept factor. The clock of the state is taken there.
inline FractureUnderWay under_way_of(State& s) {
  FractureUnderWay u;
  s.clock.stage_step = u.found.points = 3;
  u.numbers.load_factor = 0.5, u.numbers.unknowns = 12, u.numbers.breaks = 1;
  u.found.iterations = 7, u.found.factors = 2, u.found.load_factor = 0.5, u.found.unstable = 0;
  BrokenBond b;
  b.point = 2, b.avalanche = 1, b.use = {BondId{1}, s.bonds[BondId{1}].i, s.bonds[BondId{1}].j, 1.0, 0.25};
  b.section = {0.5, 0.25, 0.125, 2.0}, b.middle = {1, 2, 3}, b.load_after = 3.0, b.load_factor_after = 0.5;
  u.found.fracture.breaks = {b};
  u.found.residuals = {1e-3, 1e-11};
  u.rate.assign(12, 0.25);
  u.held = {{ParticleId{0}, 3, HeldPart::Why::came_off, false, HeldAxes{}},
            {ParticleId{2}, 1, HeldPart::Why::floats}};
  u.turned_at_start = {rotation_of({0, 0, 1})};
  u.turns_of_grips = {rotation_of({0, 1, 0})};
  u.begun = std::make_shared<const State>(s);
  std::vector<std::pair<ParticleId, ParticleId>> pairs;
  for (const Bond& bond : s.bonds) pairs.emplace_back(bond.i, bond.j);
  u.pattern = std::make_shared<const std::vector<std::pair<ParticleId, ParticleId>>>(pairs);
  u.remembered_before.resize(s.bonds.size());
  u.remembered_of_tangent.resize(s.bonds.size());
  pairs.emplace_back(s.bonds[BondId{0}].i, s.bonds[BondId{1}].j);  // have touched since
  u.factor.made_at = std::make_shared<const KeptFactorUnderWay::Place>(
      KeptFactorUnderWay::Place{s.r, s.q, s.cell, 0.25, 1, pairs});
  u.factor.changes = {{{0, 5}, {1.0, 2.0, 2.0, 3.0}, 0.5}};
  u.factor.random.discard(5);
  u.factor.proofs = 3, u.factor.spent = 2.5, u.factor.in_cycle = 1.5, u.factor.recent = 0.5;
  u.factor.slow = 0.75, u.factor.wasted = 1.25;
  return u;
}

}  // namespace vbond::test
