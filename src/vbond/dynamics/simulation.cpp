#include "vbond/dynamics/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/dynamics/gather.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/heat.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/model/state_table.hpp"

namespace vbond {
namespace {

/// The particles of each block, the bonds that are worked on with it, and contacts.
std::vector<std::size_t> work_of_blocks(const Model& model, const Bodies& bodies,
                                        const PerBond<Bond>& bonds) {
  std::vector<std::size_t> work((filled_up(bodies.order.own) + block_rows - 1) / block_rows,
                                work_of_particle(model) * block_rows);
  for (const Bond& b : bonds)
    if (const std::size_t row = lower_row(b, bodies.order); row < bodies.order.own) ++work[row / block_rows];
  return work;
}

/// All blocks alike.
std::vector<std::size_t> same_work(std::size_t rows) {
  return std::vector<std::size_t>((filled_up(rows) + block_rows - 1) / block_rows, block_rows);
}

Team team_of(const Model& model, const Bodies& bodies, const PerBond<Bond>& bonds, int threads,
             bool is_part) {
  const std::size_t own = bodies.order.own;
  if (!is_part) return {own, work_of_blocks(model, bodies, bonds), threads};
  return {own, same_work(own), 1};
}

/// What was dropped is not known, as the particles of other parts.
Order order_of(const Model& model, const State& state) {
  const Order all = spatial_order(model.r_0);
  if (state.dropped.empty()) return all;
  Holding rest;
  for (const ParticleId p : model.mass.ids())
    if (!is_dropped(state, p)) rest.own.push_back(p);
  return part_of(all, rest);
}

/// The model, if the three belong together. A part is one of a body that has been looked at.
const Model& consistent(const Model& model, const Stage& stage, const State& state, bool is_part) {
  if (is_part) return model;
  require_consistent("Simulation", model, stage, state);
  if (const auto bond = bond_without_length(state, growth_in(state, stage))) refuse("Simulation", {*bond});
  return model;
}

/// The fewest steps that any process would wait.
std::int64_t next_look_of_all(std::int64_t steps, const Exchange& exchange) {
  double sooner = -static_cast<double>(steps);
  exchange.max({&sooner, 1});
  return -sooner < static_cast<double>(steps) ? static_cast<std::int64_t>(-sooner) : steps;
}

}  // namespace

std::size_t work_of_particle(const Model& model) {
  return is_elastic(model.contact, model.materials) ? 1 : 7;
}

Simulation::Simulation(const Model& model, Stage stage, State* state, int threads)
    : Simulation(model, std::move(stage), state, threads, {order_of(model, *state)}, one_rank(), false) {}

Simulation::Simulation(const Model& model, Stage stage, State* state, Share share, Exchange& exchange)
    : Simulation(model, std::move(stage), state, 1, std::move(share), exchange, true) {}

Simulation::Simulation(const Model& model, Stage stage, State* state, int threads, Share share,
                       Exchange& exchange, bool is_part)
    : model_(consistent(model, stage, *state, is_part)),
      stage_(std::move(stage)),
      state_(std::move(*state)),
      booked_(state_.books),
      is_part_(is_part),
      exchange_(exchange),
      bodies_(model, std::move(share.order)),
      team_(team_of(model, bodies_, state_.bonds, threads, is_part)),
      contacts_(model, bodies_.order, bond_index_),
      capsules_(model, bodies_),
      encounters_(model, bond_index_, exchange),
      supports_(stage_, bodies_, team_),
      applied_(stage_, bodies_, team_),
      damping_(stage_, bodies_),
      walls_(model, stage_, bodies_, team_.blocks(), exchange),
      bonding_(model, stage_, bodies_.order, bond_index_, exchange),
      last_stage_step_(std::isfinite(stage_.stops.duration) ? steps_in(stage_.stops.duration, stage_.dt)
                                                            : std::numeric_limits<std::int64_t>::max()),
      farthest_(share.farthest),
      lost_beyond_(share.lost_beyond),
      room_(share.farthest) {
  if (is_part) with_ghosts_.emplace(bodies_.order.known, same_work(bodies_.order.known), 1);
  books_.resize(all_known().blocks());
  lost_.resize(all_known().blocks());
  try {
    const bool begun = is_part || state_.clock.stage_step != 0;
    if (!leads()) {  // parts add up
      booked_ = {.largest = booked_.largest};
      for (GripState& g : state_.grips) g.work = 0.0;
    }
    bodies_.read(state_);
    bodies_.tops.hold(stage_.supports, bodies_.order);
    breaking_.resize(team_.parts().size());
    bonds_changed();
    contacts_.refresh(bodies_.poses(), all_known());
    contacts_.restore(state_.contact_history);
    capsules_.restore(state_.fibre_history);
    walls_.read(state_);
    supports_.grips().read(state_, begun);
    state_.clock.dt = stage_.dt;
    if (begun)
      take_up_loads();
    else
      begin_stage();
    if (is_part)
      for (std::size_t k = 0; k < bodies_.order.own; ++k) r_begin_.push_back(bodies_.pose[k].r);
  } catch (...) {
    *state = std::move(state_);
    throw;
  }
}

void Simulation::begin_stage() {
  begin_anew(state_, Anew::stage);
  const bool run_begins = state_.clock.stage == 0 && state_.clock.step == 0;
  booked_.work_supports += walls_.put_off_and_on(team_, run_begins);
  evaluate_loads();
  if (run_begins) booked_ = opened_books(state_, energies().total());
  heat_at_start();
  supports_.set_times(0, stage_.dt);
  team_.for_blocks(
      [&](const Block& b) { books_[b.index] = {.work_supports = supports_.hold(b, Instant::start)}; });
  bodies_ahead_ = true;
  survey_.reset();
  close_books();
}

/// Whether elastic bonds, supports and loads are all there is, and particles like spheres.
bool Simulation::has_only_elastic_bonds() const {
  const bool same_body = stage_.bonding.empty() && stage_.heating.empty() && !stage_.strain;
  const bool same_particles = model_.principal.empty() && !supports_.grips().any();  // in all parts alike
  return bonds_.all_elastic() && same_body && same_particles && !anything_dissipates() &&
         !damping_.is_local();
}

void Simulation::step() {
  const bool timed = state_.clock.stage_step % StepTimes::one_in == 0;
  if (!only_elastic_) change_body();
  supports_.set_times(state_.clock.stage_step, stage_.dt);
  applied_.set_times(state_.clock.stage_step, stage_.dt);

  if (supports_.grips().any_free()) supports_.grips().begin_step();
  if (walls_.any()) walls_.move(state_.clock.stage_step, stage_.dt);

  StepTimes::Lap lap(timed);
  team_.for_blocks([&](const Block& b) {
    if (moves_first(b)) begin_step(b);
  });
  lap.add_to(times_.integrate);
  exchange_halo();
  if (looks_at_ways()) {
    const double way2 = largest_way2();
    last_way_ = std::max(last_way_, std::sqrt(way2));
    contacts_.refresh(bodies_.poses(), all_known(),
                      std::sqrt(way2));  // near pairs, listed anew only when stale
    capsules_.refresh(std::sqrt(way2));
    work_out_touches(stage_.dt);
    walls_.refresh(team_, std::sqrt(way2));
    walls_.look_at_drift(stage_.dt, std::sqrt(way2));
    if (contacts_.any() || capsules_.any()) encounters_.look_at_drift(bodies_, stage_.dt, way2);
    if (const auto& fast = encounters_.fastest(); capsules_.any() && (fast || capsules_.deep()))
      capsules_.look_at_drift(stage_.dt, fast ? fast->way : 0.0);
    lap.add_to(times_.contacts);
  }
  step_blocks(timed);
  if (supports_.grips().any_free()) finish_free_grips();
  complete_sent_blocks(Instant::end);
  ++state_.clock.step;
  ++state_.clock.stage_step;  // time is counted, not summed
  bodies_ahead_ = true;
  survey_.reset();
  if (!only_elastic_ && walls_.any()) close_walls(stage_.dt);
  close_books();
  const bool events = !only_elastic_ && find_events();
  keep_records();
  room_ -= last_way_;
  ++unmet_;
  if (!lost_to_walls_.empty()) tell_of_lost();
  if (--steps_to_look_ == 0 || events) {
    agree_on_failure();
    notify_observers();
  }
}

/// Blocks move, are loaded and kicked while they are in the cache, those of each part in their order. Those
/// that get loads from ghosts are left loaded.
void Simulation::step_blocks(bool timed) {
  all_known().for_parts([&](const Part& part) {
    StepTimes::Lap lap_of_part(timed && part.index == 0);
    const std::size_t last_moved = std::min(part.last_block, team_.blocks());
    std::size_t begun = part.first_block;  // blocks before this one have moved
    for (std::size_t k = part.first_block; k < part.last_block; ++k) {
      for (; begun < std::min(bonds_.reach(k), last_moved); ++begun)
        if (!moves_first(team_.block(begun))) begin_step(team_.block(begun));
      lap_of_part.add_to(times_.integrate);
      const RowsAhead ahead = begun < last_moved ? rows_of(team_.block(begun)) : RowsAhead{};
      add_mutual_loads(part, all_known().block(k), Instant::end, ahead, lap_of_part);
      if (k >= last_moved || is_sent(team_.block(k))) continue;
      complete_loads(team_.block(k), Instant::end, lap_of_part);  // F, M : at t + dt
      if (!supports_.grips().waits(team_.block(k))) end_step(team_.block(k));
      lap_of_part.add_to(times_.integrate);
    }
  });
}

/// Grips that are free in part need the loads of all their particles before these come to the end of the
/// step.
void Simulation::finish_free_grips() {
  const double lost = supports_.grips().finish_step();
  lose(0, Loss::drag, lost);
  books_[0].work_supports += lost;
  team_.for_blocks([&](const Block& b) {
    if (supports_.grips().waits(b)) end_step(b);
  });
}

/// What changes the body between steps.
void Simulation::change_body() {
  last_way_ = 0.0;
  taken_.clear();
  taken_shares_.clear();
  make_bonds();                         // between particles that came close
  if (!stage_.heating.empty()) heat();  // bonds get their lengths at the end of the step
  apply_strain();                       // r jumps, if it is due
}

/// Bonds need the new places of both their particles. A block is moved just before the first bonds that reach
/// it, and stays in the cache until then; but before all others if another thread or process may look at it:
/// at the border of a part, or anywhere where there are contacts.
bool Simulation::moves_first(const Block& b) const {
  return looks_at_ways() || bonds_.at_border(b.index) || is_sent(b);
}

/// The half of a step before the loads.
void Simulation::begin_step(const Block& b) {
  const double dt = stage_.dt;
  BlockBooks& books = books_[b.index] = {};
  const bool more = !only_elastic_;
  if (more && anything_dissipates()) lost_[b.index] = {};
  if (more && damping_.is_drag())
    lose(b.index, Loss::drag, damping_.slow_down(b.rows));  // v, omega over dt / 2
  books.work_supports += supports_.hold(b, Instant::start);
  if (more && !bodies_.damping.empty()) keep_rates(b);
  kick(b, dt / 2);  // v, omega : t -> t + dt/2
  books.work_supports += supports_.hold_after_kick(b, Instant::start, Instant::middle, dt / 2);
  if (more && inelastic()) {
    book_damping(b, dt / 2);
    keep_rates(b);
  }
  const bool turn_freely = more && (bodies_.tops.any() || supports_.grips().any_turn());
  const double before_drift = turn_freely ? dt / 2 : 0.0;  // their omega changes in the drift
  if (before_drift > 0.0) books.work_loads += applied_.work_of_half(b, before_drift, Instant::start);
  books.way2 = drift(b, dt);  // r, q     : t -> t + dt
  if (more && supports_.grips().any()) supports_.grips().carry(b);
  if (more && supports_.grips().any_turn() && inelastic()) keep_rates(b);
  books.work_loads +=
      before_drift > 0.0 ? applied_.work_of_half(b, dt - before_drift, Instant::end) : applied_.work(b, dt);
  clear_loads(b);
}

/// The half of a step after the loads.
void Simulation::end_step(const Block& b) {
  const double dt = stage_.dt;
  BlockBooks& books = books_[b.index];
  kick(b, dt / 2);  // v, omega : t + dt/2 -> t + dt
  books.work_supports += supports_.hold_after_kick(b, Instant::middle, Instant::end, dt / 2);
  if (!only_elastic_ && inelastic()) book_damping(b, dt / 2);
  if (!only_elastic_ && damping_.is_drag()) lose(b.index, Loss::drag, damping_.slow_down(b.rows));
  books.work_supports += supports_.hold(b, Instant::end);
}

RowsAhead Simulation::rows_of(const Block& b) const {
  const std::size_t k = b.rows.first;
  return {&bodies_.pose[k], &bodies_.motion[k], &bodies_.load[k], b.rows.last - k};
}

StopReason Simulation::run(const std::function<bool()>& interrupted, std::int64_t most) {
  if (state_.clock.stage_step == 0) notify_observers();
  StopReason why = stop_reason();
  while (why == StopReason::running && most > 0 &&
         !has_outgrown_) {  // never interrupted before the first step
    step(), --most, why = stop_reason();
    if (why == StopReason::running && is_time_to_meet() && meet(interrupted && interrupted()))
      why = StopReason::interrupted;
  }
  agree_on_failure();
  if (why != StopReason::running) finish(why);
  return why;
}

void Simulation::finish(StopReason why) {
  for (const auto& o : observers_) exchange_.together([&] { o->finish(*this, why); });
}

void Simulation::notify_observers() {
  steps_to_look_ = std::numeric_limits<std::int64_t>::max();
  if (observers_.empty()) return;  // events are then kept
  for (const auto& o : observers_) {
    exchange_.together([&] { o->observe(*this); });
    steps_to_look_ = std::min(steps_to_look_, std::max<std::int64_t>(1, o->steps_to_next_look(state_.clock)));
  }
  if (is_part_) steps_to_look_ = next_look_of_all(steps_to_look_, exchange_);
  events_.clear();
}

void Simulation::kick(const Block& b, double h) {
  books_[b.index].poison +=
      kernel_.kick(b.rows, h, bodies_.inverse.data(), bodies_.load.data(), bodies_.motion.data());
  if (bodies_.tops.any()) bodies_.tops.kick(b.rows, h, bodies_.load, bodies_.turning());
}

double Simulation::drift(const Block& b, double h) {
  if (bodies_.tops.any()) bodies_.tops.turn(b.rows, h, bodies_.turning());
  const double way2 = kernel_.drift(b.rows, h, bodies_.motion.data(), bodies_.pose.data());
  if (!bodies_.tops.any()) return way2;
  bodies_.tops.put_turned(b.rows, bodies_.turning());
  if (inelastic()) keep_rates(b);  // omega at the new orientations
  return way2;
}

void Simulation::clear_loads(const Block& b) {  // all at once: std::fill goes row by row
  static_assert(std::is_trivially_copyable_v<LoadRow>);
  const auto clear = [&b](std::vector<LoadRow>& rows) {
    std::memset(static_cast<void*>(&rows[b.rows.first]), 0, (b.rows.last - b.rows.first) * sizeof(LoadRow));
  };
  clear(bodies_.load);
  if (!bodies_.damping.empty()) clear(bodies_.damping);
}

/// What particles do to each other. To be called block by block in the order of a part: bonds add to blocks
/// further on.
void Simulation::add_mutual_loads(const Part& part, const Block& b, Instant at, const RowsAhead& ahead,
                                  StepTimes::Lap& lap) {
  const PoseRow* pose = bodies_.pose.data();
  LoadRow* load = bodies_.load.data();
  const bool in_step = at == Instant::end;
  BondSweep sweep{
      part.rows, pose, load, bodies_.rates.data(), bodies_.damping.data(), in_step ? stage_.dt : 0.0};
  if (b.index == part.first_block) {
    bonds_.add_loads_from_below(part, sweep);
    sweep.dissipated = sweep.by_other_laws = 0.0;  // that of the parts below
  }
  if (!damped_.empty()) *(sweep.damped = &damped_[b.index]) = {};
  bonds_.add_loads(b, sweep, ahead, in_step ? &breaking_[part.index] : nullptr);
  lap.add_to(times_.bonds);
  if (!only_elastic_) {
    books_[b.index].dissipated += sweep.dissipated;
    lost_[b.index][Loss::other_laws] += sweep.by_other_laws;
  }
  if (!only_elastic_ && anything_touches()) {
    if (contacts_.any()) books_[b.index].deep |= contacts_.add_loads(particles_of(b), pose, load);
    lap.add_to(times_.contacts);
  }
}

/// All else, once that is done.
void Simulation::complete_loads(const Block& b, Instant at, StepTimes::Lap& lap) {
  if (!only_elastic_ && capsules_.any()) {
    capsules_.add_loads({b.rows.first, std::min(b.rows.last, bodies_.order.own)}, bodies_.load.data());
    lap.add_to(times_.contacts);
  }
  if (!only_elastic_ && walls_.any()) {
    lose(b.index, walls_.add_loads(b, bodies_.load.data(), at == Instant::end ? stage_.dt : 0.0));
    lap.add_to(times_.contacts);
  }
  applied_.add(b, at);
  if (!only_elastic_ && damping_.is_local()) damping_.oppose_motion(b.rows);
}

/// What touching pairs do, before any of it is added: all particles have moved, and none has felt it yet.
void Simulation::work_out_touches(double dt) {
  if (capsules_.any())  // all parts work out all of them
    if (const TouchLosses<double> lost = capsules_.work_out(team_, dt); leads()) lose(0, lost);
  if (!contacts_.are_touches()) return;
  all_known().for_blocks([&](const Block& b) {
    const TouchSums found = contacts_.work_out(particles_of(b), bodies_, dt);
    lose(b.index, found.lost);
    books_[b.index].deep = found.deep;
  });
}

/// Between steps: what reads rates reads the present ones, and nothing is remembered or broken.
void Simulation::evaluate_loads() {
  survey_.reset();
  if (inelastic()) bodies_.rates = bodies_.motion;
  exchange_halo();
  contacts_.refresh(bodies_.poses(), all_known());
  capsules_.refresh();
  work_out_touches(0.0);
  walls_.refresh(team_);
  applied_.set_times(state_.clock.stage_step, stage_.dt);
  team_.for_blocks([&](const Block& b) { clear_loads(b); });
  all_known().for_parts([&](const Part& part) {
    StepTimes::Lap untimed(false);
    for (std::size_t k = part.first_block; k < part.last_block; ++k) {
      add_mutual_loads(part, all_known().block(k), Instant::start, {}, untimed);
      if (k < team_.blocks() && !is_sent(team_.block(k)))
        complete_loads(team_.block(k), Instant::start, untimed);
    }
  });
  complete_sent_blocks(Instant::start);
  if (walls_.any()) close_walls(0.0);
  check_finite();
  agree_on_failure();
}

void Simulation::lose(std::size_t block, const TouchLosses<double>& in_contacts) {
  lose(block, Loss::contact_damping, in_contacts.damping);
  lose(block, Loss::friction, in_contacts.friction);
  lose(block, Loss::rolling, in_contacts.rolling);
  lose(block, Loss::adhesion, in_contacts.adhesion);
}

void Simulation::close_books() {
  BlockBooks sum;
  for (const BlockBooks& b : books_) {
    sum.dissipated += b.dissipated;
    sum.work_loads += b.work_loads;
    sum.work_supports += b.work_supports;
    sum.poison += b.poison;
  }
  booked_.dissipated += sum.dissipated;
  if (!only_elastic_ && anything_dissipates()) {
    Losses lost;
    for (const Losses& of_block : lost_) lost += of_block;
    if (bonds_.damp()) share_damping(lost);
    booked_.lost += lost;
  }
  booked_.work_loads += sum.work_loads;
  booked_.work_supports += sum.work_supports;
  books_ahead_ = true;
  if (!only_elastic_ && supports_.grips().any()) supports_.grips().close();
  if (sum.poison != 0.0) check_finite();
}

double Simulation::largest_way2() const {
  double way2 = 0.0;
  for (const BlockBooks& b : books_) way2 = std::max(way2, b.way2);
  exchange_.max({&way2, 1});
  return way2;
}

const State& Simulation::state() const {
  if (std::exchange(bodies_ahead_, false)) {
    collect_own();
    books_ahead_ = true;
    if (is_part_) gather_owned(state_, own_particles(), own_bonds(), exchange_);
  }
  books();
  return state_;
}

/// What this process knows of particles, bonds and pairs.
void Simulation::collect_own() const {
  bodies_.write(state_);
  if (bonds_.remembers()) bonds_.collect(state_.bond_history);
  state_.contact_history = contacts_.collect();
  state_.fibre_history = capsules_.collect();
  if (walls_.any()) walls_.write(state_);
  supports_.grips().write(state_);
  const bool loads_follow = bonds_.all_elastic() && !contacts_.are_touches() && !capsules_.any() &&
                            !walls_.any() && !damping_.is_local();
  state_.loads = loads_follow ? Loads{} : loads();
  state_.damping = bodies_.damping.empty() ? Loads{} : bodies_.collect(bodies_.damping);
  state_.local_damping = bodies_.local_damping.empty() ? Loads{} : bodies_.collect(bodies_.local_damping);
}

State Simulation::take_state() && {
  state();
  return std::move(state_);
}

void Simulation::apply_strain() {
  if (!stage_.strain) return;
  const StrainProgram& strain = *stage_.strain;
  if (state_.clock.stage_step % steps_in(strain.every, stage_.dt) != 0) return;

  const double U_before = survey_here().energies.potential();
  team_.for_blocks([&](const Block& b) { clear_loads(b); });
  applied_.set_times(state_.clock.stage_step, stage_.dt);
  team_.for_blocks([&](const Block& b) { applied_.add(b, Instant::start); });
  double work_applied = 0.0;
  for (const ParticleId p : strain.particles) {
    if (!bodies_.order.has(p)) continue;
    const std::size_t row = bodies_.order.row[p].value;
    Vec3d& r = bodies_.pose[row].r;
    const Vec3d dr = strain.increment * dot(strain.direction, r - strain.centre) * strain.direction;
    r += dr;
    work_applied += dot(bodies_.load[row].F, dr);
  }
  bodies_ahead_ = true;
  last_way_ = std::numeric_limits<double>::infinity();
  evaluate_loads();
  booked_.work_loads += work_applied;
  booked_.work_supports += survey_here().energies.potential() - U_before - work_applied;
}

}  // namespace vbond
