#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "vbond/core/rigid_motion.hpp"
#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/by_block.hpp"
#include "vbond/dynamics/free_grip.hpp"
#include "vbond/model/grip.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// The grips of a stage: rigid supports. A particle of one is where the grip has taken it: its pose follows
/// from that in which the grip took hold and the integral of the stage's factor, so that nothing adds up from
/// step to step. In a step it goes along the chord between two such places; at the ends of the step its
/// velocity is that of the circle. Along and about what is free the grip moves as a rigid body by leap-frog:
/// with the sum of the loads on its particles, kicked before and after the drift.
class Grips {
 public:
  /// Keeps references to stage and bodies.
  Grips(const Stage& stage, Bodies& bodies, const Team& team);
  Grips(const Stage&&, Bodies&, const Team&) = delete;

  bool any() const { return !grips_.empty(); }
  /// Takes hold as the stage begins, or goes on as the state says; anew if it has been given another motion.
  void read(const State& state, bool begun);
  void write(State& state) const;

  void set_times(std::int64_t stage_step);
  /// Whether some are free in some degrees of freedom: then these are called, between the blocks, at the
  /// start of a step, with the loads of then, and when all particles have the loads of its end.
  bool any_free() const { return any_free_; }
  void begin_step();
  /// Returns what drag has taken in the step, which is to be added to the work of supports as well.  [energy]
  double finish_step();
  /// Whether some turn freely, so that their particles have other velocities after the drift than before it.
  bool any_turn() const { return any_turn_; }
  /// Blocks with particles of such grips come to the end of their step only after finish_step().
  bool waits(const Block& block) const { return any_free_ && waiting_[block.index] != 0; }
  /// As of Supports.
  double hold(const Block& block, Instant at);
  double hold_after_kick(const Block& block, Instant from, Instant to, double h);
  /// After the drift, which has gone along the chord but for rounding: exactly where and how they belong.
  void carry(const Block& block);
  /// Adds up what they have done in the step.
  void close();

  /// Takes out of a load on one of its particles, and its moment about the origin, what a grip leaves free,
  /// as it stands at this step. Not for supports that are no grip free in part.
  void leave_held(const Support& support, std::int64_t stage_step, Vec3d& F, Vec3d& moment) const;
  /// As they are at this step of the stage: of a part, what its own particles bear.
  std::vector<GripView> views(std::int64_t stage_step) const;

 private:
  struct Place {
    double s = 0;  ///< the integral of the factor
    Vec3d pivot;
    Quatd turn;  ///< since it took hold
  };
  using Rates = GripRates;
  /// What a free grip does in a step, along and about what is free: rates of the pivot.
  struct Free {
    FreeGrip body;
    Rates start, middle_start, middle_end, end;  ///< as it stands at the start, and at the end
    Rates slowed;                                ///< at the end, after drag
  };
  struct Grip {
    const Support* support;
    TimeIntegral path;
    GripState state;
    std::size_t first = 0;  ///< of its particles in members_
    double factor_start = 1, factor_end = 1;
    Place start = {}, end = {};  ///< of the step
    Quatd turn = {};             ///< in the step
    std::optional<Free> free = {};
  };
  struct Member {
    std::size_t row;
    std::size_t grip;
    GrippedPose as_held;
    bool moved = false;  ///< by its grip; else by another one that agrees
  };
  ParticleId particle_of(const Member& m, std::size_t k) const;
  Place place_of(const Grip& grip, double s) const;
  static PoseRow pose_at(const Member& m, const Place& at);
  bool stands_at(const Grip& grip, const Place& now, const State& state) const;
  void take_hold(Grip& grip, double s, const State& state);
  void begin_free(Grip& grip);
  void find_motion(Grip& grip, const Vec3d& pivot);
  Rates loads_on(const Grip& grip, const Vec3d& pivot) const;
  double slow_down(Grip& grip, const Place& place, double factor);
  Rates resting_rates(const Member& m) const;
  Rates rates(const Member& m, Instant at, Instant pose) const;
  double time_of(std::int64_t stage_step) const { return static_cast<double>(stage_step) * stage_.dt; }

  const Stage& stage_;
  Bodies& bodies_;
  std::vector<Grip> grips_;
  std::vector<Member> members_;  // grip by grip, each in the order of its support
  ByBlock held_;                 // indices of members_
  std::vector<double> work_;     // of the step: of each grip in each block
  bool any_free_ = false, any_turn_ = false;
  double lost_ = 0;            // by drag in the step
  std::vector<char> waiting_;  // blocks
};

}  // namespace vbond
