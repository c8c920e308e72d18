#pragma once
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/setup/bond_pairs.hpp"

namespace vbond {

/// A place where the axes of two capsules are nearest to each other, between two particles of each or at one.
struct Crossing {
  Pair pair;              ///< the particles that are nearest to it, one of each fibre
  CrossingPoints points;  ///< on the axes
  double gap = 0;         ///< of the surfaces there, < 0 where they overlap  [length]
};

/// The places where two fibres come nearest, if their surfaces are no farther apart than `gap`: those pairs
/// of capsules that are nearer than the pairs next to them along both fibres. Capsules that share a particle,
/// or whose particles are bonded, are no crossing, and neither are those beside them that are farther apart.
/// In order of pairs, each pair of particles at most once. Fibres that lie along each other have one or few
/// such places. bonds: those of the state, of which fibres are those with a capsule; whether things touch in
/// the model does not matter.
/// Throws std::length_error if the gap is beyond ten times the longest capsule, or capsules have more than
/// 200 others within reach, most of them of their own fibre: the gap is in a wrong unit.
std::vector<Crossing> crossings_within(const Model& model, const State& state, const PerBond<Bond>& bonds,
                                       double gap);

}  // namespace vbond
