#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/dynamics/touch_kernel.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/wall_touch.hpp"

namespace vbond {

/// A particle that is deep in a wall.
struct DeepInWall {
  ParticleId p;
  std::uint32_t wall;
  double overlap;  ///< [length]
};

/// The walls of a model: how they move, what they do to particles that touch them, and what these do to them.
/// A block adds the loads of walls to its own rows only; loads on walls are added up block by block.
class Walls {
 public:
  /// Keeps references to all.
  Walls(const Model& model, const Stage& stage, const Bodies& bodies, std::size_t blocks,
        const Exchange& exchange = one_rank());
  Walls(const Model&&, const Stage&, const Bodies&, std::size_t) = delete;
  Walls(const Model&, const Stage&&, const Bodies&, std::size_t) = delete;

  bool any() const { return !walls_.empty(); }
  /// Takes over what the state says of walls, and gives it back.
  void read(const State& state);
  void write(State& state) const;

  /// As a stage begins: takes away the walls that it has off, and puts back those that it has on again.
  /// Returns the work that this does on the body: what their touches store, which goes or comes at once. As
  /// the run begins there is none: such walls have never been there.  [energy]
  double put_off_and_on(const Team& team, bool run_begins);

  /// From t to t + dt, with the loads at t. The walls' velocities are then those of the half step.
  void move(std::int64_t stage_step, double dt);
  /// Lists anew what is near which wall, if a particle or a wall may have moved by half the skin. way: the
  /// longest of a particle since the last call.  [length]
  void refresh(const Team& team, double way = std::numeric_limits<double>::infinity());
  /// Looks for particles that moved so far in the step of dt just made, by `way` at most, that they may have
  /// passed a wall that they touch neither before nor after it.
  void look_at_drift(double dt, double way);
  /// Adds what walls do to the rows of a block, from poses and the motion of the half step before; dt = 0:
  /// between steps, nothing is remembered of it. Returns what is lost.
  TouchLosses<double> add_loads(const Block& block, LoadRow* load, double dt);
  /// Adds up what presses on walls, and returns the work that they have done on particles in a step of dt.
  double close(double dt);

  /// What touches of walls store.  [energy]
  double energy() const;
  const std::vector<WallState>& states() const { return walls_; }

  /// Particles that overlap a wall by more than this part of their radius beyond what they did at the first
  /// places of both, in order of particles and walls.
  std::vector<DeepInWall> deeper_than(double part) const;

  /// What ends a run.
  enum class Fault : std::uint8_t {
    passed,    ///< the particle's centre has come through the wall
    fast,      ///< the particle moves by more than its radius in a step near the wall
    too_wide,  ///< the particle is as large as the hollow wall that it touches, or larger
    light      ///< the servo's mass is too small for what the wall touches
  };
  struct FaultyTouch {
    Fault fault;
    std::uint32_t wall;
    ParticleId p;              ///< not of light
    double is = 0, limit = 0;  ///< fast: way and radius [length]; light: mass and least mass [mass]
  };
  /// All of the last step.
  std::vector<FaultyTouch> faults() const;

 private:
  struct Slopes {
    double k = 0, g = 0;  // [force/length], [force*time/length]
  };
  struct OnWall {
    Vec3d F, M;
    Slopes slopes;
  };
  struct Slot {
    Vec3d normal;
    PairHistory history{};
  };
  /// A particle near a wall.
  struct Near {
    std::size_t row;
    std::uint32_t wall;
    std::uint32_t first, last;  // its triangles, in those of the block
    std::vector<Slot> slots;    // where it touches
  };
  struct OfBlock {
    std::vector<Near> near;
    std::vector<std::uint32_t> triangles;
    std::vector<WallTouch> touches;  // scratch
    std::vector<Slot> slots;         // scratch
    std::vector<Vec3d> F, M;         // on each wall
    std::vector<Slopes> slopes;      // of its touches, of walls with servos
    std::vector<FaultyTouch> faults;
  };

  void list(OfBlock& block, RowRange rows);
  double energy(const Near& near) const;
  Touching<double> touching(const Near& near, const WallTouch& touch) const;
  TouchLosses<double> add_touches(OfBlock& block, Near& near, LoadRow& load, double dt);
  Vec3d at_start(std::uint32_t wall, const Vec3d& r) const {
    return vbond::at_start(model_.walls[wall], walls_[wall], r);
  }
  const TouchNumbers<double>& numbers(const Near& near) const;
  void prescribe(std::size_t wall, double t, double dt);
  void set_velocity(std::size_t wall, std::int64_t stage_step, double dt);
  Vec3d pivot_of(std::size_t wall) const { return drive_[wall]->pivot.value_or(model_.walls[wall].centre); }
  bool has_servo(std::size_t wall) const { return drive_[wall] != nullptr && drive_[wall]->servo; }
  std::vector<OnWall> sums() const;
  void look_at_servo(std::size_t wall, const Slopes& sum, double dt);

  const Model& model_;
  const Bodies& bodies_;
  const Exchange& exchange_;
  std::vector<const WallDrive*> drive_;  // of each wall, or nullptr
  std::vector<WallState> walls_;
  std::vector<WallSurface> surfaces_;
  TouchForms forms_;
  std::vector<std::vector<TouchNumbers<double>>> numbers_;  // of each wall, with each material
  double skin_ = 0, reach_ = 0;
  double room_ = 0;    // no particle or wall has moved half the skin before they have moved so far  [length]
  double extent_ = 0;  // no particle is farther from the centre of a wall  [length]
  double least_radius_ = 0;  // [length]
  std::vector<OfBlock> blocks_;
  std::vector<FaultyTouch> faults_;
};

}  // namespace vbond
