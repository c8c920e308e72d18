#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/communicator.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/setup/bond_pairs.hpp"

/// A body of which each of several processes sets up all particles, and keeps its own bonds alone.
namespace vbond {

/// Whether a case can be set up so. It has one stage, of dynamics, and makes all bonds as it begins. Nothing
/// in it asks for the whole body: capsules, crossings, sources, bonds that expand, pressures, stresses on a
/// cell and an exact step do.
bool may_keep_own_bonds(const Case& c);

/// The processes, and how they share out the particles.
struct KeepOwnBonds {
  const Communicator& all;
  /// Called by each that has come so far, before anything is done together: throws where another has failed.
  std::function<void()> meet;
  /// The own particles of this process, in increasing order, before there are bonds: given how many bonds
  /// have each as their first, and the longest of these  [length].
  std::function<std::vector<ParticleId>(const Model&, const State&, const PerParticle<std::uint32_t>& bonds,
                                        double longest)>
      spread;
};

/// Of the bonds of the whole body, which are made one by one in their order, keeps own ones.
class BondKeeper {
 public:
  BondKeeper(const std::vector<ParticleId>& own, std::size_t particles, const Communicator& all);

  /// Makes room for so many bonds of each of these pairs, some in each piece; returns how many of them a
  /// state will have at once: those that are kept, and one that is not.
  std::size_t expect(std::span<const SelectedPairs> pieces, std::size_t bonds_of_each);
  /// Gives the last bond of the state, which is the next of the body, its name; takes it away if it is not to
  /// be kept.
  void look_at_last(State& state);
  /// When all bonds have been made.
  BondsFromSetUp finish(State& state) &&;

 private:
  PerParticle<char> is_own_;
  BondsFromSetUp bonds_;
  bool any_history_ = false;
};

/// Selects the pairs of all sets, spreads the particles by them, then makes all bonds and keeps own ones.
BondsFromSetUp make_own_bonds(const Case& c, const Model& model, State& state, const KeepOwnBonds& processes,
                              Problems& problems, SharedCells& shared);

}  // namespace vbond
