#pragma once
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/dynamics/neighbours.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/dynamics/touch_pairs.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/rigid_bodies.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/physics/hertz.hpp"

namespace vbond {

/// Repulsion between overlapping particles, over a neighbour list of its own.
class Contacts {
 public:
  /// Keeps references to all but supports; `index` is asked at a rebuild, so it may be replaced in place.
  Contacts(const Model& model, const Order& order, const BondIndex& index,
           const StepKernel& kernel = step_kernel(), const std::vector<Support>& supports = {});
  Contacts(const Model&&, const Order&, const BondIndex&) = delete;
  Contacts(const Model&, const Order&&, const BondIndex&) = delete;
  Contacts(const Model&, const Order&, const BondIndex&&) = delete;

  /// Pairs nearer than this are listed.  [length]
  double reach() const { return reach_; }
  /// Is there anything to do at all?
  bool any() const { return list_.has_value(); }
  /// Brings the list up to date; to be called whenever positions have changed. One pose per row.
  void refresh(std::span<const PoseRow> pose, const Team& team,
               double way = std::numeric_limits<double>::infinity());
  /// Bonds were made: the set of bonded pairs is no longer the same.
  void bonds_changed();
  /// The contact of two particles.
  struct Touch {
    double energy = 0;  ///< [energy]
    Vec3d force;        ///< on i  [force]
  };
  /// The last bond between these two is broken. Returns what contact this makes of them: nothing if they do
  /// not touch, or did so before, or if the bond was not of this part.
  Touch unbonded(Row i, Row j, const Bodies& bodies);
  /// Lists the pairs that unbonded() has named, once all bonds that broke in a step have been told.
  void list_unbonded(const Bodies& bodies, const Team& team);
  /// Adds to the loads of these rows, and to no others, the forces of all that touch them, in increasing
  /// order of rows: the bits do not depend on how rows are shared out, nor on when the list was built. `pose`
  /// and `load` are those of all rows.  [force]
  /// Returns whether two of them are nearer than deep_part of the sum of their radii.
  bool add_loads(RowRange rows, const PoseRow* pose, LoadRow* load);
  /// Whether pairs do more than repel each other elastically: then work_out() comes before add_loads().
  bool are_touches() const { return touches_.has_value(); }
  /// Which blocks work_out() takes first, as TouchPairs says.
  bool goes_first(std::size_t block) const { return touches_->goes_first(block); }
  /// What touching pairs of these rows of a block do, from poses and the motion of the half step before; dt =
  /// 0: between steps, nothing is dissipated. Then add_loads() adds it.
  TouchSums work_out(RowRange rows, const Bodies& bodies, double dt) {
    return touches_->work_out(rows, bodies, dt);
  }
  /// What pairs remember, in order of particles.
  std::vector<PairMemory> collect() const;
  /// Takes it up again, after refresh().
  void restore(const std::vector<PairMemory>& memories);
  /// The pairs of these rows that are so near, each from the side of its lower row.
  std::vector<std::pair<Row, Row>> deep_pairs(RowRange rows, std::span<const PoseRow> pose) const;
  /// Each pair once.  [energy]
  double energy(const Bodies& bodies) const;
  /// Of these two.  [energy]
  double energy(Row i, Row j, const Bodies& bodies) const;

 private:
  void unbonded_in_body(Row i, Row j, const Bodies& bodies);
  bool are_one(Row i, Row j) const {
    return bodies_.any() &&
           bodies_.are_one(order_.particle[i], order_.particle[j], order_.image(j) - order_.image(i));
  }

  const Model& model_;
  const Order& order_;
  const BondIndex& index_;
  const StepKernel& kernel_;
  PerRow<double> radius_;  // [length]
  ContactRule rule_{};
  double reach_ = 0;
  std::optional<NeighbourList> list_;          // none without contacts
  std::vector<std::pair<Row, Row>> unbonded_;  // to be listed
  std::optional<TouchPairs> touches_;          // if pairs do more than ContactRule says
  RigidBodies bodies_;                         // whose pairs are not listed
  std::vector<PairMemory> at_rest_;            // of such pairs
};

}  // namespace vbond
