#pragma once
#include <memory>
#include <optional>
#include <string>

#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/work.hpp"
#include "vbond/statics/fracture_under_way.hpp"

namespace vbond {

/// A balance on the way, and what the books need of it.
struct Balance : Stand {
  std::optional<BondUse> most;  ///< nothing if no bond can break
};

/// A body on its way along the load factor, from balance to balance, that loses bonds. Parts that nothing
/// holds any more are held where they are, by as many of their degrees of freedom as can move freely, so that
/// they come to rest without stress from outside and leave the tangent regular.
class BreakingBody {
 public:
  BreakingBody(const Model& model, const StaticStage& stage, State balanced, const StaticHooks& hooks,
               StaticResult& result);
  /// Where such a body was stopped, whose state this is. Throws NoEquilibrium if the stage is not that of
  /// then.
  BreakingBody(const Model& model, const StaticStage& stage, State now, const FractureUnderWay& then,
               const StaticHooks& hooks, StaticResult& result);
  /// All that the last needs.
  void note(FractureUnderWay& now) const;

  StaticBody& body() { return *body_; }
  State take_state() && { return std::move(*body_).take_state(); }
  const TangentSolver& solver() const { return *solver_; }
  double load_factor() const { return body_->load_factor(); }
  /// The reaction of the first support that moves, along its motion, or else of the first wall that does; of
  /// a cell that moves the stress of the first component that is strained, or else of the first that gives
  /// way; the load factor where none moves.
  double load() const;
  /// The largest such reaction in size of all supports and walls that move, or the largest stress of a cell
  /// that is strained and gives way nowhere; nothing where none moves.
  std::optional<double> largest_reaction() const;
  void prepare_solver() { solver_->prepare(*body_); }
  /// Of the tangent that were made.
  int factors() const { return factors_before_ + solver_->factors_made(); }
  bool has_kept_factor() const { return solver_->has_kept(); }
  void drop_kept_factor() { solver_->drop_kept(); }
  Balance here() const;
  std::optional<BondUse> most_used() const;
  void restore(const Balance& b) { body_->restore(b.at); }

  /// Whether the balance is stable, as far as that is known; keeps how the body goes on from here.
  bool is_stable();
  /// How many negative eigenvalues the balance has that is_stable() has judged: 0, or nothing where moments
  /// from outside or friction leave it open.
  std::optional<int> unstable() const { return unstable_; }
  /// The longest step of the load factor from the balance that is_stable() has judged.
  double longest_step() const;
  /// On to a balance at another load factor, from the balance that is_stable() has judged. False, and back,
  /// if there is none close by.
  bool step_to(double load_factor);
  /// After is_stable(): whether the way from there is as long as the tangent here says, and not a jump.
  bool came_smoothly(const Placement& from);
  /// To a balance at a load factor between those of two that are close. False: anywhere.
  bool balance_between(const Placement& a, const Placement& b, double load_factor) {
    return way_here().balance_between(a, b, load_factor);
  }
  /// Lets the body go, at this load factor. False, and back, if it comes to no balance.
  bool settle();
  /// Work of loads, supports and walls from one balance to the other, first that of all, then of each wall:
  /// WorkOnTheWay. Leaves the body at the second.  [energy]
  Vector work_between(const Balance& a, const Balance& b, double scale) {
    return way_here().between(a, b, scale);
  }
  /// The same after a jump at one load factor, without the walls, which then stand still.  [energy]
  double work_of_jump(const Balance& a, const Balance& b) { return way_here().of_jump(a, b); }
  /// Walls have done what is among this work.
  void add_work_of_walls(const Vector& work);

  void break_bond(BondId k, BreakMode mode);
  /// Holds parts that can move freely now, and leaves turns that nothing turns any more alone. Returns what
  /// moves freely under loads, in words, or nothing; then nothing is held.
  std::optional<std::string> hold_free_parts();
  Support& free_grip_of(ParticleId first);

 private:
  bool may_be_stable() const;
  void begin(State state, double load_factor);
  void begin_anew();
  void hold(const HeldPart& part);
  void go_on_with_kept_factor(const FractureUnderWay& then);
  void refuse_another_stage(const FractureUnderWay& then) const;
  double reaction(const Support& s) const;
  double reaction(const WallDrive& d) const;
  std::optional<double> stress_of_cell(CellComponent::By by) const;
  WorkOnTheWay way_here() { return {*body_, *solver_, result_}; }
  bool is_near(const Placement& from, double expected) const;
  bool is_no_jump(const Placement& from, double expected);

  const Model& model_;
  const StaticHooks& hooks_;
  StaticResult& result_;
  std::shared_ptr<Crew> crew_;
  std::unique_ptr<StaticStage> stage_;  // with the supports that hold free parts
  std::vector<HeldPart> held_;          // those
  std::shared_ptr<const State> begun_;  // as body_ was made
  double begun_at_ = 0;                 // load factor then
  std::unique_ptr<StaticBody> body_;
  std::unique_ptr<TangentSolver> solver_;
  int factors_before_ = 0;  // of former solvers
  const Support* moved_ = nullptr;
  Vector rate_;  // movement per load factor; empty: not known
  std::optional<int> unstable_ = 0;
  std::optional<Placement> stable_at_;  // where is_stable() was last, if it was: rate_ is that of this place
};

}  // namespace vbond
