#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/bond_packs.hpp"
#include "vbond/dynamics/damping.hpp"
#include "vbond/dynamics/supports.hpp"
#include "vbond/ranks/holding.hpp"

namespace vbond {

/// What a step adds to the energy books, and NaN if a load is not finite.
struct StepSums {
  double dissipated = 0, work_loads = 0, work_supports = 0, poison = 0;
};

/// The part of a body that a rank moves: rows of its own particles, behind them rows of its ghosts. The step
/// is that of Simulation::step for elastic bonds, supports, loads and drag, with two places where others are
/// heard: ghosts get their poses before the bonds, and what bonds do to ghosts goes to their ranks after
/// them.
class Share {
 public:
  Share(const Model& whole, const Stage& stage, const PerBond<Bond>& bonds, Holding holding);
  Share(const Share&) = delete;
  Share& operator=(const Share&) = delete;

  /// Kick, drift: v and omega to the middle of the step, r and q to its end.
  void move(std::int64_t stage_step);
  /// The loads of the bonds, on ghosts, too. Within a step, bonds that break are added to broken().
  void add_bond_loads(bool in_step);
  /// Bonds that have broken in this step, in no order; they act until they are taken out.
  std::vector<BondId> broken() const;
  void take_out_broken();
  /// Applied loads and the second kick. Returns what the whole step has added.
  StepSums finish();
  /// In place of finish(), between steps: applied loads of this time.
  void add_applied_loads(std::int64_t stage_step);

  /// Rows of the particles of the holding, in its order: first own ones, then ghosts.
  const std::vector<std::uint32_t>& rows() const { return rows_; }
  PoseRow* pose() { return bodies_.pose.data(); }
  LoadRow* load() { return bodies_.load.data(); }
  const std::vector<ParticleId>& particles() const { return particles_; }
  std::size_t own() const { return own_; }
  Motion motion(std::size_t k) const;
  /// Whether a particle has a load that is not finite: the first of them in the numbering of the model.
  std::optional<ParticleId> without_finite_load() const;
  /// The largest squared way that an own particle has gone since this share was made.
  double way2() const;
  double longest_bond() const;

 private:
  void kick(const Block& block);

  std::vector<ParticleId> particles_;
  std::size_t own_;
  Model model_;  // of its own particles
  Stage stage_;  // with these numbers
  Bodies bodies_;
  Team team_;  // own rows
  Team with_ghosts_;
  BondPacks packs_;
  std::vector<HeldBond> held_;
  PerBond<Bond> bonds_;           // of held_, between places
  std::vector<BondId> breaking_;  // of bonds_
  Supports supports_;
  AppliedLoads applied_;
  Damping damping_;
  std::vector<std::uint32_t> rows_;
  std::vector<Vec3d> start_;  // where own particles were
  StepSums sums_;
};

}  // namespace vbond
