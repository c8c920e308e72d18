#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/body_view.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

/// What static stages hand out: plain data, without the solvers' types.
namespace vbond {

/// One state of balance on the way. Those who write see it as a PointView (point_view.hpp).
struct StaticPoint {
  const State& state;
  double load_factor = 0;
  PointKind kind = PointKind::regular;
  std::optional<int> unstable;  ///< negative eigenvalues of the tangent; absent: not counted
  Energies energies;            ///< of bonds and contacts
  /// What supports exert on these particles.
  std::function<Reaction(const std::vector<ParticleId>&)> reaction;
  std::vector<GripView> grips = {};  ///< in the order of the stage's supports
  double released = 0;               ///< by the breaks of a stage of fracture so far  [energy]
  bool relieved = false;             ///< forces that fade with the load factor are part of this balance
};

/// A small movement of all particles: how a mode looks. Scaled so that the largest translation is 1, or if
/// there is none the largest turn.
struct Shape {
  PerParticle<Vec3d> translation;  ///< [length]
  PerParticle<Vec3d> rotation;     ///< [rad]
  friend bool operator==(const Shape&, const Shape&) = default;
};

/// A wave of a periodic body: the image n edges away moves as the particle times exp(2 pi i edges . n).
struct Wave {
  Vec3d q;      ///< the wave vector, in the cell as it stands; no part along open edges  [1/length]
  Vec3d edges;  ///< q . edge / (2 pi) of each edge
  friend bool operator==(const Wave&, const Wave&) = default;
};

/// A limit point or bifurcation of a path.
struct SpecialPoint {
  PointKind kind = PointKind::limit_point;
  double load_factor = 0;
  int point = 0;                       ///< number of the point on the path, from 1
  std::optional<int> unstable_before;  ///< negative eigenvalues of the tangent; absent: not known
  std::optional<int> unstable_after;
  double gap = 0;  ///< the same as of a critical load
  friend bool operator==(const SpecialPoint&, const SpecialPoint&) = default;
};

/// A load at which one more direction of the balance becomes unstable, or nearly so (gap).
struct CriticalLoad {
  PointKind kind = PointKind::bifurcation;  ///< or limit_point: no balance close by carries more
  double load_factor = 0;                   ///< found on the nonlinear path
  std::optional<double> estimate;  ///< linearised about load factor 0; absent where that does not hold
  double force = 0;  ///< load factor times the largest proportional force on a whole group; 0: there is none
  Shape mode;
  /// Of a body that is not quite symmetric: the paths that would cross in the symmetric body miss each other
  /// by this much of the load factor, so that the load factor is known only to about this. 0: they cross.
  double gap = 0;
  /// Of the first support that moves, where one does: how far it has gone, and the force on it along its way,
  /// positive if it pushes; of one that only turns its angle and the moment.  [length], [force]
  std::optional<double> displacement = {}, reaction = {};
  int wave = 0;             ///< of a stage with wave vectors: its number in StaticResult::waves, from 1
  Shape out_of_phase = {};  ///< the imaginary part of the mode of a wave; empty: none
  friend bool operator==(const CriticalLoad&, const CriticalLoad&) = default;
};

struct NaturalMode {
  double omega = 0;    ///< angular frequency [rad/time]; of an unstable mode 0
  double omega2 = 0;   ///< its square; negative: unstable
  bool rigid = false;  ///< a motion of a part of the body as a whole that nothing holds
  Shape shape;
  int wave = 0;             ///< of a stage with wave vectors: its number in StaticResult::waves, from 1
  Shape out_of_phase = {};  ///< the imaginary part of the shape of a wave; empty: none
  friend bool operator==(const NaturalMode&, const NaturalMode&) = default;
};

/// The bond that is nearest to breaking, and how near: 1 breaks.
struct BondUse {
  BondId bond{0};
  ParticleId i{0}, j{0};
  double utilisation = 0, load_factor = 0;
  friend bool operator==(const BondUse&, const BondUse&) = default;
};

/// What used up the strength of a bond, as its criterion counts it.
struct StrengthShares {
  double tension = 0, shear = 0, bending = 0, torsion = 0, compression = 0;
  friend bool operator==(const StrengthShares&, const StrengthShares&) = default;
};

/// Loads of a bond's section, as in physics/section.hpp.
struct BondSection {
  double N = 0, V = 0;      ///< axial force, tension positive; shear force  [force]
  double M_b = 0, M_t = 0;  ///< bending moment at the middle, torque  [force*length]
  friend bool operator==(const BondSection&, const BondSection&) = default;
};

/// A bond that broke at rest. The load is the reaction of the first support that moves, along its motion, or
/// the load factor where none moves. What stands after the break is missing if no balance followed it.
struct BrokenBond {
  int point = 0;      ///< number of the point of balance before the break, from 1
  int avalanche = 0;  ///< from 1; breaks of one need no load beyond that of its first
  BondUse use;        ///< as it broke
  StrengthShares shares;
  BondSection section;
  Vec3d middle, direction;  ///< of the bond: place [length] and unit vector from i to j
  double load = 0;          ///< [force], of moments [force*length], or the load factor
  std::optional<double> load_factor_after, load_after;
  double held = 0;      ///< energy of the bond itself, above rest  [energy]
  double released = 0;  ///< energy that the break took out of the body  [energy]
  double work = 0;      ///< of loads and supports up to the balance after it, from the start  [energy]
  double stored = 0;    ///< in bonds and contacts after it  [energy]
  friend bool operator==(const BrokenBond&, const BrokenBond&) = default;
};

/// Energy of a stage of fracture: initial + work = stored + dissipated + released.  [energy]
struct FractureBooks {
  double initial = 0;     ///< stored when the load factor was 0
  double work = 0;        ///< of loads and supports: summed up along the way, not from the energies
  double stored = 0;      ///< at the end
  double dissipated = 0;  ///< by bonds that yield or soften
  double released = 0;    ///< by all breaks
  double largest = 0;     ///< of these amounts on the way, and of a thousand times their rounding
  /// What is missing, as a part of the largest.
  double error() const {
    return largest > 0.0 ? (initial + work - stored - dissipated - released) / largest : 0.0;
  }
  friend bool operator==(const FractureBooks&, const FractureBooks&) = default;
};

/// What a stage of fracture has found.
struct FractureResult {
  std::string reason;  ///< why it ended, in words; empty if `ended` says all
  std::vector<BrokenBond> breaks;
  int avalanches = 0;
  int largest_avalanche = 0;  ///< most breaks in one
  double peak_load = 0, peak_load_factor = 0;
  int released_parts = 0;  ///< that nothing held any more, and that were held where they were
  FractureBooks books;
  friend bool operator==(const FractureResult&, const FractureResult&) = default;
};

/// How a static stage ended.
struct StaticResult {
  /// "converged", "load factor", "distance", "points", "interrupted"; of buckling "converged" if as many
  /// critical loads were found as were wanted, else why the search ended: "limit point", "load factor",
  /// "bond range", "points", "interrupted"; of fracture "load factor", "breaks", "load drop", "parted",
  /// "lost stability", "interrupted"
  std::string ended;
  double load_factor = 0;         ///< reached
  int points = 0;                 ///< of balance that were handed to the observers
  int iterations = 0;             ///< of Newton's method, all together
  int factors = 0;                ///< of the tangent that were made, all together; path, buckling, fracture
  std::string solver;             ///< "direct" or "multigrid"
  int solver_iterations = 0;      ///< of multigrid, for equations and eigenvalues, all together
  std::optional<int> unstable;    ///< negative eigenvalues of the tangent at the end; absent: not counted
  bool neutral = false;           ///< not unstable, but a motion meets no stiffness at the end
  int free_turns = 0;             ///< of particles at the end, which nothing drives or resists
  bool jumped = false;            ///< it lost its balance between two load steps and went to another one
  bool left_saddle = false;       ///< an unstable balance was met and left
  std::vector<double> residuals;  ///< of the last load factor, iteration by iteration, relative
  std::optional<double>
      smallest_eigenvalue;  ///< of the tangent at the end, turns times the length scale  [force/length]
  std::vector<SpecialPoint> special_points;  ///< path
  std::vector<CriticalLoad> critical_loads;  ///< buckling, smallest first
  double searched_to = 0;  ///< buckling: there are no other critical loads on the path up to this load factor
  std::vector<Wave> waves;  ///< modes, buckling: the wave vectors of the stage
  /// Modes, slowest first; rigid motions before all others. Those of each wave after each other.
  std::vector<NaturalMode> modes;
  /// But of fracture: the most that a bond has used of its strength at any point; absent: none can break. Of
  /// modes at load factor 1, under all their loads.
  std::optional<BondUse> most_used;
  FractureResult fracture;  ///< fracture
  friend bool operator==(const StaticResult&, const StaticResult&) = default;
};

/// A static stage that could not go on; what it had found until then stands.
class StaticStageFailed : public NoEquilibrium {
 public:
  StaticStageFailed(const NoEquilibrium& why, StaticResult until_then)
      : NoEquilibrium(why), found(std::move(until_then)) {}
  StaticResult found;
};

}  // namespace vbond
