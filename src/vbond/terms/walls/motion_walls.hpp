#pragma once
#include <cstdint>
#include <vector>

#include "vbond/dynamics/motion_term.hpp"
#include "vbond/dynamics/touch_kernel.hpp"
#include "vbond/model/contact_masses.hpp"
#include "vbond/terms/walls/term_walls.hpp"
#include "vbond/terms/walls/wall_touch.hpp"

namespace vbond {

/// A particle that is deep in a wall.
struct DeepInWall {
  ParticleId p;
  std::uint32_t wall;
  double overlap;  ///< [length]
};

/// The walls of a model: how they move, what they do to particles that touch them, and what these do to them.
/// A block adds the loads of walls to its own rows only; loads on walls are added up block by block.
class MotionWalls final : public MotionTerm {
 public:
  using Of = WallsTerm;
  explicit MotionWalls(const BodyInMotion& on);

  bool is_there() const override { return !walls_.empty(); }
  bool touches() const override { return true; }
  void read(const State& state) override;
  void write(State& state) const override;

  /// Takes away the walls that the stage has off, and puts back those that it has on again. Books the work
  /// that this does on the body: what their touches store, which goes or comes at once. As the run begins
  /// there is none: such walls have never been there.
  void before_stage(bool run_begins) override;
  /// From t to t + dt, with the loads at t. The walls' velocities are then those of the half step.
  void begin_step() override;
  /// Lists anew what is near which wall, if a particle or a wall may have moved by half the skin. In a step
  /// looks for particles that moved so far that they may have passed a wall that they touch neither before
  /// nor after.
  void particles_moved(double dt, double way) override;
  void add_loads(const Block& block, double dt) override;
  /// Adds up what presses on walls, books the work that they have done, and tells of particles that went
  /// through.
  void end_step(double dt) override;
  /// What touches of walls store.  [energy]
  double energy() const override;

  const std::vector<WallState>& states() const { return walls_; }
  /// Particles of the whole body that overlap a wall by more than this part of their radius beyond what they
  /// did at the first places of both, in order of particles and walls.
  std::vector<DeepInWall> deeper_than(double part) const;

 private:
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
    std::vector<WallTouch> touches;    // scratch
    std::vector<Slot> slots;           // scratch
    std::vector<std::size_t> slot_of;  // scratch: of each touch
    std::vector<Vec3d> F, M;           // on each wall
    std::vector<Slopes> slopes;        // of its touches, of walls with servos
    std::vector<FaultyTouch> faults;
  };

  struct Told {
    std::string who, what, way_out;
  };

  void refresh(double way);
  void look_at_drift(double dt, double way);
  double work_of(double dt);
  Told in_words(const FaultyTouch& found) const;
  std::vector<FaultyTouch> faults() const;
  void list(OfBlock& block, RowRange rows);
  double energy(const Near& near) const;
  Touching<double> touching(const Near& near, const WallTouch& touch) const;
  void match(const Near& near, const std::vector<WallTouch>& touches, const std::vector<Slot>& slots,
             std::vector<std::size_t>& slot_of) const;
  TouchLosses<double> add_touches(OfBlock& block, Near& near, LoadRow& load, double dt);
  Vec3d at_start(std::uint32_t wall, const Vec3d& r) const {
    return vbond::at_start(model_.walls[wall], walls_[wall], r);
  }
  Vec3d velocity_at(std::size_t wall, const Vec3d& r) const {
    const WallState& w = walls_[wall];
    return w.velocity + cross(w.angular_velocity, r - model_.walls[wall].centre - w.displacement);
  }
  const TouchNumbers<double>& numbers(const Near& near) const;
  double speed_kept(std::size_t wall) const;
  void prescribe(std::size_t wall, double t, double dt);
  void set_velocity(std::size_t wall, std::int64_t stage_step, double dt);
  bool has_servo(std::size_t wall) const { return drive_[wall] != nullptr && drive_[wall]->servo; }
  std::vector<OnWall> sums() const;
  void look_at_servo(std::size_t wall, const Slopes& sum, double dt);

  const BodyInMotion on_;
  const Model& model_;
  const Bodies& bodies_;
  ContactMasses masses_;
  std::vector<const WallDrive*> drive_;  // of each wall, or nullptr
  std::vector<WallState> walls_;
  std::vector<WallSurface> surfaces_;
  TouchForms forms_;
  std::vector<std::vector<TouchNumbers<double>>> numbers_;  // of each wall, with each material
  double skin_ = 0, reach_ = 0;
  double dt_before_ = 0;  // of the stage before  [time]
  double room_ = 0;    // no particle or wall has moved half the skin before they have moved so far  [length]
  double extent_ = 0;  // no particle is farther from the centre of a wall  [length]
  double least_radius_ = 0;  // [length]
  std::vector<OfBlock> blocks_;
  std::vector<FaultyTouch> faults_;
};

}  // namespace vbond
