#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/dynamics/touch_kernel.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/wall_touch.hpp"

namespace vbond {

/// The walls of a model: how they move, what they do to particles that touch them, and what these do to them.
/// A block adds the loads of walls to its own rows only; loads on walls are added up block by block.
class Walls {
 public:
  /// Keeps references to model, stage and bodies.
  Walls(const Model& model, const Stage& stage, const Bodies& bodies, std::size_t blocks);
  Walls(const Model&&, const Stage&, const Bodies&, std::size_t) = delete;
  Walls(const Model&, const Stage&&, const Bodies&, std::size_t) = delete;

  bool any() const { return !walls_.empty(); }
  /// Takes over what the state says of walls, and gives it back.
  void read(const State& state);
  void write(State& state) const;

  /// From t to t + dt, with the loads at t. The walls' velocities are then those of the half step.
  void move(std::int64_t stage_step, double dt);
  /// Lists anew what is near which wall, if a particle or a wall may have moved by half the skin. way: the
  /// longest of a particle since the last call.  [length]
  void refresh(const Team& team, double way = std::numeric_limits<double>::infinity());
  /// Adds what walls do to the rows of a block, from poses and the motion of the half step before; dt = 0:
  /// between steps, nothing is remembered of it. Returns what is dissipated.
  double add_loads(const Block& block, LoadRow* load, double dt);
  /// Adds up what presses on walls, and returns the work that they have done on particles in a step of dt.
  double close(double dt);

  /// What touches of walls store.  [energy]
  double energy() const;
  const std::vector<WallState>& states() const { return walls_; }

  /// A particle that has passed through a wall in the last step.
  struct Passed {
    ParticleId p;
    std::uint32_t wall;
  };
  std::optional<Passed> passed() const;

 private:
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
    std::vector<Vec3d> F, M;         // on each wall
    std::optional<Passed> passed;
  };

  void list(OfBlock& block, RowRange rows);
  Touching<double> touching(const Near& near, const WallTouch& touch) const;
  double add_touches(OfBlock& block, Near& near, LoadRow& load, double dt);
  Vec3d at_start(std::uint32_t wall, const Vec3d& r) const;
  const TouchNumbers<double>& numbers(const Near& near) const;
  void prescribe(std::size_t wall, double t, double dt);
  void set_velocity(std::size_t wall, std::int64_t stage_step, double dt);

  const Model& model_;
  const Bodies& bodies_;
  std::vector<const WallDrive*> drive_;  // of each wall, or nullptr
  std::vector<WallState> walls_;
  std::vector<WallSurface> surfaces_;
  TouchForms forms_;
  std::vector<std::vector<TouchNumbers<double>>> numbers_;  // of each wall, with each material
  double skin_ = 0, reach_ = 0;
  double room_ = 0;    // no particle or wall has moved half the skin before they have moved so far  [length]
  double extent_ = 0;  // no particle is farther from the centre of a wall  [length]
  std::vector<OfBlock> blocks_;
};

}  // namespace vbond
