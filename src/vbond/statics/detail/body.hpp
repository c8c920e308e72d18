#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/rigid_motion.hpp"
#include "vbond/model/grip.hpp"
#include "vbond/model/holds.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/physics/tangent.hpp"
#include "vbond/statics/detail/assembly.hpp"
#include "vbond/statics/detail/bond_shares.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/detail/placement.hpp"
#include "vbond/statics/detail/rigid.hpp"
#include "vbond/statics/detail/touching_list.hpp"
#include "vbond/statics/detail/unknowns.hpp"
#include "vbond/terms/detail/rest_terms.hpp"

namespace vbond {

inline bool moves(const Support& s) {
  return s.velocity != Vec3d{} || s.angular_velocity != Vec3d{};
}
/// How far it goes per load factor: its displacement, or if there is none its turn.  [length], [rad]
inline double way_of(const Support& s) {
  const double along = norm(s.velocity);
  return along > 0.0 ? along : norm(s.angular_velocity);
}

/// Turns, held ones among them, that nothing drives or resists: of particles without bonds that are of no
/// rigid support which is free in part, about axes along which no moment acts. At rest contacts and walls
/// push towards the centre.
std::vector<Unknowns::Place> idle_turns(const Model& model, const StaticStage& stage, const State& state);

/// What two particles that touch do to each other, j by this image, and how that changes.
PairTangent<3> touch(const Model& m, const State& s, ParticleId i, ParticleId j, const Image& of_j);

/// A body under the supports and loads of a static stage: where it is, what is out of balance there, and how
/// that changes with the unknowns and with the load factor f.
///
/// unbalanced = bonds + contacts + terms + constant loads + f * proportional loads - (1 - f) * relief
///
/// on the free unknowns. What walls and temperatures are, which follow from f, is in the terms. The relief,
/// set by relieve(), is what was out of balance at f = 0: with it the body starts in balance whatever its
/// history, and at f = 1 it has gone.
///
/// The tangent is the derivative of -unbalanced. Turns do not commute, so its block of a particle's three
/// turns has an antisymmetric part, half the cross product with the moment that bonds leave unbalanced there.
/// In the chart q -> exp(turn) q the second derivative of the energy is the symmetric part alone: that is
/// tangent(). In balance the other part vanishes where no moment acts from outside. A moment of fixed
/// direction, or that of a support which holds one turn of a particle and leaves two, is not the derivative
/// of any potential: its part stays, and full_tangent() has it. So is a load that turns with a particle; the
/// symmetric part of what it does is in tangent().
class StaticBody {
 public:
  /// Keeps references to model and stage. All particles come to rest. The state is that at this load factor.
  StaticBody(const Model& model, const StaticStage& stage, State state, double load_factor = 0.0);
  StaticBody(const StaticBody&) = delete;
  StaticBody& operator=(const StaticBody&) = delete;
  /// From now on these threads sum up what bonds do; what comes of it does not depend on their number.
  void sum_with(std::shared_ptr<Crew> crew);

  const Model& model() const { return model_; }
  const StaticStage& stage() const { return stage_; }
  const Unknowns& unknowns() const { return unknowns_; }
  /// Positions and bonds as they are now; velocities are zero.
  const State& state() const { return state_; }
  Clock& clock() { return state_.clock; }
  State take_state() && { return std::move(state_); }
  double load_factor() const { return load_factor_; }
  /// That at which the stage took hold of the body.
  double held_at() const { return held_at_; }
  /// What acts on it besides bonds, contacts and loads.
  const RestTerms& terms() const { return terms_; }
  RestTerms& terms() { return terms_; }
  /// Whether the stage moves the cell; components that give way to a stress are unknowns.
  bool moves_cell() const { return stage_.cell.any(); }
  bool has_free_cell() const { return unknowns_.has_cell(); }
  /// Whether the cell is turned inside out, or about: F, symmetric or triangular, is not positive any more,
  /// or nearly so, and a balance of the cell there says nothing of its stress.
  bool has_collapsed() const;

  Placement placement() const { return {state_.r, state_.q, load_factor_, state_.cell}; }
  /// Another number whenever the body has been moved, or bonds have gone.
  std::uint64_t placement_number() const { return placement_number_; }
  void restore(const Placement& p);
  /// Moves the unknowns by x, and held degrees of freedom by their share of the change of the load factor.
  void move(const Vector& x, double new_load_factor);
  /// Whether bonds yield or soften here. They remember: what they have done until the last accepted balance
  /// stands, and every placement is judged by what they do on the way from there, whatever lies between.
  bool flows() const { return flows_; }
  /// The body as it stands is the balance from which it goes on. Until it moves its tangent stays that of the
  /// way that led here: what has flowed goes on flowing.
  void accept();
  /// From now on what is out of balance at this moment fades in proportion to 1 - load factor.
  void relieve();
  /// What was out of balance: forces at load factor 0, and whether they have moments beyond rounding.
  struct Relief {
    Vector forces;  ///< empty: none
    bool turns = false;
  };
  /// From now on this is what fades. Returns what did before.
  Relief relieve(Relief relief);
  /// Pairs that the tangent has room for.
  const std::vector<Assembly::Pair>& pattern() const { return pattern_; }
  /// Of a body that flows: what bonds remembered at the accepted balance before this one.
  const PerBond<BondHistory>& remembered_before() const { return accepted_before_; }
  /// What the tangent at hand was summed up with instead, before the body was accepted; empty: nothing else.
  const PerBond<BondHistory>& remembered_of_tangent() const { return of_tangent_; }
  /// Sums up the tangent with that, if there is any.
  void take_tangent_of(PerBond<BondHistory> remembered);
  /// A body as it was made, on the way to where it was stopped: the tangent has this room.
  void make_room_for(std::vector<Assembly::Pair> pairs, bool flows);
  /// Of such a body, which does not flow: more bonds have broken, and it stands here.
  void stand_as_then(const Placement& at, const std::vector<BondId>& broken);
  /// Of such a body: where it was stopped, at an accepted balance, to the last bit.
  void go_on_from(State now, double load_factor, std::int64_t breaks, PerBond<BondHistory> remembered_before);
  /// The largest force of what is left of the relief, over the largest force in the body.
  double relief_here() const;
  /// Whether some of it is still there.
  bool is_relieved() const { return relief_.forces.size() > 0 && load_factor_ < 1.0; }

  /// Where the unknowns of a particle are in a placement: at its centre, or at the pivot of the rigid support
  /// that moves with them.
  Vec3d seat(ParticleId p, const Placement& at) const;

  /// What a support exerts, over the largest force in the body.
  double share_held(const Support& support) const;
  /// What is out of balance on the free unknowns.  [force]
  const Vector& unbalanced() const { return loads_at_hand().unbalanced; }
  /// Largest |unbalanced| over the largest force in the body: of a bond, a contact or a load. NaN if any of
  /// them is not finite, so that it passes no test of being small.
  double residual() const;
  /// The same without what acts along these orthonormal columns.
  double residual_beside(const DenseMatrix& columns) const;
  /// What rounding of positions may leave of residual().
  double residual_of_rounding() const;
  /// Whether what is out of balance at each particle is no more than rounding leaves of its loads, by the
  /// stiffness of its bonds and contacts. An unstressed body has no force that this could be a part of.
  bool rests_to_rounding() const;

  /// Symmetric part of the tangent.  [force/length]
  const SparseMatrix& tangent() const { return stiffness_at_hand().assembly.matrix(); }
  /// Of each bond and contact with an image: the symmetric part of its block, in the axes of the unknowns of
  /// i and j, as tangent() has it. The image is the second particle.
  void for_image_blocks(const std::function<void(ParticleId i, ParticleId j, const Image& of_j,
                                                 const Assembly::Block& K)>& visit) const;
  /// A block of a pair over the world's axes in those of its unknowns.
  Assembly::Block in_axes(ParticleId i, ParticleId j, const Assembly::Block& in_world) const {
    return stiffness_.assembly.in_axes(i, j, in_world);
  }
  /// What a bond adds to tangent() among these unknowns, those of its ends, and what its ends add where they
  /// touch.
  DenseMatrix tangent_of(BondId k, const std::vector<int>& unknowns) const;
  /// Changes when the pattern of tangent() does: when pairs begin to touch.
  int pattern_version() const { return stiffness_at_hand().assembly.version(); }
  /// Derivative of unbalanced() with the load factor, supports moving with it.  [force]
  const Vector& load_direction() const { return stiffness_at_hand().load_direction; }
  /// The largest entry of the antisymmetric part that outside moments, loads that turn with a particle, and
  /// friction leave in balance, here.  [force/length]
  double moment_part() const;
  bool has_moment_part() const { return moment_part() > 0.0; }
  /// The same of the friction of cracked bonds that slip, which is among it.
  double friction_part() const { return stiffness_at_hand().friction; }
  /// Whether full_tangent() is another matrix: with such moments, or where bonds flow. Those of which one
  /// load's flow weakens another, as stretching does when a bond softens, have a tangent without symmetry.
  bool is_unsymmetric() const { return flows() || has_moment_part(); }
  /// tangent() with the antisymmetric part.
  SparseMatrix full_tangent() const;

  bool places_are_finite() const;
  /// The first particle, bond or contact whose place, load or energy is not finite, and what it is, e.g.
  /// "bond 3 (particles 3, 4): its loads are not finite, its bonded points are 0 apart"; empty if all are.
  std::string first_not_finite() const;

  /// Energy of bonds and contacts.
  const Energies& energies() const;
  /// What bonds have dissipated by flowing since they were made.  [energy]
  double dissipated() const;
  /// Potential of bonds and contacts for the way from the last accepted balance: what is stored, and what is
  /// dissipated, which of bonds that yield is least where they are at their limits.
  double potential() const { return energies().potential() + dissipated(); }
  /// Change of the potential of bonds, contacts and loads from a placement where potential() was this to
  /// the present one, at the present load factor. A moment works on the turn in between as on a small one.
  double potential_change(const Placement& from, double energy_from) const;
  /// Derivatives of the energy with the six components of the cell's deformation gradient, where particles
  /// are; zero if the stage leaves the cell alone.  [energy]
  std::array<double, 6> forces_on_cell() const;
  /// The cell's components here.
  std::array<double, 6> cell_components_now() const {
    return cell_components(cell_gradient(model_.cell, state_.cell));
  }
  /// Work of the loads on the way between two placements, at this load factor; the relief is not among
  /// them. A moment works on the turn in between as on a small one.  [energy]
  double work_of_loads(const Placement& from, const Placement& to, double load_factor) const;
  /// The same of the relief.
  double work_of_relief(const Placement& from, const Placement& to, double load_factor) const;
  /// What a support does along its motion, per load factor.  [energy]
  double power_of(const Support& support) const;
  /// The same of all supports, where several hold a degree of freedom that of one.
  double power_of_supports() const;
  /// The force of a support along its displacement, or if there is none its moment about its turn.
  double reaction_along_motion(const Support& support) const;
  /// How the held translations of one of a support's particles go, per load factor.  [length]
  Vec3d rate_of(const Support& support, ParticleId p) const;
  /// Whether rigid supports are free in some degrees of freedom.
  bool has_free_grips() const;
  /// Grips of the stage, without their work.
  std::vector<GripView> grips() const;
  /// How grips have turned in the stage, and that they had before this body took hold of them: those of the
  /// first supports.
  std::vector<Quatd> turns_of_grips() const;
  void set_turns_before(const std::vector<Quatd>& turns);
  std::vector<Quatd> turns_before() const;
  /// What a term cannot go on with here, e.g. a particle whose centre has come through a wall.
  std::optional<std::string> fault_of_terms() const;
  /// Loads at this load factor, on the free unknowns.  [force]
  Vector applied(double load_factor) const;
  /// Of these what is not of terms: point loads and gravity.
  Vector applied_loads_alone(double load_factor) const { return on_unknowns(applied_loads(load_factor)); }
  /// The bond is there no more.
  void break_bond(BondId k, BreakMode mode);
  /// Whether bonds have broken and left turns that nothing drives or resists among the unknowns.
  bool turns_come_free() const;
  /// How many bonds that was done to.
  std::int64_t breaks() const { return breaks_; }
  /// What rounding may make of it.  [energy]
  double rounding_of_potential() const {
    return rounding_of_potential_ + (terms_.all().empty() ? 0.0 : loads_at_hand().rounding_of_potential);
  }

  /// How far x would turn or stretch bonds at most: |change of the vector between centres| / its length, and
  /// the angle between the turns of its ends; of particles without bonds the movement over the length scale,
  /// and the turn. Held degrees of freedom move with the change of the load factor. A linear step is a good
  /// guess up to some 0.3.
  double largest_bond_change(const Vector& x, double load_factor_change = 0.0) const;
  /// The same by what terms can tell.
  double largest_change_of_terms(const Vector& x, double load_factor_change = 0.0) const;
  /// The largest strain that terms impose on bonds per load factor.
  double imposed_strain() const;
  /// How a particle moves with these unknowns and what is held with the load factor.
  Movement movement(ParticleId p, const Vector& x, double load_factor_change) const;
  /// How its held degrees of freedom move per load factor.
  const Movement& held_rate(ParticleId p) const { return held_rate_[p]; }
  /// What a force on the second of a pair, this image of it, does to a cell that moves.
  void add_image(const Image& n, const Vec3d& force, LoadSum& to) const;
  /// What supports exert on these particles along held degrees of freedom.
  Reaction reaction(const std::vector<ParticleId>& particles) const;

 private:
  struct Loaded : LoadSum {  // without relief
    Vector unbalanced;
    PerParticle<Vec3d> inside;  // of the forces those of pairs of one rigid group; empty: there are no groups
  };
  /// A rigid support: its pose is that in which it took hold, moved with the load factor since then; of one
  /// that is free in part it is that of its first particle.
  struct Grip {
    const Support* support;
    RigidMotion motion;
    std::vector<GrippedPose> as_held;
    Vec3d pivot;                  // where it stands
    Quatd turn;                   // since it took hold
    Quatd before = {1, 0, 0, 0};  // turn in the stage until then
  };
  struct Stiffness : StiffnessSum {
    DenseMatrix skew;     // of the cell's rows over all unknowns: the antisymmetric part of the tangent
    double friction = 0;  // the largest entry of the antisymmetric part of cracked bonds that slip
    bool current = false;
  };
  template <class Visit>
  void for_touching(Visit&& visit) const {
    touching_.for_each(model_, state_, visit);
  }
  const Loaded& loads_at_hand() const;
  void push(ParticleId i, ParticleId j, const Image& of_j, const Vec3d& F, Loaded& l) const;
  void add_bonds(Loaded& l) const;
  void add_bonds_in_lanes(Stiffness& s) const;
  const Stiffness& stiffness_at_hand() const;
  void add_applied(double load_factor, Loads& loads) const;
  Loads applied_loads(double load_factor) const;
  void lay_out() const;
  void lay_out_for(std::vector<Assembly::Pair> pairs) const;
  void clear_stiffness() const;
  void begin_load_direction() const;
  bool is_plain(ParticleId p) const;
  void find_places() const;
  void add_pair(ParticleId i, ParticleId j, const Image& of_j, const Assembly::Block& d) const;
  void add_arms() const;
  void add_followers() const;
  Assembly::Block follower_block(const PointLoad& l, ParticleId p) const;
  void for_followers(const std::function<void(int row, int column, double K)>& entry) const;
  Loads moments_at_carriers() const;
  Vector on_unknowns(const Loads& loads) const;
  PerParticle<double> rounding_at_particles() const;
  void placed();
  void flow();
  void leave_faces(BondId k);
  const BondHistory& history_before(BondId k) const;
  Vec3d outside_moment(ParticleId p, const Loads& applied) const;
  void add_power(const Support& support, ParticleId p, const HeldDofs& held, const HeldAxes* axes,
                 double& power) const;
  void take_hold();
  void carry();
  void carry_free(const Vector& x, double load_factor_change);
  static void place(const Grip& grip, const Vec3d& pivot, const Quatd& turn, State& state);
  void look_at_grips();
  double angle_of(const Grip& grip) const;
  void set_held_rates();
  void take_hold_of_cell();
  void note_rounding_of_cell();
  void carry_cell(const Vector& x, double new_load_factor);
  Tensor cell_basis(std::size_t component) const;
  double cell_rate(std::size_t component) const;
  Tensor cell_change(const Vector& x, double load_factor_change) const;
  Vec3d image_at_start(const Image& n) const;
  void balance_cell(Loaded& l) const;
  SymmetricParts wanted_stress(double load_factor) const;
  Tensor load_on_cell(const Tensor& of_cell) const;
  void look_at_mixing() const;
  void add_image(ParticleId i, ParticleId j, const Image& n, const Assembly::Block& in_world) const;
  void add_of_cell(const Assembly::CellBlock& own) const;
  void add_own_of_cell() const;
  void add_skew_of_cell(SparseMatrix& K) const;
  double work_on_cell(const Placement& from) const;

  const Model& model_;
  const StaticStage& stage_;
  State state_;
  double load_factor_ = 0;
  std::uint64_t placement_number_ = 1;
  double held_at_ = 0;  // load factor at which grips took hold
  std::vector<Grip> grips_;
  std::vector<Hold> holds_;
  Unknowns unknowns_;
  RestTerms terms_;
  std::array<double, 6> cell_found_{};  // components at held_at_
  Relief relief_;
  PerParticle<char> bonded_;
  BondShares shares_;
  // of bodies that flow: what bonds remembered at the last accepted balance, and at the one before it
  PerBond<BondHistory> accepted_, accepted_before_;
  PerBond<BondHistory> of_tangent_;  // remembered_of_tangent()
  Placement accepted_at_;
  bool flows_ = false, at_accepted_ = false;
  std::int64_t breaks_ = 0;
  mutable std::vector<Assembly::Pair> pattern_;  // lay_out()
  PerParticle<Movement> held_rate_;              // of held degrees of freedom per load factor
  double rounding_of_force_ = 0, rounding_of_potential_ = 0;
  mutable TouchingList touching_;
  mutable std::optional<Loaded> loaded_;
  mutable Stiffness stiffness_;
  mutable PerBond<Assembly::Place> place_in_tangent_;  // of those that go in lanes, in this layout:
  mutable int places_of_ = 0;
  mutable std::optional<Energies> energies_;  // where it stands
  mutable std::array<Tensor, 6> cell_row_{};  // what the rows of the cell sum up: look_at_mixing()
};

}  // namespace vbond
