#pragma once
#include <cstdint>
#include <vector>

#include "vbond/core/rigid_motion.hpp"
#include "vbond/model/body_view.hpp"
#include "vbond/model/state.hpp"
#include "vbond/statics/detail/rest_term.hpp"
#include "vbond/terms/walls/resting_walls.hpp"
#include "vbond/terms/walls/term_walls.hpp"

namespace vbond {

class StaticBody;

/// Walls of a stage at rest: what they do to particles, and how they move with the load factor.
class RestWalls final : public RestTerm {
 public:
  using Of = WallsTerm;
  /// Keeps references; state: that of the body.
  RestWalls(const StaticBody& body, State& state);

  bool is_there() const override { return walls_.any(); }
  void take_hold() override;
  void follow() override;
  void add_loads(LoadSum& to) const override;
  void add_stiffness(StiffnessSum& to) const override;
  double energy() const override { return walls_.energy(state_); }
  /// What presses on walls, for those who look at this balance; and where particles are before they go on.
  void accept() override;
  /// The first particle whose centre has come through a wall since the last accepted balance, or that does
  /// not fit into a hollow one.
  std::optional<std::string> fault() const override;
  /// How far particles would go towards or along walls: the way over the radius, of those that do not touch
  /// over the radius and twice the gap. Nothing passes a wall by less than 1.
  double largest_change(const Vector& x, double load_factor_change) const override;
  /// Along the normal, hollow ones also across it: all touches; to come: also places that are no farther from
  /// a particle than walls come in the stage.
  void add_holds(bool to_come, std::vector<TermHold>& to) const override;

  /// Whether some move with the load factor.
  bool moves() const { return !driven_.empty(); }
  /// What each wall does along its motion, per load factor.  [energy]
  Vector power() const;
  /// Of the particles on a wall.  [force]
  Vec3d force_on(std::size_t wall) const { return at_hand().on_walls[wall].force; }
  void add_work(const Vector& work);

 private:
  /// A wall that moves: as it was when the stage took hold of it, and how it goes on from there.
  struct Driven {
    const WallDrive* drive;
    RigidMotion motion;
    WallState as_held;
  };
  /// What touches where the body stands.
  struct Touched {
    std::vector<RestingTouch> touches;
    std::vector<Reaction> on_walls;  // of particles, moments about the walls' centres
  };

  const Touched& at_hand() const;
  Vec3d centre_of(std::size_t wall) const;
  double since() const;
  Vec3d rate_of(std::size_t wall, const Vec3d& r) const;
  double farthest_way() const;

  const StaticBody& body_;
  State& state_;
  RestingWalls walls_;
  std::vector<Driven> driven_;
  PerParticle<Vec3d> seen_at_;         // particles at the last accepted balance
  std::vector<WallState> seen_walls_;  // and the walls
  mutable Touched touched_;            // of the placement with this number
  mutable std::uint64_t touched_at_ = 0;
};

}  // namespace vbond
