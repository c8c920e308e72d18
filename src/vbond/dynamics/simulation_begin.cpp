// How the simulation of a stage is set up, begins the stage, and knows its loads between steps.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/dynamics/gather.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/terms/heat/heat.hpp"

namespace vbond {
namespace {

/// The particles of each block, the bonds that are worked on with it, and contacts.
std::vector<std::size_t> work_of_blocks(const Model& model, const Bodies& bodies,
                                        const PerBond<Bond>& bonds) {
  std::vector<std::size_t> work((filled_up(bodies.order.own) + block_rows - 1) / block_rows,
                                work_of_particle(model) * block_rows);
  for (const Bond& b : bonds) {
    if (!b.broken && bodies.order.has(b.i)) ++work[lower_row(b, bodies.order) / block_rows];
  }
  return work;
}

/// The model, if the three belong together. A part is one of a body that has been looked at.
const Model& consistent(const Model& model, const Stage& stage, const State& state, bool is_part) {
  if (!is_part) require_able_to_begin(model, stage, state);
  return model;
}

PartBonds bonds_of_part(const Model& model, const Stage& stage, Share& share, const Exchange* exchange,
                        State& state, SharedByBonds& shared) {
  const Order& order = share.order;
  if (share.bonds) return keep_known_bonds(*std::exchange(share.bonds, {}), state, order, shared);
  if (share.part) {
    PartHandedOver part = *std::exchange(share.part, {});
    shared = std::move(part.shared);
    part.bonds.others = ends_of_others(part.bonds.names, state, order, *exchange);
    return std::move(part.bonds);
  }
  if (exchange == nullptr || exchange->ranks() == 1 || knows_all(model, stage, state)) return {};
  return keep_own_bonds(state, order, exchange->leads(), shared);
}

/// Leaves a state what a part has of bonds and particles, and so a model that the share has; those of others
/// make room before there are rows and packs.
PartBonds keep_part(const Model& model, const Stage& stage, Share& share, const Exchange* exchange,
                    State& state, SharedByBonds& shared) {
  PartBonds bonds = bonds_of_part(model, stage, share, exchange, state, shared);
  if (!bonds.own_alone) return bonds;
  const auto particles = particles_of_part(state, stage, share.order);
  keep_particles(state, particles);
  if (share.model != nullptr) keep_particles(*share.model, particles);
  return bonds;
}

}  // namespace

void require_able_to_begin(const Model& model, const Stage& stage, const State& state) {
  require_consistent("Simulation", model, stage, state);
  if (const auto bond = bond_without_length(state, growth_in(state, stage))) refuse("Simulation", {*bond});
}

std::size_t work_of_particle(const Model& model) {
  return is_elastic(model.contact, model.materials) ? 1 : 7;
}

Simulation::Simulation(const Model& model, Stage stage, State* state, int threads)
    : Simulation(model, stage, state, threads, whole_body(model, stage, *state), nullptr) {}

Simulation::Simulation(const Model& model, Stage stage, State* state, Share share, Exchange& exchange)
    : Simulation(model, std::move(stage), state, 1, std::move(share), &exchange) {}

Simulation::Simulation(const Model& model, Stage stage, State* state, int threads, Share share,
                       Exchange* exchange)
    : model_(consistent(model, stage, *state, exchange != nullptr)),
      shared_model_(share.model),
      mass_of_all_(share.part ? share.part->mass_of_all
                              : std::accumulate(model.mass.begin(), model.mass.end(), 0.0)),
      stage_(std::move(stage)),
      state_(std::move(*state)),
      before_hold_(take_hold(
          model, stage_.supports, state_,
          [&](ParticleId p) { return exchange == nullptr || share.order.has(p); },
          exchange != nullptr ? *exchange : alone())),
      booked_(state_.books),
      is_part_(exchange != nullptr),
      part_bonds_(keep_part(model, stage_, share, exchange, state_, shared_)),
      bodies_(model, std::move(share.order)),
      images_(bodies_.order),
      exchange_(is_part_ ? *exchange : images_),
      team_(bodies_.order.own, work_of_blocks(model, bodies_, state_.bonds), is_part_ ? 1 : threads),
      contacts_(model, bodies_.order, bond_index_, step_kernel(), stage_.supports),
      capsules_(model, stage_, bodies_, state_.cell),
      encounters_(model, bond_index_, exchange_, stage_.supports),
      supports_(stage_, bodies_, team_),
      applied_(stage_, bodies_, team_),
      damping_(stage_, bodies_),
      cell_(model, stage_, bodies_, state_.cell, exchange_),
      bonding_(model, stage_, bodies_.order, bond_index_, exchange_),
      terms_({model_, stage_, state_, bodies_, bonds_, team_, exchange_, booked_, *this}),
      last_stage_step_(std::isfinite(stage_.stops.duration) ? steps_in(stage_.stops.duration, stage_.dt)
                                                            : std::numeric_limits<std::int64_t>::max()),
      farthest_(share.farthest),
      lost_beyond_(share.lost_beyond),
      room_(share.farthest) {
  if (has_ghosts() && (is_part_ || contacts_.any() || !stage_.bonding.empty()))
    with_ghosts_.emplace(team_, bodies_.order.known);
  else
    team_.give_images([this](const Part& p) { return images_.rows_of(p.first_block, p.last_block); });
  times_.threads = static_cast<int>(team_.parts().size());
  books_.resize(all_known().blocks());
  lost_.resize(all_known().blocks());
  touched_.resize(all_known().blocks());
  try {
    const bool begun = (is_part_ && !share.begins) || state_.clock.stage_step != 0;
    if (!leads()) {  // parts add up
      booked_ = {.largest = booked_.largest};
      for (GripState& g : state_.grips) g.work = 0.0;
    }
    bodies_.read(state_);
    exchange_.halo({bodies_.pose, bodies_.motion, &state_.cell});  // so that pairs with images are found
    bodies_.tops.hold(stage_.supports, bodies_.order);
    breaking_.resize(all_known().parts().size());
    bonds_changed();
    contacts_.refresh(bodies_.poses(), all_known());
    read_memories();
    supports_.grips().read(state_, begun);
    state_.clock.dt = stage_.dt;
    next_visit_ = next_visit(stage_, state_.clock.stage_step);
    if (begun)
      take_up_loads();
    else
      begin_stage();
    note_where_it_begins(share.others);
    if (part_bonds_.own_alone) has_changed();  // it was whole
    before_hold_.reset();
  } catch (const Diverged&) {  // of all parts alike
    if (part_bonds_.own_alone) {
      complete_model();
      gather_particles(state_, own_particles(), exchange_);
      *state = with_all_bonds(std::move(state_), part_bonds_, shared_, exchange_);
    } else {
      *state = std::move(state_);
    }
    if (before_hold_) std::move(*before_hold_).put_back(*state);
    throw;
  } catch (...) {
    if (before_hold_) std::move(*before_hold_).put_back(state_);
    *state = std::move(state_);
    throw;
  }
}

void Simulation::begin_stage() {
  begin_anew(state_, Anew::stage);
  const bool run_begins = state_.clock.stage == 0 && state_.clock.step == 0;
  if (cell_.any() && !stage_.cell.any()) cell_.stop(team_);
  for (MotionTerm* t : terms_.all()) t->before_stage(run_begins);
  evaluate_loads();
  if (cell_.any()) cell_.look(team_);
  if (run_begins) {
    const EnergyBooks opened = opened_books(part(Show::bonds), energies().total());
    booked_ = leads() ? opened : EnergyBooks{.largest = opened.largest};
  }
  for (MotionTerm* t : terms_.all()) t->begin_stage();
  supports_.set_times(0, stage_.dt);
  team_.for_blocks(
      [&](const Block& b) { books_[b.index] = {.work_supports = supports_.hold(b, Instant::start)}; });
  has_changed();
  survey_.reset();
  close_books();
}

/// Between steps: what reads rates reads the present ones, and nothing is remembered or broken.
void Simulation::evaluate_loads() {
  survey_.reset();
  team_.for_blocks([&](const Block& b) { carry_images(b); });
  send_halo();
  if (halo_under_way_) receive_halo();
  contacts_.refresh(bodies_.poses(), all_known());
  capsules_.refresh();
  work_out_touches(0.0);
  for (MotionTerm* t : terms_.touching()) t->particles_moved(0.0, std::numeric_limits<double>::infinity());
  applied_.set_times(state_.clock.stage_step, stage_.dt);
  team_.for_blocks([&](const Block& b) { clear_loads(b); });
  all_known().for_parts([&](const Part& part) {
    StepTimes::Lap untimed(false);
    for (std::size_t k = part.first_block; k < part.last_block; ++k) {
      add_mutual_loads(part, all_known().block(k), Instant::start, {}, untimed);
      if (k < team_.blocks() && !is_late(team_.block(k)))
        complete_block(team_.block(k), Instant::start, untimed);
    }
    finish_part(part, Instant::start, untimed);
  });
  complete_late_blocks(Instant::start);
  for (MotionTerm* t : terms_.all()) t->end_step(0.0);
  check_finite();
  agree_on_failure();
}

void Simulation::apply_loads_alone() {
  team_.for_blocks([&](const Block& b) { clear_loads(b); });
  applied_.set_times(state_.clock.stage_step, stage_.dt);
  team_.for_blocks([&](const Block& b) { applied_.add(b, Instant::start); });
}

void Simulation::particles_jumped() {
  has_changed();
  last_way_ = std::numeric_limits<double>::infinity();
  evaluate_loads();
}

/// Whether elastic bonds, supports and loads are all there is, and particles like spheres.
bool Simulation::has_only_elastic_bonds() const {
  const bool same_body = stage_.bonding.empty() && !terms_.any();
  const bool same_particles = model_.principal.empty() && !supports_.grips().any();  // in all parts alike
  return bonds_.all_elastic() && same_body && same_particles && !anything_dissipates() &&
         !damping_.is_local();
}

}  // namespace vbond
