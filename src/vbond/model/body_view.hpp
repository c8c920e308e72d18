#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "vbond/model/body_part.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/grip.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/losses.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

/// The particle that turns farthest in a step, of those that should not.
struct FastTurn {
  ParticleId p;
  double angle;  ///< in this step  [rad]
};

/// Where the energy is, and which bonds need a closer look, and who turns too fast.
struct Survey {
  Energies energies;
  /// Every unbroken bond that is strained or snapped, shorter than half or longer than twice its length at
  /// rest, and perhaps a few that are close to it, in increasing order. Of a body that several processes
  /// share, of the bonds of this one.
  std::vector<BondId> deformed;
  bool any_deformed = false;  ///< anywhere in the body
  /// Of a body in motion the particle that turns by more than longest_turn (model/turn_bound.hpp) in a step,
  /// and farthest of all whose bonds, unequal moments of inertia or group feel it.
  std::optional<FastTurn> fast_turn = {};
};

/// The bonds that a Survey of this state names.
inline std::vector<BondId> deformed_bonds(const State& s) {
  std::vector<BondId> deformed;
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (!b.broken && needs_look(bond_tilt(elastic_pose(s, k), 0.0, 0.0), b.a)) deformed.push_back(k);
  }
  return deformed;
}

/// What is special about a point of balance.
enum class PointKind : std::uint8_t {
  regular,
  limit_point,  ///< the load factor turns back
  bifurcation,  ///< another path crosses, or passes within `gap`; the load factor goes on
  critical,     ///< a bond has reached its strength, and has not broken yet
  broken,       ///< balance again after a bond has broken
  end
};

/// Where on its way a balance is.
struct BalancePoint {
  double load_factor = 0;
  PointKind kind = PointKind::regular;
  std::optional<int> unstable;  ///< negative eigenvalues of the tangent; absent: not counted
  bool relieved = false;        ///< forces that fade with the load factor are part of it
};

/// How much of what a process has of a body is to be as of now.
enum class Show : std::uint8_t {
  bonds,          ///< which there are: places and memories may be old, and it takes no time
  places,         ///< all of its own, and both ends of bonds that hold
  ends_of_broken  ///< and both ends of those that broke, which processes tell each other
};

/// Whether the loads of bonds that broke in the last step count.
enum class LastBreaks : bool { left_out, counted };

/// A body in motion or at rest as those see it who write and watch: Simulation is one, PointView is one of a
/// point of balance. It shows an instant, and is good until the body moves on. Of a body that several
/// processes step, all of them ask the same in the same order, and get the same answers, of the whole body.
class BodyView {
 public:
  virtual ~BodyView() = default;
  virtual const Model& model() const = 0;
  const Clock& clock() const { return known().clock; }
  /// Particles that take no part in the computation, see State; and what has come in and gone.
  const std::vector<ParticleId>& dropped() const { return known().dropped; }
  const std::vector<ParticleId>& taken() const { return known().taken; }
  const std::vector<ParticleId>& waiting() const { return known().waiting; }
  const MassBooks& mass() const { return known().mass; }
  /// Bonds that have broken in this stage of dynamics.
  std::int64_t breaks() const { return known().breaks; }
  const PeakRecord& peak() const { return known().peak; }
  /// The whole state, in the numbering of the model. Collecting it takes time in motion: not for every step;
  /// and of a body that several processes share, memory and messages of the size of the body.
  virtual const State& state() const = 0;
  /// What this process has of it, and all particles nearer than so much to its own: for sums over all. It
  /// takes less than state(); where processes do not know what is so near they tell each other.  [length]
  virtual BodyPart part(Show what = Show::places, double near = 0.0) const = 0;
  /// Those that step the body; one alone of a body at rest.
  const Communicator& processes() const { return part(Show::bonds).all; }
  /// A look at all bonds and particles, so not for every step; made once however often it is asked for.
  virtual const Survey& survey() const = 0;
  /// Of these positions and velocities.
  const Energies& energies() const { return survey().energies; }
  /// As of this call. Those of a balance begin with it: its own energy, what flow and breaks have taken.
  virtual const EnergyBooks& books() const = 0;
  /// Relative error of the energy balance: kinetic + potential + dissipated - work - start, over the largest
  /// energy that start and work have brought in so far, at least what moves and what contacts hold now, and a
  /// thousand roundings. 0 at rest.
  virtual double balance_error() const = 0;
  /// What supports exert on these particles along held degrees of freedom; in motion drag included, the
  /// inertia of prescribed accelerations left out.
  virtual Reaction reaction(const std::vector<ParticleId>& particles,
                            LastBreaks breaks = LastBreaks::left_out) const = 0;
  /// Where walls are, and what presses on them.
  virtual const std::vector<WallState>& walls() const = 0;
  /// The grips of the stage, in the order of its supports.
  virtual std::vector<GripView> grips() const = 0;
  /// Nothing in motion.
  virtual const BalancePoint* balance() const { return nullptr; }

 private:
  /// What is shown of the state here without collecting it: all else in it may be old.
  virtual const State& known() const = 0;
};

/// What its books count as dissipated, by cause. Looks at every bond that remembers something.
inline Losses losses_of(const BodyView& body) {
  Losses lost = body.books().lost;
  return lost += losses_by_flow(body.part());
}

}  // namespace vbond
