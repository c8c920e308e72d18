#pragma once
#include <algorithm>
#include <array>
#include <cmath>
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
#include "vbond/dynamics/capsule_contacts.hpp"
#include "vbond/dynamics/cell_images.hpp"
#include "vbond/dynamics/cell_motion.hpp"
#include "vbond/dynamics/contacts.hpp"
#include "vbond/dynamics/damping.hpp"
#include "vbond/dynamics/encounters.hpp"
#include "vbond/dynamics/handover.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/dynamics/observer.hpp"
#include "vbond/dynamics/part_bonds.hpp"
#include "vbond/dynamics/partition.hpp"
#include "vbond/dynamics/step_times.hpp"
#include "vbond/dynamics/supports.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/model/body_view.hpp"
#include "vbond/model/bond_event.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/rigid_bodies.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/terms/motion_terms.hpp"
#include "vbond/terms/walls/motion_walls.hpp"

namespace vbond {

/// What a particle without bonds costs in a step, in bonds: by itself, and its contacts, of which there are
/// some three of twice the work of a bond.
std::size_t work_of_particle(const Model& model);

/// What is deep in one another, for those who watch.
struct Deep {
  const Encounters& particles;
  const Capsules& capsules;
  const MotionWalls& walls;
};

/// Throws std::invalid_argument if model, stage or state have a mistake (model/mistakes.hpp).
void require_able_to_begin(const Model& model, const Stage& stage, const State& state);

/// One stage of a run: a const Model, a Stage, and the State that the step loop moves.
/// Observers see it read-only. Results are bitwise the same for any number of threads.
/// Programs use a Run (run/run.hpp), which makes one for each of its stages.
///
/// A body may be spread over processes, each of which has a Simulation of its part. All of them have the same
/// observers and call the same functions in the same order, those that only look as well, as each knows its
/// share alone: they wait for each other, and get the same answers, of the whole body.
class Simulation final : public BodyView, private MotionHost {
 public:
  /// Takes over the state and keeps a reference to the model. A state with stage_step = 0 begins the
  /// stage (supports take their given velocities); any other continues it, as after a checkpoint.
  /// threads >= 1. Throws std::invalid_argument if model, stage or state have a mistake (model/mistakes.hpp).
  Simulation(const Model& model, Stage stage, State state, int threads = 1)
      : Simulation(model, std::move(stage), &state, threads) {}
  /// The same, and gives the state back if a stage cannot begin in it.
  Simulation(const Model& model, Stage stage, State* state, int threads = 1);
  /// A part of a body, whose other parts other processes step: it begins the stage, or goes on from a state
  /// that has begun, of the whole body, and gives it back if it diverges as it begins. So it does with the
  /// model that the share may have.
  Simulation(const Model& model, Stage stage, State* state, Share share, Exchange& exchange);
  Simulation(const Model&&, Stage, State, int = 1) = delete;  // a temporary would be gone at the first step
  Simulation(const Model&&, Stage, State*, int = 1) = delete;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  void add_observer(std::shared_ptr<Observer> observer) {
    observers_.push_back(std::move(observer));
    steps_to_look_ = 1;
  }

  // ---- going on ----
  /// One time step of stage().dt. Throws Diverged if a load is not finite or a new bond is impossible; where
  /// the stage drops particles that have passed through walls, ParticlesLost after the step. Visits nothing,
  /// and finds no images anew: run() does.
  void step();
  /// Steps until a stop condition holds or `interrupted` (asked after every step) says so: observers are told
  /// of it. StopReason::running: `most` steps are made; or fewer, and another simulation must go on: bodies
  /// came in or particles were taken out, or particles have gone so far that a body in parts is to be spread
  /// anew, or that a periodic one may lack images.
  StopReason run(const std::function<bool()>& interrupted = {},
                 std::int64_t most = std::numeric_limits<std::int64_t>::max());

  // ---- the body ----
  const Stage& stage() const { return stage_; }
  /// Bonds made and broken since observers looked last, all of them if there is no observer, in the order in
  /// which it happened, those of a step in the order of bonds. Observers look at every step in which bonds
  /// broke, after it.
  const std::vector<BondEvent>& events() const { return events_; }
  /// Forces and moments at the present positions, in the numbering of the model; collected at each call. Of a
  /// part those on its own particles.
  Loads loads() const { return bodies_.collect(bodies_.load); }
  /// What is deep in one another, or too fast for contacts to keep it apart; observers look at every step
  /// after which particles or capsules are.
  Deep deep() const { return {encounters_, capsules_, terms_.of<MotionWalls>()}; }
  const StepTimes& times() const { return times_; }  ///< where the wall time of the steps has gone

  /// What this process has of state(): for those who bring the whole together at the process that leads, a
  /// piece at a time. Nothing where each process has all bonds, or state() has been collected already.
  std::optional<StateOfPart> state_of_part() const;

  // ---- its end ----
  /// state() without a copy, and what has changed in it where run() has ended for that: what another
  /// simulation, of this stage or the next, goes on from. This one may only be taken over then.
  Handover handover() &&;
  /// The same for another simulation of the stage: of a part its share alone, where a process has that alone
  /// and no visit has changed the body.
  Handover handover_of_part() &&;
  /// Goes on where another one of the stage has ended, from its state, in which this has changed: takes over
  /// its observers, and what it has not told them yet, and books what came in and went. Lost particles: run()
  /// shows observers the same step again. seconds: that it took to end the other one and begin this one.
  void take_over(Simulation& before, const Passage& passed, double seconds = 0.0);

  // ---- of a BodyView ----
  const Model& model() const override { return model_; }
  const State& state() const override;
  BodyPart part(Show what = Show::places, double near = 0.0) const override;
  const Survey& survey() const override;
  const EnergyBooks& books() const override;
  double balance_error() const override;
  Reaction reaction(const std::vector<ParticleId>& particles,
                    LastBreaks breaks = LastBreaks::left_out) const override;
  const std::vector<WallState>& walls() const override { return terms_.of<MotionWalls>().states(); }
  std::vector<GripView> grips() const override;

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

  struct Breaking;
  struct Broken;

  const State& known() const override { return state_; }
  void begin_stage();
  Simulation(const Model& model, Stage stage, State* state, int threads, Share share, Exchange* exchange);
  void bonds_changed();
  void arrange_bonds() override;
  void make_bonds();
  bool break_bonds();
  void add_joints_that_part(std::vector<BreakingBond>& broken) const;
  Broken broken_now(BondId bond, const std::vector<BreakingBond>& here);
  void broken_elsewhere(const Breaking& breaks);
  Contacts::Touch part_pair(const BondEnds& bond);
  Contacts::Touch touch_of_unbonded(const BondEnds& bond);
  void leave_faces(BondId bond, const BondPose<double>& pose, Broken& broken);
  void take_out(const Broken& broken);
  void read_memories();
  bool brings_all_loads() const;
  void take_up_loads();
  bool has_only_elastic_bonds() const;
  void begin_step();
  void find_touches(StepTimes::Lap& lap);
  void step_blocks(bool timed);
  void end_step();
  bool find_events();
  void evaluate_loads() override;
  void apply_loads_alone() override;
  void particles_jumped() override;
  void work_out_touches(double dt);
  /// The rows of a block without those that fill it up.
  RowRange particles_of(const Block& b) const {
    return {b.rows.first, std::min(b.rows.last, bodies_.order.known)};
  }
  bool moves_first(const Block& block) const;
  void begin_step(const Block& block);
  void end_step(const Block& block);
  RowsAhead rows_of(const Block& block) const;
  void kick_and_book(const Block& block, Instant from, Instant to, const Tensor& flow);
  void kick_and_book_damping(const Block& block, Instant from, Instant to, const Tensor& flow);
  void kick(const Block& block, double h);
  double drift(const Block& block, double h);
  void clear_loads(const Block& block);
  BondSweep bond_sweep(Instant at);
  void add_mutual_loads(const Part& part, const Block& block, Instant at, const RowsAhead& ahead,
                        StepTimes::Lap& lap);
  void add_contact_loads(const Block& block, double dt);
  void complete_block(const Block& block, Instant at, StepTimes::Lap& lap);
  void complete_loads(const Block& block, Instant at, StepTimes::Lap& lap);
  void share_damping(Losses& lost) const;
  void lose(std::size_t block, Loss cause, double energy) {
    books_[block].dissipated += energy, lost_[block][cause] += energy;
  }
  void lose(std::size_t block, const TouchLosses<double>& to_touches) override;
  void lose_particle(const LostParticle& lost) override { lost_particles_.push_back(lost); }
  double potential_energy() const override { return survey_here().energies.potential(); }
  double flowed() const override { return dissipated_by_flow(part(Show::bonds)); }
  void lengths_have_changed() override { survey_.reset(); }
  bool anything_dissipates() const {
    return bonds_.reads_rates() || damping_.is_local() || damping_.is_drag() || anything_touches();
  }
  void tell_of_lost();
  void look_at_capsules() const;
  void exchange_capsules();
  double contact_energy() const { return contacts_.energy(bodies_) + (leads() ? capsules_.energy() : 0.0); }
  bool anything_touches() const { return contacts_.any() || capsules_.any() || terms_.any_touching(); }
  void close_books();
  double largest_way2() const;
  std::vector<char> whole_free_grips(const std::vector<ParticleId>& particles) const;
  void add_held(const Hold& hold, bool whole, Row row, const Vec3d& F, const Vec3d& M, Reaction& total) const;
  void look_at_deep_contacts();
  void check_finite() const;
  bool past_largest(const Bond& bond) const;
  StopReason stop_reason() const;
  bool visit();
  void book(const Passage& passed, double change);
  void keep_records();
  double peak_quantity() const;
  Survey survey_here() const;
  std::optional<FastTurn> fast_turn_here() const;
  Reaction reaction_here(const std::vector<ParticleId>& particles) const;
  void add_taken(const std::vector<ParticleId>& particles, Reaction& to) const;
  Reaction summed_over_parts(Reaction reaction) const;
  double mean_axial_force(const std::vector<BondId>& own) const;
  const PoseRow& pose_of(ParticleId p) const { return bodies_.pose[bodies_.order.row[p].value]; }
  void notify_observers();

  // ---- of a part (simulation_part.cpp) ----
  struct Failed {
    std::int64_t step, first_particle;
    double time;
    std::array<char, 512> who, what, way_out;
  };
  /// The blocks that move here, and those of ghosts behind them.
  const Team& all_known() const { return with_ghosts_ ? *with_ghosts_ : team_; }
  double reach() const;
  std::vector<ParticleId> own_particles() const;
  std::vector<BondId> own_bonds() const;
  bool may_meet() const { return contacts_.any() || capsules_.any() || !stage_.bonding.empty(); }
  bool is_time_to_meet() const;
  bool meet(bool interrupted);
  /// Ends the run where any part has failed: all parts throw what the first has found.
  void agree_on_failure();
  void fold_brought_in() const;
  /// Whether what may meet is known only until particles have gone so far.
  bool is_known_for_a_while() const { return std::isfinite(farthest_); }
  void note_where_it_begins(const std::vector<BoundingBox>& others);
  const Vec3d& place_at_begin(std::size_t row) const;
  struct Ways {
    double farthest = 0;   // that one has gone  [length]
    double room_left = 0;  // that each may go at least before ghosts may be missing  [length]
  };
  double most_ahead(std::size_t row) const;
  Ways ways_since_begin() const;
  double way_of_images(const CellEdges& edges) const;
  std::array<Vec3d, 3> force_on_images() const;
  void show_own() const;
  void show_loads() const;
  State& collected() const;
  void complete_model() const;
  State give_state();
  void make_room();
  /// What state_ shows is no longer as of now.
  void has_changed() { shown_ = Shown::nothing, whole_.reset(); }
  void show_ends_of_broken() const;
  BodyPart own_part(std::vector<ParticleId> near) const;
  std::vector<ParticleId> near_own(double reach) const;
  void diverge(std::size_t first_particle, const std::string& who, const std::string& what,
               const std::string& way_out) const override;
  HaloColumns halo_columns();
  void carry_images(const Block& block);
  void send_halo();
  void receive_halo();
  bool is_early(const Block& block) const;
  bool is_late(const Block& block) const;
  bool waits_for_parts(const Block& block) const;
  bool ends_with_its_part(const Block& block) const;
  void finish_part(const Part& part, Instant at, StepTimes::Lap& lap);
  void complete_late_block(const Block& block, Instant at, StepTimes::Lap& lap);
  void complete_late_blocks(Instant at);
  /// Whether it is of interest how far particles go in a step: where something may touch, or be bonded to a
  /// ghost.
  bool looks_at_ways() const {
    return !only_elastic_ && (anything_touches() || (is_known_for_a_while() && may_meet()));
  }
  const Tensor* flow() const { return cell_.any() ? &cell_.L_end() : nullptr; }
  /// Ghosts are images that only bonds concern: each belongs to the part of its particle (Part::images).
  bool parts_have_images() const { return has_ghosts() && !with_ghosts_; }
  /// A part may have none, and its particles may be those of others.
  bool has_ghosts() const { return is_part_ || bodies_.order.own < bodies_.order.known; }
  double slow_down(const Block& block, const Tensor& flow);
  bool leads() const { return exchange_.leads(); }
  Vec3d from_to(ParticleId i, ParticleId j) const;

  const StepKernel& kernel_ = step_kernel();
  const Model& model_;
  Model* const shared_model_;  // null: the model stays whole
  double mass_of_all_;         // [mass]
  const Stage stage_;
  enum class Shown : std::uint8_t { nothing, own, all };  // what state_ has of places and memories as of now
  mutable State state_;
  std::optional<BeforeHold> before_hold_;  // until the stage has begun
  mutable Shown shown_ = Shown::all;
  mutable EnergyBooks booked_;       // here: of a part its share, but for the largest energy
  mutable bool books_ahead_ = true;  // booked_ has changed since state_ got the books of the whole body
  bool only_elastic_ = false;        // has_only_elastic_bonds(): a step then leaves out all the rest
  const bool is_part_;
  SharedByBonds shared_;  // by the bonds of the whole body
  PartBonds part_bonds_;  // what state_ has of them
  Bodies bodies_;
  CellImages images_;
  Exchange& exchange_;  // with the other parts, or with the images
  Team team_;
  std::optional<Team> with_ghosts_;  // of ranks, and where more than bonds concerns ghosts: in the last part
  bool halo_under_way_ = false;
  BondPacks bonds_;
  BondIndex bond_index_;
  Contacts contacts_;
  Capsules capsules_;
  Encounters encounters_;
  Supports supports_;
  AppliedLoads applied_;
  Damping damping_;
  CellMotion cell_;
  Bonding bonding_;
  MotionTerms terms_;
  std::vector<BlockBooks> books_;
  std::vector<DampedPower> damped_;                  // of the bonds of each block, if any damp
  std::vector<Losses> lost_;                         // of what books_ count as dissipated, by cause
  std::vector<TouchSums> touched_;                   // of contacts, of each block
  std::vector<std::vector<BreakingBond>> breaking_;  // of each part, in the step under way
  std::vector<BondEvent> events_;
  std::vector<LostParticle> lost_particles_;   // in the step under way, where the stage drops them
  std::vector<TakenLoads> taken_;              // of the bonds that broke in the last step
  std::vector<Capsules::Share> taken_shares_;  // of their capsules, less those of what touches instead
  double rounding_scale_ = 0;                  // least energy that the balance error is compared with
  std::vector<BondId> peak_bonds_;             // inside the group that a peak is looked for in
  std::int64_t last_stage_step_ = 0;           // of the stage's duration
  std::int64_t next_visit_ = no_visit;         // its step of the stage
  std::optional<Handover> visited_;            // of a visit that has changed the body
  Observers observers_;
  std::int64_t steps_to_look_ = 1;
  StepTimes times_;
  // of a part
  mutable PerParticle<char> is_own_;        // for part(); empty: not asked for yet
  mutable std::optional<State> whole_;      // of the whole body, where state_ has own bonds and all is shown
  mutable std::optional<Failed> failed_;    // first of all
  std::vector<Vec3d> r_begin_;              // of the rows that it moves; empty: Model::r_0
  CellEdges cell_begin_;                    // and the edges then
  std::array<double, 3> farthest_image_{};  // edges that an image may be away from what it meets
  double damped_by_cell_ = 0;  // on images, by the damping of bonds, as the cell moved in the step under way
  double farthest_ = 0, lost_beyond_ = 0;  // see Share
  std::vector<float> most_ahead_;          // of the rows that it moves, where that may be more  [length]
  double room_ = 0;                        // what may meet is known until a particle has gone so far
  std::int64_t unmet_ = 0;                 // steps since meet()
  bool has_outgrown_ = false;
  mutable std::vector<double> brought_in_;  // start and work after each step, since they were summed
  double last_way_ = 0;                     // a bound of the longest way of the last step  [length]
  mutable std::optional<Survey> survey_;    // empty: positions or velocities have changed since
};

}  // namespace vbond
