#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "vbond/core/crew.hpp"
#include "vbond/statics/detail/newton.hpp"
#include "vbond/statics/fracture_under_way.hpp"
#include "vbond/statics/statics.hpp"

/// The kinds of static stages, one file each; run_static_stage() chooses among them. This header also has
/// the few things that they share.
namespace vbond {

// In equilibrium.cpp:
StaticOutcome find_equilibrium(const Model& model, const StaticStage& stage, State state,
                               const StaticHooks& hooks);

/// The body under the stage's constant loads only, its supports where they are, brought to balance: where
/// path, buckling and modes begin. Adds to result.iterations. Nothing if interrupted. Throws NoEquilibrium.
struct Balanced {
  State state;
  std::vector<Quatd> grip_turns;  ///< how grips have turned on the way there
};
std::optional<Balanced> balance_of_constant_loads(const Model& model, const StaticStage& stage, State state,
                                                  const StaticHooks& hooks, StaticResult& result);

// In path.cpp:
/// Follows the balance with the load factor by its arc-length, through limit points and, if asked for, off
/// along a branch at a bifurcation.
StaticOutcome follow_path(const Model& model, const StaticStage& stage, State state,
                          const StaticHooks& hooks);

// In buckling.cpp:
/// The first stage.count load factors at which the balance that starts from load factor 0 stops being unique.
StaticOutcome find_critical_loads(const Model& model, const StaticStage& stage, State state,
                                  const StaticHooks& hooks);

/// Whether a bond is bent, twisted, or longer or shorter than any law reaches, or just as much: a critical
/// point there is the end of a law.
bool any_bond_beyond_its_law(const State& state);

// In modes.cpp:
/// Natural frequencies and shapes about the balance of the stage's loads, all of them taken as constant.
StaticOutcome find_modes(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks);

// In fracture.cpp:
/// Breaks bonds one by one, each where the balance along the load factor brings it to its strength. then: the
/// stage goes on in this state; null: it begins.
StaticOutcome break_at_rest(const Model& model, const StaticStage& stage, State state,
                            const StaticHooks& hooks, const FractureUnderWay* then);

// In kinds.cpp:
/// Two utilisations no further apart than this part of them are taken as equal: a balance is exact to some
/// 1e-10 of the largest force, and the loads of a bond may be smaller than that force.
inline constexpr double same_use = 1e-8;

/// The bond that uses up most of its strength, the first of equals; nothing if none can break.
std::optional<BondUse> most_used_bond(const State& state, double load_factor);

/// How a stage ends that was interrupted before its first point, in the state where it began, at rest.
StaticOutcome interrupted_outcome(StaticResult result, State state);

/// Throws NoEquilibrium if supports hold everything.
void refuse_nothing_free(const StaticBody& body);

/// Throws NoEquilibrium, naming the particle or bond, if a place, load or energy is not finite. Loads are
/// those at hand, and the energy is summed up: in proportion to the body, nothing beside a factor.
void refuse_not_finite(const StaticBody& body);

/// Which parts of the body neither supports nor walls hold; empty if there are none.
std::string free_motions_in_words(const StaticBody& body);

/// Which components of a cell that should give way to a stress have no stiffness: "; nothing resists
/// component yy of the cell", empty if all have one.
std::string loose_cell_in_words(const StaticBody& body);

/// The first six of these, and how many there are besides.
std::string first_of(const std::vector<std::string>& names);

/// Throws NoEquilibrium, naming them, if parts of the body can move freely as rigid bodies.
void refuse_rigid_motions(const StaticBody& body);

/// The stage of a periodic body, with what floats held: parts that nothing holds and that no load drives are
/// held where they are, by as many of their degrees of freedom as can move freely. Such supports carry
/// nothing, as long as nothing touches these parts. Throws NoEquilibrium where loads drive such a part.
StaticStage with_floating_held(const Model& model, const StaticStage& stage, const State& state,
                               const StaticHooks& hooks);

/// What with_floating_held() has added.
std::vector<HeldPart> floating_held(const StaticStage& stage);
/// The stage with that, of all that it held.
StaticStage with_held(const StaticStage& stage, const std::vector<HeldPart>& parts);
/// The support that holds this, where it is not that of a grip.
Support support_of(const HeldPart& part);

/// The stage without what with_floating_held() has added.
StaticStage without_floating_held(StaticStage stage);

/// The stage with what a body in balance begins it with: its stress, from which components of its cell that
/// give way go on, and how its grips have turned.
StaticStage stage_from(const Model& model, const StaticStage& stage, const Balanced& balanced);

/// Tells the user something about this stage, if anybody listens.
void tell(const StaticStage& stage, const StaticHooks& hooks, const std::string& text);
/// As many threads as hooks say, but eight at most.
std::shared_ptr<Crew> crew_of(const StaticHooks& hooks);
/// Tells, where pressure acts on a surface with a free edge, that it has no energy.
void tell_of_pressure(const StaticBody& body, const StaticHooks& hooks);
/// Throws NoEquilibrium there: for buckling, fracture, modes and bifurcations, which are those of a
/// potential.
void refuse_pressure_without_energy(const StaticBody& body);

/// The balance as others see it. Keeps a reference.
StaticPoint point_at(StaticBody& body, PointKind kind, std::optional<int> unstable,
                     const StaticResult& result);

/// Counts turns that nothing drives or resists. Tells of them where there were none so far.
void note_free_turns(const StaticBody& body, const StaticHooks& hooks, StaticResult& result);

/// Adds one to the clock, counts the point and hands this balance to hooks.point. Throws NoEquilibrium
/// instead if it is not finite.
void report_point(StaticBody& body, PointKind kind, std::optional<int> unstable, const StaticHooks& hooks,
                  StaticResult& result);

/// What a stage does that begins at a balance; returns the state it leaves. The stage is that of
/// stage_from().
using RunFromBalance = std::function<State(const StaticStage& from, State balanced, StaticResult& result)>;

/// The exception that is being handled as NoEquilibrium of this stage: that itself, a solver that does not
/// converge, memory that ran out. Throws any other on. To be called in a catch block.
NoEquilibrium current_failure(const StaticStage& stage);

/// Runs that from the balance of constant loads. What it had found when it failed is kept: StaticStageFailed.
StaticOutcome run_from_constant_loads(const Model& model, const StaticStage& stage, State state,
                                      const StaticHooks& hooks, const RunFromBalance& run);
/// The same from this balance, where it has found so much already.
StaticOutcome run_from_balance(const StaticStage& stage, State balanced, StaticResult found,
                               const RunFromBalance& run);

}  // namespace vbond
