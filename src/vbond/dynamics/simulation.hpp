#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/bond_packs.hpp"
#include "vbond/dynamics/bonding.hpp"
#include "vbond/dynamics/capsules.hpp"
#include "vbond/dynamics/contacts.hpp"
#include "vbond/dynamics/damping.hpp"
#include "vbond/dynamics/encounters.hpp"
#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/dynamics/observer.hpp"
#include "vbond/dynamics/step_times.hpp"
#include "vbond/dynamics/stepper.hpp"
#include "vbond/dynamics/supports.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/dynamics/walls.hpp"
#include "vbond/model/bond_event.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Where the energy is, and which bonds need a closer look.
struct Survey {
  Energies energies;
  /// Every bond that is strained or snapped, shorter than half or longer than twice its length at rest, and
  /// perhaps a few that are close to it, in increasing order.
  std::vector<BondId> deformed;
};

/// What a particle without bonds costs in a step, in bonds: by itself, and its contacts, of which there are
/// some three of twice the work of a bond.
std::size_t work_of_particle(const Model& model);

/// One stage of a run: a const Model, a Stage, and the State that the step loop moves.
/// Observers see it read-only. Results are bitwise the same for any number of threads.
/// Programs use a Run (run/run.hpp), which makes one for each of its stages.
class Simulation {
 public:
  /// Takes over the state and keeps a reference to the model. A state with stage_step = 0 begins the
  /// stage (supports take their given velocities); any other continues it, as after a checkpoint.
  /// threads >= 1. Throws std::invalid_argument if model, stage or state have a mistake (model/mistakes.hpp).
  Simulation(const Model& model, Stage stage, State state, int threads = 1)
      : Simulation(model, std::move(stage), &state, threads) {}
  /// The same, and gives the state back if a stage cannot begin in it.
  Simulation(const Model& model, Stage stage, State* state, int threads = 1);
  /// A part of a body, in this order of rows: it goes on from a state that has begun, of the whole body.
  /// Other processes step its other parts, and call the same functions at the same time. What Question names
  /// is told of the whole body, and all parts must be asked for it. All else is of this part alone, state()
  /// and books() too, and nobody observes: give() and give_particles() tell of the whole body.
  Simulation(const Model& model, Stage stage, State state, Order order, Exchange& exchange);
  Simulation(const Model&&, Stage, State, int = 1) = delete;  // a temporary would be gone at the first step
  Simulation(const Model&&, Stage, State*, int = 1) = delete;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  void add_observer(std::shared_ptr<Observer> observer) {
    observers_.push_back(std::move(observer));
    steps_to_look_ = 1;
  }

  /// From now on, steps are made by this one, which must live as long. It steps what it knows how to; whoever
  /// sets it refuses all else.
  void step_by(Stepper& stepper);

  /// By how many processes they are made, each of a part of the body.
  int parts() const { return stepper_ != nullptr ? stepper_->parts() : 1; }
  /// All these processes look at their parts now (Stepper::look_at_parts). Only where a stepper makes the
  /// steps. Throws IoError.
  void look_at_parts(const std::string& message) const { stepper_->look_at_parts(message); }
  /// Of a part: the particles that it moves, and the bonds of which one is the first end, broken ones too, in
  /// increasing order. In its state() these are up to date, and where both ends of these bonds are: of bonds
  /// that broke, whose ends may be far away by now, once all parts have called learn_ends_of_bonds().
  std::vector<ParticleId> own_particles() const;
  std::vector<BondId> own_bonds() const;
  void learn_ends_of_bonds();

  /// Who looks after fewer steps than these has all processes wait for that look alone, where a stepper makes
  /// the steps. 1 without one.
  std::int64_t steps_at_once() const { return stepper_ != nullptr ? Stepper::at_once : 1; }

  /// One time step of stage().dt. Throws Diverged if a load is not finite or a new bond is impossible; where
  /// the stage drops particles that have passed through walls, ParticlesLost after the step.
  void step();

  /// Steps until a stop condition holds or `interrupted` (asked after every step) says so, or until `most`
  /// steps are made: StopReason::running. Observers are told of the end, and of an interruption.
  StopReason run(const std::function<bool()>& interrupted = {},
                 std::int64_t most = std::numeric_limits<std::int64_t>::max());
  /// Why the stage ends here, if it does. Not where a stepper makes the steps.
  StopReason stop_reason() const;
  /// Of a simulation that goes on with the state of another one, without particles that drop() took out of
  /// it: takes over what that one has not told its observers yet, with the bonds that broke by this, and
  /// counts the energy that has gone as released. Returns that energy.
  double take_over(Simulation& with_them, const std::vector<BondEvent>& broken);
  /// Shows the observers this step again.
  void look_again() { notify_observers(); }
  /// Tells the observers that the stage ends here.
  void finish(StopReason why);

  const Model& model() const { return model_; }
  const Stage& stage() const { return stage_; }
  const Clock& clock() const { return state_.clock; }
  const EnergyBooks& books() const { return state_.books; }
  /// What they count as dissipated, by cause. Looks at every bond that remembers something.
  Losses losses() const;
  const PeakRecord& peak() const { return state_.peak; }
  /// Bonds that have broken in this stage.
  std::int64_t breaks() const { return state_.breaks; }
  const PerBond<Bond>& bonds() const { return state_.bonds; }
  /// Particles that are no longer computed, see State::dropped.
  const std::vector<ParticleId>& dropped() const { return state_.dropped; }
  /// The whole state, in the numbering of the model, good until the next step: copy it to keep it. Collecting
  /// it takes time: not for every step.
  const State& state() const;
  /// The same at the end, without a copy: nothing else may be asked of the simulation afterwards. Of a part
  /// it is the state of the whole body, in all parts.
  State take_state() &&;
  /// Pairs that were deep in one another in the last step, as far as contacts are to keep them apart, and the
  /// fastest particle if it was too fast for that: observers look at every step that has any.
  const std::vector<Encounter>& encounters() const { return encounters_.found(); }
  const std::optional<FastParticle>& fastest() const { return encounters_.fastest(); }
  /// The particle that turns by more than longest_turn in a step, and farthest of all whose bonds or unequal
  /// moments of inertia feel it (model/turn_bound.hpp). Looks at all of them, so not for every step.
  std::optional<FastTurn> fastest_turn() const;
  /// Particles that are deeper in a wall than this part of their radius, beyond what they were at r_0.
  std::vector<DeepInWall> deep_in_walls(double part) const;
  /// Capsules that overlap each other or particles by more than this part of the smaller radius.
  std::vector<DeepCapsules> deep_capsules(double part) const { return here().capsules_.deeper_than(part); }
  /// Whether some are so deep that observers look at once.
  bool any_deep_capsules() const { return here().capsules_.deep(); }
  /// Bonds made and broken since observers looked last, all of them if there is no observer, in the order in
  /// which it happened, those of a step in the order of bonds. Observers look at every step in which bonds
  /// broke, after it.
  const std::vector<BondEvent>& events() const { return events_; }
  /// Forces and moments at the present positions, in the numbering of the model; collected at each call. None
  /// where a stepper makes the steps.
  Loads loads() const { return bodies_.collect(bodies_.load); }
  /// Threads at work: fewer than asked for if there is too little for them to do.
  int threads() const { return static_cast<int>(team_.parts().size()); }
  /// Where the wall time of the steps has gone.
  const StepTimes& times() const { return times_; }

  /// A sum over all bonds, so not for every step; made once per step however often it is asked for.
  const Survey& survey() const;
  /// Energies at the present positions and velocities.
  const Energies& energies() const { return survey().energies; }
  /// Relative error of the energy balance for these energies: kinetic + potential + dissipated - work -
  /// start, over the largest energy that start and work have brought in so far, at least what moves and what
  /// contacts hold now, and a thousand roundings.
  double balance_error(const Energies& e) const;
  /// What the supports exert on these particles along held degrees of freedom, drag included, the
  /// inertia of prescribed accelerations left out.
  Reaction reaction(const std::vector<ParticleId>& particles) const;
  /// Where walls are, and what presses on them.
  const std::vector<WallState>& walls() const { return here().walls_.states(); }
  /// The grips of the stage, in the order of its supports.
  std::vector<GripView> grips() const;
  /// The same with the loads of the bonds that broke in the last step.
  Reaction reaction_before_breaks(const std::vector<ParticleId>& particles) const;
  /// Of a part: what the state says of the body as a whole, as it stands, to all, and changes of bonds to the
  /// part that leads; what does not change is left as it is.
  void give(State& whole);
  /// Of a part: what it says of single particles, and what bonds and pairs remember, to the part that leads
  /// or to all.
  void give_particles(State& whole, bool everyone);
  /// Of a part that does not lead: does its share of the answer.
  void answer(const Question& question);
  /// Of a part: throws on all of them if one has failed. To be called between steps, now and then.
  void agree_on_failure();
  /// Of a part: takes over what another one of the same body has not told its observers yet.
  void take_events(Simulation& from) { events_ = std::move(from.events_); }
  /// Of a part: whether observers must look at this step.
  bool is_due() const { return due_; }
  /// Of a part: no particle of any part has gone farther in the last step, where some may meet.  [length]
  double last_way() const { return last_way_; }
  /// Of a part: the longest way of a particle since it was made, and its longest bond.  [length]
  double way_since_begin() const;
  double longest_bond() const;
  /// Mean over the bonds with both ends in the group of F.d, tension positive; 0 without such bonds.  [force]
  double mean_axial_force(const std::vector<ParticleId>& particles) const;

 private:
  /// What a block's particles add to the energy books in a step, and NaN if one of their loads is not finite.
  struct BlockBooks {
    double dissipated = 0, work_loads = 0, work_supports = 0;
    double poison = 0;
    double way2 = 0;    // bound of the largest |v dt|^2
    bool deep = false;  // some contact of its particles is
  };

  /// What was taken off two particles as a bond between them broke.
  struct TakenLoads {
    ParticleId i, j;
    BondLoads<double> loads;
  };

  struct Broken;
  /// A bond that grows by this part of its lengths at temperature 0, in the step under way.
  struct Growing {
    std::size_t warm_bond;
    double growth;
  };

  void begin_stage();
  Simulation(const Model& model, Stage stage, State* state, int threads, Order order, Exchange& exchange,
             bool is_part);
  StopReason leap(std::int64_t& most);
  void bonds_changed();
  void arrange_bonds();
  void make_bonds();
  bool set_temperatures(double time);
  void heat_at_start();
  void heat();
  void book_heat();
  bool break_bonds();
  Broken broken_now(BondId bond);
  void take_out(const Broken& broken);
  void take_up_loads();
  void apply_strain();
  bool has_only_elastic_bonds() const;
  void change_body();
  bool find_events();
  void step_blocks(bool timed);
  void finish_free_grips();
  void evaluate_loads();
  void work_out_touches(double dt);
  /// The rows of a block without those that fill it up.
  RowRange particles_of(const Block& b) const {
    return {b.rows.first, std::min(b.rows.last, bodies_.order.known)};
  }
  bool moves_first(const Block& block) const;
  void begin_step(const Block& block);
  void end_step(const Block& block);
  RowsAhead rows_of(const Block& block) const;
  void kick(const Block& block, double h);
  double drift(const Block& block, double h);
  void clear_loads(const Block& block);
  void add_mutual_loads(const Part& part, const Block& block, Instant at, const RowsAhead& ahead,
                        StepTimes::Lap& lap);
  void complete_loads(const Block& block, Instant at, StepTimes::Lap& lap);
  bool inelastic() const { return !bodies_.rates.empty(); }
  void keep_rates(const Block& block);
  void book_damping(const Block& block, double h);
  void share_damping(Losses& lost) const;
  void lose(std::size_t block, Loss cause, double energy) {
    books_[block].dissipated += energy, lost_[block][cause] += energy;
  }
  void lose(std::size_t block, const TouchLosses<double>& in_contacts);
  bool anything_dissipates() const { return inelastic() || anything_touches() || damping_.is_drag(); }
  void close_walls(double dt);
  void tell_of_lost();
  void look_at_capsules() const;
  void exchange_capsules();
  double contact_energy() const { return contacts_.energy(bodies_) + (leads() ? capsules_.energy() : 0.0); }
  bool anything_touches() const { return contacts_.any() || walls_.any() || capsules_.any(); }
  void close_books();
  double largest_way2() const;
  void add_held(const Hold& hold, Row row, const Vec3d& F, const Vec3d& M, Reaction& total) const;
  void look_at_deep_contacts();
  void check_finite() const;
  bool past_largest(const Bond& bond) const;
  void keep_records();
  double peak_quantity() const;
  Survey survey_here() const;
  Reaction reaction_here(const std::vector<ParticleId>& particles) const;
  Reaction summed_over_parts(Reaction reaction) const;
  std::vector<BondId> bonds_inside(const std::vector<ParticleId>& particles) const;
  double mean_axial_force(const std::vector<BondId>& bonds) const;
  const PoseRow& pose_of(ParticleId p) const { return bodies_.pose[bodies_.order.row[p].value]; }
  void notify_observers();

  // ---- of a part (simulation_part.cpp) ----
  struct Failed {
    std::int64_t step, first_particle;
    double time;
    std::array<char, 512> who, what, way_out;
  };
  const Team& all_known() const { return with_ghosts_ ? *with_ghosts_ : team_; }
  double reach() const;
  bool meets() const { return contacts_.any() || capsules_.any() || !stage_.bonding.empty(); }
  void diverge(std::size_t first_particle, const std::string& who, const std::string& what,
               const std::string& way_out) const;
  void exchange_halo();
  bool is_sent(const Block& block) const;
  void complete_sent_blocks(Instant at);
  /// Whether it is of interest how far particles go in a step: where something may touch, or be bonded by
  /// parts.
  bool looks_at_ways() const { return !only_elastic_ && (anything_touches() || (is_part_ && meets())); }
  bool leads() const { return exchange_.leads(); }
  /// Where what all parts know is up to date: here, or in the part of this process.
  const Simulation& here() const { return stepper_ != nullptr ? stepper_->part() : *this; }
  Vec3d from_to(ParticleId i, ParticleId j) const;

  const StepKernel& kernel_ = step_kernel();
  const Model& model_;
  const Stage stage_;
  mutable State state_;                // positions and velocities as of the last state() or stage start
  mutable bool bodies_ahead_ = false;  // they, or those of a stepper, have moved on since
  bool only_elastic_ = false;          // has_only_elastic_bonds(): a step then leaves out all the rest
  const bool is_part_;
  Exchange& exchange_;
  Bodies bodies_;
  Team team_;
  std::optional<Team> with_ghosts_;  // of a part
  BondPacks bonds_;
  BondIndex bond_index_;
  Contacts contacts_;
  Capsules capsules_;
  Encounters encounters_;
  Supports supports_;
  AppliedLoads applied_;
  Damping damping_;
  Walls walls_;
  Bonding bonding_;
  std::vector<BlockBooks> books_;
  std::vector<DampedPower> damped_;            // of the bonds of each block, if any damp
  std::vector<Losses> lost_;                   // of what books_ count as dissipated, by cause
  std::vector<std::vector<BondId>> breaking_;  // of each part, in the step under way
  std::vector<BondEvent> events_;
  std::vector<LostParticle> lost_to_walls_;    // in the step under way, where the stage drops them
  std::vector<Growing> growing_;               // bonds whose lengths change in the step under way
  std::vector<TakenLoads> taken_;              // of the bonds that broke in the last step
  std::vector<Capsules::Share> taken_shares_;  // of their capsules, less those of what touches instead
  double rounding_scale_ = 0;                  // least energy that the balance error is compared with
  std::vector<BondId> peak_bonds_;             // inside the group that a peak is looked for in
  std::int64_t last_stage_step_ = 0;           // of the stage's duration
  std::vector<std::shared_ptr<Observer>> observers_;
  std::int64_t steps_to_look_ = 1;
  Stepper* stepper_ = nullptr;
  StepTimes times_;
  // of a part
  mutable std::optional<Failed> failed_;  // first of all
  std::vector<Vec3d> r_begin_;            // of its rows
  std::vector<double> brought_in_;        // after each step since give(): energy at the start and work
  double last_way_ = 0;
  bool due_ = false, changed_ = false;
  mutable std::optional<Survey> survey_;  // empty: positions or velocities have changed since
};

}  // namespace vbond
