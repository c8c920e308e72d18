#pragma once
#include <optional>
#include <vector>

#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/unknowns.hpp"

namespace vbond {

/// Where all particles are, and the load factor they are there at.
struct Placement {
  PerParticle<Vec3d> r;
  PerParticle<Quatd> q;
  double load_factor = 0;
};

/// A body under the supports and loads of a static stage: where it is, what is out of balance there, and how
/// that changes with the unknowns and with the load factor.
///
/// unbalanced(u, f) = bonds + contacts + constant loads + f * proportional loads - (1 - f) * relief,
/// on the free unknowns. The relief, set by relieve(), is what was out of balance at load factor 0: with it
/// the body starts in balance whatever its history, and at f = 1 it has gone.
///
/// The tangent is the derivative of -unbalanced. Turns do not commute, so its block of a particle's three
/// turns has an antisymmetric part: half the cross product with the moment that bonds leave unbalanced there.
/// In the chart q -> exp(turn) q the second derivative of the energy is the symmetric part alone: that is
/// tangent(). Where no moment is applied the other part vanishes in balance; where a moment fixed in
/// direction is applied it stays, since such a moment has no potential: that is moment_part().
class StaticBody {
 public:
  /// Keeps references to model and stage. All particles come to rest.
  StaticBody(const Model& model, const StaticStage& stage, State state);

  const Model& model() const { return model_; }
  const StaticStage& stage() const { return stage_; }
  const Unknowns& unknowns() const { return unknowns_; }
  /// Positions and bonds as they are now; velocities are zero.
  const State& state() const { return state_; }
  State take_state() && { return std::move(state_); }
  double load_factor() const { return load_factor_; }

  Placement placement() const { return {state_.r, state_.q, load_factor_}; }
  void restore(const Placement& p);
  /// Moves the unknowns by x, and held degrees of freedom by their share of the change of the load factor.
  void move(const Vector& x, double new_load_factor);
  /// From now on what is out of balance fades in proportion to 1 - load factor. At load factor 0.
  void relieve();

  /// What is out of balance on the free unknowns.  [force]
  const Vector& unbalanced() const;
  /// Derivative of unbalanced() with the load factor, supports moving with it.  [force]
  const Vector& load_direction() const;
  /// Symmetric; the pattern stays the same object-wise until pairs touch or part: see pattern_version().
  const SparseMatrix& tangent() const;
  int pattern_version() const;
  /// tangent() plus its antisymmetric part from applied moments, if there are any.
  bool has_moment_part() const;
  SparseMatrix full_tangent() const;

  /// Largest |unbalanced| over the largest force in the body: of bonds, loads and reactions.
  double residual() const;
  /// What rounding alone may leave of residual().
  double residual_of_rounding() const;
  /// Change of the potential of bonds, contacts and loads since `from`, at the present load factor; moments
  /// of fixed direction count as if the turn since then were small.  [energy]
  double potential_change(const Placement& from) const;
  Energies energies() const;
  /// What supports exert on these particles along held degrees of freedom.
  Reaction reaction(const std::vector<ParticleId>& particles) const;

 private:
  struct Evaluation;  // what belongs to the present placement, made when asked for
  const Model& model_;
  const StaticStage& stage_;
  State state_;
  double load_factor_ = 0;
  Unknowns unknowns_;
  // completed by the implementation
};

}  // namespace vbond
