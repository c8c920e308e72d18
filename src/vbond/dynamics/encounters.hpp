#pragma once
#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vbond/core/sized_points.hpp"
#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/contact_kernel.hpp"
#include "vbond/dynamics/exchange.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/rigid_bodies.hpp"

namespace vbond {

/// Two particles that do not approach by more than this part of the smallest sum of two radii in a step
/// cannot pass each other without being found deep at the end of a step.
inline constexpr double longest_approach = 0.25;

/// Two particles, not bonded, that were deep in one another at some time of a step.
struct Encounter {
  ParticleId i, j;  ///< i < j
  Vec3d from, to;   ///< r_j - r_i at the start and end of the step; both at its end if neither moves fast
  Image of_j{};     ///< which image of j it is
};

/// The particle that moves farthest in a step, if it is too far for contacts to be seen for certain.
struct FastParticle {
  ParticleId p;
  double way;    ///< in this step, against the mean of all particles  [length]
  double limit;  ///< the longest way at which no pair can pass unseen  [length]
};

/// Finds particles that pass through each other, which contact forces, evaluated once per step, may not see.
/// What it finds depends on positions and velocities only, so a resumed run finds the same. Costs nothing as
/// long as nothing is fast or deep; while something is fast, as much as a rebuild of the contact list.
class Encounters {
 public:
  /// Keeps references to all but supports.
  Encounters(const Model& model, const BondIndex& index, const Exchange& exchange = one_rank(),
             const std::vector<Support>& supports = {});
  Encounters(const Model&&, const BondIndex&) = delete;
  Encounters(const Model&, const BondIndex&&) = delete;

  /// Capsules of this radius and more touch, too.
  void count_capsules(double radius);
  /// Forgets the last step and looks at the one that has just moved the particles: r by dt v.
  /// largest_way2: a bound of |dt v|^2 over all particles. flow: of a cell that moves: what moves with it is
  /// not fast.
  void look_at_drift(const Bodies& bodies, double dt, double largest_way2, const Tensor* flow = nullptr);
  /// Adds pairs that are deep in one another now.
  void add_deep(const Bodies& bodies, const std::vector<std::pair<Row, Row>>& pairs);

  /// All parts get what each has found: for steps in which one has found something.
  void share();
  /// Takes over what another one has found, but for pairs with particles that were dropped since.
  void take(const Encounters& from, const std::vector<ParticleId>& dropped) {
    const auto is_gone = [&](ParticleId p) { return std::binary_search(dropped.begin(), dropped.end(), p); };
    found_ = from.found_, fastest_ = from.fastest_;
    std::erase_if(found_, [&](const Encounter& e) { return is_gone(e.i) || is_gone(e.j); });
  }

  /// Of the last step. After `most` of them it is left at that: one is enough to end a run.
  const std::vector<Encounter>& found() const { return found_; }
  const std::optional<FastParticle>& fastest() const { return fastest_; }
  bool any() const { return !found_.empty() || fastest_; }
  static constexpr std::size_t most = 1000;

 private:
  bool find_fast(const Bodies& bodies, double dt, const Tensor* flow);
  void find_passing(const Bodies& bodies, double dt);
  void take_down(const Encounter& e);
  void add(const Order& order, Row i, Row j, const Vec3d& from, const Vec3d& to);

  const Model& model_;
  const BondIndex& index_;
  const Exchange& exchange_;
  const RigidBodies bodies_;  // nothing passes within one
  double limit_ = 0;          // of a particle's way in a step  [length]
  std::vector<Encounter> found_;
  std::optional<FastParticle> fastest_;
  // Used in steps with fast particles only, kept for their memory.
  std::vector<Row> fast_;
  std::vector<char> is_fast_;
  std::vector<Vec3d> r_;
};

/// The point nearest to the origin on the way of an encounter.
Vec3d nearest_point(const Encounter& e);

}  // namespace vbond
