#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/tensor.hpp"
#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// How the cell of a periodic body moves. A particle has the velocity L r of the cell, L = dH/dt H^-1 with
/// the edges as columns of H, and a part of its own. Edges go at constant rates in a step, so that bodies
/// that move with them feel no inertia; where the rates change between two steps, particles change their
/// velocities with them, and keep their own parts. The cell does the work (V sigma - M C C) : L. The stress
/// sigma counts the momentum that own parts carry beyond their mean C by mass, with which the body of mass M
/// drifts through its cell: that is no stress, but the cell changes it as all own parts.
class CellMotion {
 public:
  /// Keeps references to all; the edges are those of the state, and move alike in all parts of the body.
  CellMotion(const Model& model, const Stage& stage, Bodies& bodies, CellEdges& cell,
             const Exchange& exchange);

  /// Whether the cell moves in this stage, or moved as it began.
  bool any() const { return any_; }
  /// Before the step: edges and velocities. step: of the stage.
  void begin_step(std::int64_t step, const Team& team);
  /// The sums over images of how many of each edge they are away times the force on them, before that goes to
  /// their particles; and times the part of it by which bonds damp.  [force]
  using OfEdges = std::array<Vec3d, 3>;
  void take_forces(const OfEdges& edges_times_force) { forces_ = edges_times_force; }
  void take_damping(OfEdges edges_times_force);
  struct Done {
    double work = 0;     ///< of the cell, on the whole body  [energy]
    double damping = 0;  ///< taken by the damping of bonds, of what images move with the cell  [energy]
  };
  /// After it, once all loads are complete. Returns what the step has done.
  Done end_step(const Team& team);
  /// What is wrong with the edges after that: no volume is left, or they change too much in a step.
  std::optional<std::string> fault() const;
  /// It comes to rest, where the stage does not move it: particles keep their own velocities.
  void stop(const Team& team);
  /// The virial of the particles as they stand: as a stage begins, or after a change of the body.
  void look(const Team& team);
  /// That of a state that goes on is known; how the body drifts follows from its velocities.
  void look_at_drift(const Team& team) { drift_ = virial(team, L_end_).drift; }
  /// A pair of a particle and this image gives up this force on the particle, and this part of it that damps.
  void take_out(const Vec3d& r_ij, const Image& image_j, const Vec3d& F, const Vec3d& damping);
  /// Loads are gone whose sum of F (x) r over particles and images of the whole body is this.  [energy]
  void take_out(const Tensor& virial);

  /// What the cell adds to velocities: v - L r is a particle's own; at the start or the end of the step.
  /// [1/time]
  const Tensor& L_start() const { return L_start_; }
  const Tensor& L_end() const { return L_end_; }

 private:
  std::array<double, 6> rates(double time) const;
  /// What the cell works against, and the part of it that is stress.
  struct Virial {
    Tensor stress;  ///< V sigma  [energy]
    Tensor drift;   ///< M C C  [energy]
  };
  Virial virial(const Team& team, const Tensor& L) const;
  void add_flow(const Tensor& flow, const Team& team);
  void keep(const Virial& virial);
  Tensor kept() const;

  const Model& model_;
  const Stage& stage_;
  Bodies& bodies_;
  CellEdges& cell_;
  const Exchange& exchange_;
  bool any_ = false;
  Tensor L_start_, L_end_;
  Tensor drift_;  // of the last look  [energy]
  OfEdges forces_{}, damping_before_{};
};

}  // namespace vbond
