#pragma once
#include <cstdint>
#include <functional>
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

/// Whether a case can be set up so. All its stages are of dynamics, and all bonds are made as the first one
/// begins. Nothing in it asks for the whole body: capsules, crossings, sources, bonds that expand, pressures,
/// stresses on a cell, rigid groups in a cell and an exact step do.
bool may_keep_own_bonds(const Case& c);

/// Whether each process of such a case may have the orientations and velocities of few particles alone. Rigid
/// groups ask for those of all of theirs.
bool may_keep_own_motion(const Case& c);

/// Whether each process of such a case may forget where the particles of others stood at first once it knows
/// its own ones and second ends of its own bonds. Contacts ask for more of them, an imposed strain and the
/// box of a mean stress for those of groups.
bool may_keep_own_first_places(const Case& c);

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

/// Particles in slices across the longest direction of the body, of about as many for each process: those of
/// this one. All processes find the same slices.
PerParticle<char> slice_of(const PerParticle<Vec3d>& r, const Communicator& all);

/// Selects the pairs of this slice, spreads the particles by the pairs of all, and makes own bonds. Before
/// there are bonds it calls complete() with its own particles and the second ends of its own pairs, of which
/// they ask for orientations: until then the state need not have any, nor velocities. Throws CaseError on all
/// processes where one finds a mistake, or where a set has no pair at all: the whole body is then to be
/// looked at.
BondsFromSetUp make_own_bonds(const Case& c, const Model& model, State& state, const PerParticle<char>& slice,
                              const KeepOwnBonds& processes,
                              const std::function<void(const std::vector<ParticleId>&)>& complete,
                              Problems& problems, SharedCells& shared);

/// Throws CaseError if one of these processes has found problems.
void throw_if_any_has(const Problems& problems, const Communicator& all);

}  // namespace vbond
