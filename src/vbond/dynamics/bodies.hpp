#pragma once
#include <span>
#include <vector>

#include "vbond/core/large_array.hpp"
#include "vbond/core/tensor.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/dynamics/rows.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/dynamics/tops.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// The particles of a state as the step loop moves them: sorted, in rows.
struct Bodies {
  /// At rest at the model's first positions.
  explicit Bodies(const Model& model);
  /// In this order, which may be that of a part.
  Bodies(const Model& model, Order order);

  /// Takes positions and velocities over from a state, and gives them back: of a part, those that it moves,
  /// and where its ghosts are.
  void read(const State& state);
  void write(State& state) const;
  Loads collect(const LargeArray<LoadRow>& loads) const;
  void spread(const Loads& loads, LargeArray<LoadRow>& to) const;

  /// From one particle to another, which may touch or be measured.  [length]
  Vec3d between(Row i, Row j) const { return vbond::between(pose[i.value], pose[j.value]); }
  /// From particle i of a bond to its particle j, or to the image that it joins, and how they are turned.
  Vec3d between(const Bond& b) const { return between(order.row_i(b), order.row_j(b)); }
  const Quatd& orientation(Row k) const { return pose[k.value].q; }
  BondPose<double> bond_pose(const Bond& b) const {
    return vbond::bond_pose(b, between(b), orientation(order.row_i(b)), orientation(order.row_j(b)));
  }

  /// Poses of the particles alone, without those that fill up the rows or are not known.
  std::span<const PoseRow> poses() const { return {pose.data(), order.known}; }
  /// flow: of a cell that moves, whose part of velocities does not count.
  Energies kinetic_energy(const Team& team, const Tensor* flow = nullptr) const;
  /// Kinetic energy of the rotation of a particle, if it turned with omega as it stands.
  double rotation_energy(std::size_t row, const Vec3d& omega) const {
    return tops.has(row) ? tops.energy_with(row, pose[row], omega) : 0.5 * inertia[row] * norm2(omega);
  }
  Tops::Rows turning() { return {pose, motion}; }

  Order order;
  LargeArray<PoseRow> pose;
  LargeArray<MotionRow> motion;
  LargeArray<LoadRow> load;
  LargeArray<LoadRow> damping;        ///< the part of the loads that damps, if any bond does; else empty
  LargeArray<LoadRow> local_damping;  ///< the part of these that is local, if bonds damp as well; else empty
  LargeArray<InverseInertia> inverse;
  std::vector<double> mass;     ///< [mass]
  std::vector<double> inertia;  ///< of a top the least of its three  [mass*length^2]
  Tops tops;
};

}  // namespace vbond
