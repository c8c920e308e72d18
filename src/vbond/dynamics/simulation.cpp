// One time step: Simulation::step and what it calls, in this order.
#include "vbond/dynamics/simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "vbond/dynamics/kernel.hpp"

namespace vbond {

void Simulation::step() {
  const bool timed = state_.clock.stage_step % StepTimes::one_in == 0;
  begin_step();  // bonds are made; terms, cell, what supports and loads are in this step
  StepTimes::Lap lap(timed);
  team_.for_blocks([&](const Block& b) {  // kick, drift: where others look at the particles
    if (moves_first(b)) begin_step(b), carry_images(b);
  });
  lap.add_to(times_.integrate);
  send_halo();
  if (looks_at_ways()) {
    if (halo_under_way_) receive_halo();
    find_touches(lap);
  }
  step_blocks(timed);                  // kick, drift: all others. Then loads; kick
  complete_late_blocks(Instant::end);  // of particles with ghosts
  end_step();                          // terms, cell, free grips
  close_books();
  const bool events = !only_elastic_ && find_events();  // bonds break
  keep_records();
  if (!lost_particles_.empty()) tell_of_lost();
  if (--steps_to_look_ != 0 && !events) return;
  agree_on_failure();
  notify_observers();
}

/// Between steps, for what is not particles. Bonds are made between particles that came close.
void Simulation::begin_step() {
  if (!only_elastic_) {
    last_way_ = 0.0;
    taken_.clear();
    taken_shares_.clear();
    make_bonds();
  }
  for (MotionTerm* t : terms_.all()) t->begin_step();
  if (cell_.any()) {
    cell_.begin_step(state_.clock.stage_step, team_);
    if (const auto fault = cell_.fault()) {
      diverge(model_.particles(), "the cell", *fault,  // a particle that has failed as well is named first
              "strain it less or more slowly; a stress that nothing bears drives it without end; rotation = "
              "\"triangular\" shears without limit");
      agree_on_failure();  // of parts, which have all found it
    }
  }
  supports_.set_times(state_.clock.stage_step, stage_.dt);
  applied_.set_times(state_.clock.stage_step, stage_.dt);
  if (supports_.grips().any_free()) supports_.grips().begin_step();
}

/// Once all have moved: who is near whom, and what those that touch do to each other.
void Simulation::find_touches(StepTimes::Lap& lap) {
  const double way2 = largest_way2(), way = std::sqrt(way2);
  last_way_ = std::max(last_way_, way);
  contacts_.refresh(bodies_.poses(), all_known(), way);  // near pairs, listed anew only when stale
  capsules_.refresh();
  work_out_touches(stage_.dt);
  for (MotionTerm* t : terms_.touching()) t->particles_moved(stage_.dt, way);
  if (contacts_.any() || capsules_.any()) encounters_.look_at_drift(bodies_, stage_.dt, way2, flow());
  if (const auto& fast = encounters_.fastest(); capsules_.any() && (fast || capsules_.deep()))
    capsules_.look_at_drift(stage_.dt, way, fast ? fast->way : 0.0);
  lap.add_to(times_.contacts);
}

/// Blocks move, are loaded and kicked while they are in the cache, those of each part in their order, those
/// that get loads from ghosts last of all or not yet. Poses of ghosts may come as late as their own blocks.
void Simulation::step_blocks(bool timed) {
  all_known().for_parts([&](const Part& part) {
    StepTimes::Lap lap_of_part(timed && part.index == 0);
    const std::size_t last_moved = std::min(part.last_block, team_.blocks());
    std::size_t begun = part.first_block;  // blocks before this one have moved
    for (std::size_t k = part.first_block; k < part.last_block; ++k) {
      for (; begun < std::min(bonds_.reach(k), last_moved); ++begun)
        if (!moves_first(team_.block(begun))) begin_step(team_.block(begun));
      if (halo_under_way_ && all_known().block(k).rows.last > bodies_.order.ghosts) receive_halo();
      lap_of_part.add_to(times_.integrate);
      const RowsAhead ahead = begun < last_moved ? rows_of(team_.block(begun)) : RowsAhead{};
      add_mutual_loads(part, all_known().block(k), Instant::end, ahead, lap_of_part);
      if (k >= last_moved || is_late(team_.block(k))) continue;
      complete_block(team_.block(k), Instant::end, lap_of_part);
    }
    finish_part(part, Instant::end, lap_of_part);
  });
  if (halo_under_way_) receive_halo();  // a part may have no block with ghosts
}

/// What is not particles, at the end of the step. Grips that are free in part need the loads of all their
/// particles before these come there.
void Simulation::end_step() {
  if (supports_.grips().any_free()) {
    const double lost = supports_.grips().finish_step();
    lose(0, Loss::drag, lost);
    books_[0].work_supports += lost;
    team_.for_blocks([&](const Block& b) {
      if (supports_.grips().waits(b)) end_step(b);
    });
  }
  if (cell_.any()) {
    const CellMotion::Done done = cell_.end_step(team_);
    if (leads()) booked_.work_supports += done.work;
    if (leads() && bonds_.damp()) damped_by_cell_ = done.damping;
  }
  ++state_.clock.step;
  ++state_.clock.stage_step;  // time is counted, not summed
  has_changed();
  survey_.reset();
  for (MotionTerm* t : terms_.all()) t->end_step(stage_.dt);
}

/// Bonds need the new places of both their particles. A block is moved just before the first bonds that reach
/// it, and stays in the cache until then; but before all others if another thread or process may look at it:
/// at the border of a part, or anywhere where there are contacts.
bool Simulation::moves_first(const Block& b) const {
  return looks_at_ways() || bonds_.at_border(b.index) || is_early(b);
}

/// The half of a step before the loads.
void Simulation::begin_step(const Block& b) {
  const double dt = stage_.dt;
  BlockBooks& books = books_[b.index] = {};
  const bool more = !only_elastic_;
  if (more && anything_dissipates()) lost_[b.index] = {};
  if (more && damping_.is_drag())
    lose(b.index, Loss::drag, slow_down(b, cell_.L_start()));  // v, omega over dt / 2
  books.work_supports += supports_.hold(b, Instant::start);
  kick_and_book(b, Instant::start, Instant::middle, cell_.L_start());  // v, omega : t -> t + dt/2
  const bool turn_freely = more && (bodies_.tops.any() || supports_.grips().any_turn());
  const double before_drift = turn_freely ? dt / 2 : 0.0;  // their omega changes in the drift
  if (before_drift > 0.0) books.work_loads += applied_.work_of_half(b, before_drift, Instant::start);
  books.way2 = drift(b, dt);  // r, q     : t -> t + dt
  if (more && supports_.grips().any()) supports_.grips().carry(b);
  books.work_loads +=
      before_drift > 0.0 ? applied_.work_of_half(b, dt - before_drift, Instant::end) : applied_.work(b, dt);
  clear_loads(b);
}

/// The half of a step after the loads.
void Simulation::end_step(const Block& b) {
  BlockBooks& books = books_[b.index];
  kick_and_book(b, Instant::middle, Instant::end, cell_.L_end());  // v, omega : t + dt/2 -> t + dt
  if (!only_elastic_ && damping_.is_drag()) lose(b.index, Loss::drag, slow_down(b, cell_.L_end()));
  books.work_supports += supports_.hold(b, Instant::end);
}

/// Drag acts on what particles move beside the cell.
double Simulation::slow_down(const Block& b, const Tensor& flow) {
  if (!cell_.any()) return damping_.slow_down(b.rows);
  const auto add_flow = [&](double sign) {
    for (std::size_t k = b.rows.first; k < std::min(b.rows.last, bodies_.order.own); ++k)
      bodies_.motion[k].v += sign * vbond::times(flow, bodies_.pose[k].r);
  };
  add_flow(-1.0);
  const double lost = damping_.slow_down(b.rows);
  add_flow(1.0);
  return lost;
}

RowsAhead Simulation::rows_of(const Block& b) const {
  const std::size_t k = b.rows.first;
  return {&bodies_.pose[k], &bodies_.motion[k], &bodies_.load[k], b.rows.last - k};
}

/// A kick over half a step, with the work of supports and of damping in it. flow: that of the cell then.
void Simulation::kick_and_book(const Block& b, Instant from, Instant to, const Tensor& flow) {
  if (!only_elastic_ && !bodies_.damping.empty()) return kick_and_book_damping(b, from, to, flow);
  const double h = stage_.dt / 2;
  kick(b, h);
  books_[b.index].work_supports += supports_.hold_after_kick(b, from, to, h);
}

void Simulation::kick(const Block& b, double h) {
  books_[b.index].poison +=
      kernel_.kick(particles_of(b), h, bodies_.inverse.data(), bodies_.load.data(), bodies_.motion.data());
  if (bodies_.tops.any()) bodies_.tops.kick(b.rows, h, bodies_.load, bodies_.turning());
}

double Simulation::drift(const Block& b, double h) {
  if (bodies_.tops.any()) bodies_.tops.turn(b.rows, h, bodies_.turning());
  const double way2 = kernel_.drift(particles_of(b), h, bodies_.motion.data(), bodies_.pose.data());
  if (bodies_.tops.any()) bodies_.tops.put_turned(b.rows, bodies_.turning());  // omega as they now stand
  return way2;
}

void Simulation::clear_loads(const Block& b) {  // all at once: std::fill goes row by row
  static_assert(std::is_trivially_copyable_v<LoadRow>);
  const auto clear = [&b](LargeArray<LoadRow>& rows) {
    std::memset(static_cast<void*>(&rows[b.rows.first]), 0, (b.rows.last - b.rows.first) * sizeof(LoadRow));
  };
  clear(bodies_.load);
  if (!bodies_.damping.empty()) clear(bodies_.damping);
}

BondSweep Simulation::bond_sweep(Instant at) {
  return {bodies_.pose.data(), bodies_.load.data(), bodies_.motion.data(), bodies_.damping.data(),
          at == Instant::end ? stage_.dt : 0.0};
}

/// What particles do to each other. To be called block by block in the order of a part: bonds add to blocks
/// further on.
void Simulation::add_mutual_loads(const Part& part, const Block& b, Instant at, const RowsAhead& ahead,
                                  StepTimes::Lap& lap) {
  BondSweep sweep = bond_sweep(at);
  if (b.index == part.first_block) {
    bonds_.add_loads_from_below(part, sweep);
    sweep.dissipated = sweep.by_other_laws = 0.0;  // that of the parts below
  }
  if (!damped_.empty()) *(sweep.damped = &damped_[b.index]) = {};
  bonds_.add_loads(b, sweep, ahead, at == Instant::end ? &breaking_[part.index] : nullptr);
  lap.add_to(times_.bonds);
  if (!only_elastic_) {
    books_[b.index].dissipated += sweep.dissipated;
    lost_[b.index][Loss::other_laws] += sweep.by_other_laws;
  }
  if (!only_elastic_ && anything_touches()) {
    if (contacts_.any()) add_contact_loads(b, at == Instant::end ? stage_.dt : 0.0);
    lap.add_to(times_.contacts);
  }
}

void Simulation::add_contact_loads(const Block& b, double dt) {
  const RowRange rows = particles_of(b);
  if (contacts_.are_touches()) {
    TouchSums& touched = touched_[b.index];
    if (!contacts_.goes_first(b.index)) touched = contacts_.work_out(rows, bodies_, dt);
    lose(b.index, touched.lost);
    books_[b.index].deep = touched.deep;
  }
  books_[b.index].deep |= contacts_.add_loads(rows, bodies_.pose.data(), bodies_.load.data());
}

/// Once that is done for a block and all before it.
void Simulation::complete_block(const Block& b, Instant at, StepTimes::Lap& lap) {
  complete_loads(b, at, lap);  // F, M : at t + dt
  if (at == Instant::end && !supports_.grips().waits(b)) end_step(b);
  lap.add_to(times_.integrate);
}

/// All other loads.
void Simulation::complete_loads(const Block& b, Instant at, StepTimes::Lap& lap) {
  if (!only_elastic_ && bonds_.damp()) kernel_.add_rows(b.rows, bodies_.damping.data(), bodies_.load.data());
  if (!only_elastic_ && capsules_.any()) {
    capsules_.add_loads({b.rows.first, std::min(b.rows.last, bodies_.order.own)}, bodies_.load.data());
    lap.add_to(times_.contacts);
  }
  if (!terms_.loading().empty()) {
    for (MotionTerm* t : terms_.loading()) t->add_loads(b, at == Instant::end ? stage_.dt : 0.0);
    lap.add_to(times_.contacts);
  }
  applied_.add(b, at);
  if (!only_elastic_ && damping_.is_local()) damping_.oppose_motion(b.rows, flow());
}

/// What touching pairs do that other parts ask for, before any of it is added: all particles have moved, and
/// none has felt it yet.
void Simulation::work_out_touches(double dt) {
  if (capsules_.any())  // all parts work out all of them
    if (const TouchLosses<double> lost = capsules_.work_out(team_, dt); leads()) lose(0, lost);
  if (!contacts_.are_touches()) return;
  all_known().for_blocks([&](const Block& b) {
    if (contacts_.goes_first(b.index)) touched_[b.index] = contacts_.work_out(particles_of(b), bodies_, dt);
  });
}

void Simulation::lose(std::size_t block, const TouchLosses<double>& to_touches) {
  lose(block, Loss::contact_damping, to_touches.damping);
  lose(block, Loss::friction, to_touches.friction);
  lose(block, Loss::rolling, to_touches.rolling);
  lose(block, Loss::adhesion, to_touches.adhesion);
}

/// Shares out what the damping of bonds has taken in the step: as the powers of the channels in its middle
/// are.
void Simulation::share_damping(Losses& lost) const {
  Losses power;
  for (const DampedPower& of_block : damped_)
    for (std::size_t k = 0; k < std::size(DampedPower::causes); ++k)
      power[DampedPower::causes[k]] += of_block.of[k];
  double taken = lost[Loss::bond_damping];
  exchange_.sum(power.of);  // the shares are those of the whole body
  exchange_.sum({&taken, 1});
  const double all = power.sum();
  if (!(all > 0.0)) return;
  for (const Loss cause : DampedPower::causes) lost[cause] = leads() ? taken * (power[cause] / all) : 0.0;
}

void Simulation::close_books() {
  BlockBooks sum;
  for (const BlockBooks& b : books_) {
    sum.dissipated += b.dissipated;
    sum.work_loads += b.work_loads;
    sum.work_supports += b.work_supports;
    sum.poison += b.poison;
  }
  sum.dissipated += damped_by_cell_;
  booked_.dissipated += sum.dissipated;
  if (!only_elastic_ && anything_dissipates()) {
    Losses lost;
    for (const Losses& of_block : lost_) lost += of_block;
    lost[Loss::bond_damping] += std::exchange(damped_by_cell_, 0.0);
    if (bonds_.damp()) share_damping(lost);
    booked_.lost += lost;
  }
  booked_.work_loads += sum.work_loads;
  booked_.work_supports += sum.work_supports;
  books_ahead_ = true;
  if (!only_elastic_ && supports_.grips().any()) supports_.grips().close();
  if (sum.poison != 0.0) check_finite();
}

/// What has come to an end in the step, once its books are closed: whether observers must look at it. The
/// parts ask each other once in a step.
bool Simulation::find_events() {
  for (MotionTerm* t : terms_.all()) t->books_closed();
  if (capsules_.any()) look_at_capsules();
  if (contacts_.any()) look_at_deep_contacts();
  const bool breaks =
      std::any_of(breaking_.begin(), breaking_.end(), [](const auto& b) { return !b.empty(); });
  enum : std::size_t { failed, broke, met, deep, questions };
  std::array<double, questions> any{failed_ ? 1.0 : 0.0, breaks ? 1.0 : 0.0, encounters_.any() ? 1.0 : 0.0,
                                    capsules_.deep() ? 1.0 : 0.0};
  exchange_.max(any);
  if (any[failed] != 0.0) agree_on_failure();
  if (any[met] != 0.0) encounters_.share();
  return (any[broke] != 0.0 && break_bonds()) || any[met] != 0.0 || any[deep] != 0.0;
}

/// Of particles, and of images, which the cell moves on.
double Simulation::largest_way2() const {
  double way2 = 0.0;
  for (const BlockBooks& b : books_) way2 = std::max(way2, b.way2);
  if (cell_.any()) {
    CellEdges gone = state_.cell;
    for (CellEdge& e : gone) e.along = stage_.dt * e.rate;
    way2 = sq(std::sqrt(way2) + way_of_images(gone));
  }
  exchange_.max({&way2, 1});
  return way2;
}

}  // namespace vbond
