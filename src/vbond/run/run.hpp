#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/dynamics/observer.hpp"
#include "vbond/dynamics/partition.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/dynamics/step_memory.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/run/stages.hpp"
#include "vbond/statics/fracture_under_way.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// How a stage went.
struct StageResult {
  std::string name;
  StageKind kind = StageKind::dynamics;
  StopReason stop = StopReason::running;  ///< of dynamics; of a static stage only `interrupted`
  std::int64_t steps = 0;                 ///< of the stage so far; of a static one: points of balance
  double time = 0;                        ///< of the run at its end  [time]
  PeakRecord peak;                        ///< of dynamics with a stop at a peak
  std::optional<StaticResult> statics;    ///< of a static stage; of a failed one what it had found
  std::string failure;                    ///< what went wrong; empty: nothing
  bool interrupted() const { return stop == StopReason::interrupted; }
};

/// What a program may listen to and answer while a run goes on; each may be empty.
struct RunHooks {
  std::function<void(const BodyView&)> balance;  ///< each balance of a static stage, after the observers
  std::function<void(const std::string&)> tell;  ///< one report, without a line end
  std::function<bool()> interrupted;             ///< asked between steps: true stops the run there
  /// What a static stage is at, one line every few seconds, without a line end.
  std::function<void(const std::string&)> progress = {};
  /// A stage of fracture can go on from this point of it: state() and under_way() are those of now.
  std::function<void()> under_way = {};
  /// The balance from which a stage of fracture goes on, which observers have seen before it was stopped.
  std::function<void(const BodyView&)> goes_on = {};
  /// A stage of dynamics has ended, was interrupted or has diverged (`failure` says why).
  std::function<void(const Simulation&, StopReason, const std::string& failure)> stage_end;
};

/// Why a stage cannot be run.
struct StageRefusal {
  std::size_t stage = 0;
  Problem problem;
  std::optional<NoEquilibrium> no_equilibrium;  ///< the body cannot be in balance: the error that it ends in
};

/// A run from a state through its stages, dynamic and static in any order. It owns model, state and clock.
/// A state that a checkpoint or state() gave goes on where it was: results are bitwise those of a run that
/// was never stopped, as they are for any number of threads.
///
/// What is asked of it in the wrong way, here and below: std::invalid_argument, and nothing has happened.
/// What goes wrong in a stage: Diverged or NoEquilibrium. state() is then the last that was sound in a static
/// stage, the one in which it was noticed in dynamics, results() has what was found, and the run cannot go
/// on.
class Run {
 public:
  /// `stages` are all of the run, those that the state has behind it, too. threads >= 1. Throws if model or
  /// state have a mistake (model/mistakes.hpp), or if state.clock.stage is not one of the stages.
  Run(Model model, State state, std::vector<AnyStage> stages, int threads = 1);
  Run(Model model, State state, std::unique_ptr<const Stages> stages, int threads = 1);
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// They are asked in this order, in every stage.
  void add_observer(std::shared_ptr<Observer> observer);
  void set_hooks(RunHooks hooks) { hooks_ = std::move(hooks); }
  /// From the next stage of dynamics on, several processes step the body, each a part of it. All of them make
  /// the same run and call the same functions; hooks are called on all, and whether the run is interrupted is
  /// for the one that leads to say. Must live as long as the run. Such a stage must not drop particles, nor
  /// have rigid groups that are free in part.
  void spread_over(Partition& partition) { partition_ = &partition; }
  /// The state that the run begins with has the own bonds of this process alone, as build() has kept them: to
  /// be said before anything else is asked of the run, of which spread_over() must follow. The first stage
  /// takes them over. So it is again between its stages, all of which must be fit for it
  /// (may_keep_own_bonds): `own` says of which bonds the state is.
  void begin_with_own_bonds(std::shared_ptr<BondsFromSetUp> own) {
    own_ = std::move(own);
    keep_ = kept_by(model_, body_at_start());
  }
  /// The state that the run begins with is of a stage of fracture, which goes on from there: its under_way()
  /// of then. Throws if it is not of that stage and point.
  void go_on_within(std::shared_ptr<const FractureUnderWay> then);

  /// The processes that step its bodies.
  const Exchange& exchange() const { return partition_ != nullptr ? *partition_ : one_rank(); }

  // ---- before it begins --------------------------------------------------------------------------
  /// What is wrong with the stages still to come, as far as it can be told before they run: nothing that the
  /// stages before them could mend. Makes the first of them (prepare).
  std::vector<StageRefusal> refusals();
  /// Throws CaseError or std::invalid_argument with all refusals, NoEquilibrium if there are no others. Done
  /// by itself before the first stage begins.
  void check();

  // ---- going on ----------------------------------------------------------------------------------
  /// All stages to come, or up to an interruption. Returns results().
  const std::vector<StageResult>& run();
  /// The stage under way, or the next one, to its end.
  StageResult run_stage();
  /// At most n steps of the dynamic stage under way, or of the next stage; fewer if the stage ends. Returns
  /// how many were made. Throws if the stage is static: it is run as a whole.
  std::int64_t step(std::int64_t n = 1);
  /// Ends the dynamic stage under way here, as if its duration were over.
  void end_stage();
  bool complete() const { return stage_index() == stages_->size(); }

  /// The two parts of beginning a stage, for those who look between them; run_stage and step do both. prepare
  /// makes the stage, with its bonds; begin sets up the time loop.
  const AnyStage& prepare();
  void begin();
  /// What there is to tell of the stage that prepare() has made, before it begins; a line each. Hooks are
  /// told as it begins.
  std::vector<std::string> notes_on_stage() const;
  /// The state before prepare() has made the stage's bonds, which a run that begins in it makes again; of a
  /// static stage that was interrupted the one to begin it again from, where it does not go on from within.
  State start_of_stage() const;

  // ---- looking -----------------------------------------------------------------------------------
  const Model& model() const { return model_; }
  const Stages& stages() const { return *stages_; }
  std::size_t stage_index() const { return static_cast<std::size_t>(clock().stage); }
  /// Where the run is. A stage that has ended is behind it: stage_step is then 0.
  const Clock& clock() const { return simulation_ ? simulation_->clock() : state_.clock; }
  /// A copy of all that changes: what a checkpoint holds, and a Run goes on from.
  State state() const { return current(); }
  /// The same without a copy, good until the run goes on or is changed. While several processes step the
  /// body, and once after its last stage, they collect it from each other.
  const State& current() const;
  /// The body before a stage begins: of its bonds each process may have its own. Keeps references.
  BodyPart body_at_start() const { return body_of(state_, own_); }
  /// The same for a look at later stages, good until the run goes on.
  Outlook outlook() const { return {state_, own_}; }
  /// The time loop of the dynamic stage under way, for energies, reactions and times; null without one.
  const Simulation* simulation() const { return simulation_.get(); }
  /// Of a stage of fracture that is under way, or was interrupted: what it knows beside state(); null: the
  /// stage begins, or is another one. With both it goes on (go_on_within), and so does this run.
  const std::shared_ptr<const FractureUnderWay>& under_way() const { return under_way_; }
  /// Of each stage that has ended or failed here, in order.
  const std::vector<StageResult>& results() const { return results_; }

  // ---- changing, between steps or stages ---------------------------------------------------------
  /// New velocities and angular velocities, one for each particle. The kinetic energy that comes in is booked
  /// as work of loads. Held degrees of freedom keep theirs.
  void set_velocities(const PerParticle<Vec3d>& v, const PerParticle<Vec3d>& omega);
  /// The same for these particles alone.
  void set_velocity(const std::vector<ParticleId>& particles, const Vec3d& v, const Vec3d& omega = {});
  /// Adds a load to the stage under way, or to the next one, for the rest of it. Not part of a checkpoint.
  void add_load(const PointLoad& load);

 private:
  void require_able() const;
  void tell_notes_once();
  bool any_dynamics() const;
  StopReason advance(std::int64_t most);
  StopReason steps_of_stage(std::int64_t most);
  std::unique_ptr<Simulation> part_of(State state, Share share);
  void take_part();
  void set_up_anew();
  void end_sources();
  void tell_stage_end(StopReason why, const std::string& failure);
  bool drop(const ParticlesLost& found);
  void tell_of_dropped(const std::vector<std::pair<ParticleId, std::string>>& lost,
                       const std::vector<BondEvent>& broken, double energy);
  void sum_up_dropped();
  void close_stage(StopReason why);
  void hand_over();
  void end_in_parts();
  StageResult run_static();
  StageResult run_on(const StaticStage& stage);
  StageResult find_balance(const StaticStage& stage);
  StageResult result_of_dynamics(StopReason why) const;
  void fail(const std::string& why);
  void take_back_bonds(State& state) const;
  void expect_bonds_of_first(Outlook& outlook) const;
  void look_at_balance(std::size_t k, const StaticStage& stage, const Outlook& outlook,
                       std::vector<StageRefusal>& found) const;
  void change_motion(PerParticle<Vec3d> v, PerParticle<Vec3d> omega);
  void begin_again();

  mutable Model model_;  // as the state, where processes share it
  mutable State state_;  // of no meaning while there is a simulation
  std::unique_ptr<const Stages> stages_;
  int threads_;
  Observers observers_;
  RunHooks hooks_;
  Partition* partition_ = nullptr;               // null: one process
  mutable std::shared_ptr<BondsFromSetUp> own_;  // null: between simulations each process has all bonds
  mutable std::optional<PartHandedOver> part_;   // between stages, if each has its part alone
  RanksKeep keep_ = RanksKeep::all_bonds;        // what of it each has then
  Acquaintance known_;                           // of the last stage
  std::optional<AnyStage> stage_;                // that was prepared
  std::size_t bonds_before_ = 0, histories_before_ = 0;  // prepare()
  EnergyBooks books_before_;
  std::optional<std::size_t> noted_stage_;     // which hooks were told of
  std::unique_ptr<Simulation> simulation_;     // of the dynamic stage that has begun
  mutable std::unique_ptr<Simulation> ended_;  // of the last stage, if its parts have not been collected
  std::optional<State> restart_;               // where a static stage that was interrupted begins again
  std::shared_ptr<const FractureUnderWay> under_way_;
  std::vector<StageResult> results_;
  bool checked_ = false;
  std::string failure_;
  std::size_t drops_untold_ = 0;
};

}  // namespace vbond
