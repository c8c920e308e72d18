#pragma once
#include <string>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/unknowns.hpp"

namespace vbond {

/// A term keeps a particle from moving along this direction, as a wall does along its normal.
struct TermHold {
  ParticleId p;
  Vec3d along;
};

/// The motions as a rigid body, of each connected part (by bonds and contacts), that neither supports nor
/// terms hold. Turns of a particle that has contacts but no bonds are motions of its own.
struct RigidMotions {
  /// Orthonormal columns over the unknowns; those of one part, six at most, follow each other, and have
  /// entries at its unknowns only. Then come turns of single particles of it.
  SparseMatrix basis;
  /// One per column, e.g. "rotation about x of particles 0 to 9": of motions that span the same as the
  /// columns of the part.
  std::vector<std::string> names;
};

/// Of a periodic body a part is what hangs together by images, too; a part that goes on in several directions
/// cannot turn, since the cell does not. Takes time in proportion to the particles, however many parts there
/// are. Particles of a part that is
/// joined by contacts alone can move against each other besides; that is not looked for.
RigidMotions free_rigid_motions(const Model& model, const State& state, const Unknowns& unknowns,
                                const std::vector<TermHold>& holds = {});

/// How the parts of a periodic body hang together by images.
struct PartImages {
  PerParticle<std::size_t> part;  ///< the number of each particle's part
  PerParticle<Image> image;       ///< that of each particle which hangs together with the first of its part
  /// Of each part: images of particles that it hangs together with besides, against those.
  std::vector<std::vector<Image>> loops;
};
PartImages images_of_parts(const Model& model, const State& state, const Unknowns& unknowns);

/// As many unknowns as there are columns, such that no combination of columns leaves all of them where they
/// are: Gauss's elimination, the largest entry first.
std::vector<int> holding_unknowns(const SparseMatrix& columns);

/// Columns that span the same, orthonormal, if those more than five apart have no row in common: the motions
/// of a RigidMotions after their rows have been scaled. Throws std::invalid_argument if columns depend on
/// each other.
SparseMatrix orthonormalised(const SparseMatrix& columns);

}  // namespace vbond
