// A simulation of a part of a body, whose other parts other processes step.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/images.hpp"
#include "vbond/dynamics/borders.hpp"
#include "vbond/dynamics/gather.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/capsules.hpp"

namespace vbond {
namespace {

template <std::size_t N>
void put(const std::string& text, std::array<char, N>& to) {
  to.fill('\0');
  text.copy(to.data(), N - 1);
}

/// Of these places those that lie outermost along the edges of a cell: between them are all others.
std::vector<Vec3d> outermost(const CellEdges& cell, const std::vector<Vec3d>& places) {
  std::vector<Vec3d> found;
  for (int axis = 0; axis < 3 && !places.empty(); ++axis) {
    const auto [low, high] =
        std::minmax_element(places.begin(), places.end(), [&cell, axis](const Vec3d& a, const Vec3d& b) {
          return component(in_edges(cell, a), axis) < component(in_edges(cell, b), axis);
        });
    found.insert(found.end(), {*low, *high});
  }
  return found;
}

/// A column knows these particles besides.
void know(PerParticle<Vec3d>& r, const std::vector<PlacedParticle>& more) {
  if (r.holds_all() ||
      std::all_of(more.begin(), more.end(), [&r](const PlacedParticle& p) { return r.holds(p.particle); }))
    return;
  std::vector<ParticleId> some;
  r.held()->for_each([&some](ParticleId p) { some.push_back(p); });
  for (const PlacedParticle& p : more) some.push_back(p.particle);
  r.hold(std::make_shared<IdSet<ParticleId>>(r.size(), some));
}

}  // namespace

// ---- a step ------------------------------------------------------------------------------------------

HaloColumns Simulation::halo_columns() {
  const bool motion = bonds_.reads_rates() || contacts_.any() || capsules_.any();
  return {bodies_.pose, motion ? std::span(bodies_.motion) : std::span<MotionRow>(), &state_.cell};
}

/// The images of a block that has moved get where their particles are, and where loads depend on it, how they
/// move.
void Simulation::carry_images(const Block& b) {
  if (!parts_have_images() || !is_early(b)) return;
  images_.halo_of_block(b.index, halo_columns());
}

/// All ghosts get it, where parts have no images of their own; those of other parts until receive_halo().
void Simulation::send_halo() {
  if (!with_ghosts_) return;
  for (std::size_t b = team_.blocks(); b < all_known().blocks(); ++b) books_[b] = {}, lost_[b] = {};
  exchange_.begin_halo(halo_columns());
  halo_under_way_ = true;
  if (!bodies_.order.ghost_bonds_last) receive_halo();
}

void Simulation::receive_halo() {
  halo_under_way_ = false;
  exchange_.end_halo(halo_columns());
}

/// Whether particles of the block are ghosts of other parts, or have images; or it ends among ghosts, which
/// must not move on with it once they have the poses of the step's end.
bool Simulation::is_early(const Block& b) const {
  return bodies_.order.is_early(b.index) || (with_ghosts_ && b.rows.last > bodies_.order.own);
}

/// The sum over images of how many of each edge they are away times the force on them here, before it goes to
/// their particles; capsules give theirs to particles at once.
std::array<Vec3d, 3> Simulation::force_on_images() const {
  std::array<Vec3d, 3> sum = images_.edges_times_force(bodies_.load);
  const auto add = [&sum](const std::array<Vec3d, 3>& more) {
    for (std::size_t k = 0; k < 3; ++k) sum[k] += more[k];
  };
  if (!bodies_.damping.empty()) add(images_.edges_times_force(bodies_.damping));
  if (capsules_.any()) add(capsules_.edges_times_force(bodies_.order.own));
  return sum;
}

/// Whether the block ends its step after its part has ended: it gets the loads on ghosts of its particles or
/// of bonds with ghosts, or waits for other parts.
bool Simulation::is_late(const Block& b) const {
  return is_early(b) || (with_ghosts_ && bonds_.waits_for_ghosts(b.index)) || waits_for_parts(b);
}

/// Whether other parts may read how particles of the block move, until all bonds are done.
bool Simulation::waits_for_parts(const Block& b) const {
  return bonds_.reads_rates() && bonds_.at_border(b.index);
}

/// Whether the end of its part is that of a late block too: the images of its particles are the part's own,
/// no cell asks for the loads on all images, and no other part for its velocities.
bool Simulation::ends_with_its_part(const Block& b) const {
  return parts_have_images() && !cell_.any() && !waits_for_parts(b);
}

/// The end of a part that has images of its own.
void Simulation::finish_part(const Part& part, Instant at, StepTimes::Lap& lap) {
  if (!parts_have_images()) return;
  BondSweep sweep = bond_sweep(at);
  bonds_.add_loads_from_above(part, sweep);
  lap.add_to(times_.bonds);
  for (std::size_t b = part.first_block; b < part.last_block; ++b)
    if (ends_with_its_part(team_.block(b))) complete_late_block(team_.block(b), at, lap);
}

/// What is done to ghosts goes to their particles: none is left here, so that nothing is counted twice. Then
/// the block has all its loads.
void Simulation::complete_late_block(const Block& b, Instant at, StepTimes::Lap& lap) {
  if (!is_late(b)) return;
  if (parts_have_images()) {
    images_.reverse_sum_of_block(b.index, bodies_.load);
    if (!bodies_.damping.empty()) images_.reverse_sum_of_block(b.index, bodies_.damping);
  }
  complete_block(b, at, lap);
}

/// All of them that finish_part() has left.
void Simulation::complete_late_blocks(Instant at) {
  if (cell_.any()) {
    cell_.take_forces(force_on_images());
    if (!bodies_.damping.empty()) cell_.take_damping(images_.edges_times_force(bodies_.damping));
  }
  const bool some_wait = bonds_.reads_rates() && team_.parts().size() > 1;
  if (!with_ghosts_ && !cell_.any() && !some_wait) return;
  if (with_ghosts_) {
    exchange_.reverse_sum(bodies_.load);
    if (!bodies_.damping.empty()) exchange_.reverse_sum(bodies_.damping);
  }
  team_.for_blocks([&](const Block& b) {
    StepTimes::Lap untimed(false);
    if (!ends_with_its_part(b)) complete_late_block(b, at, untimed);
  });
}

/// The run cannot go on. Of a part, it ends when all have been told.
void Simulation::diverge(std::size_t first_particle, const std::string& who, const std::string& what,
                         const std::string& way_out) const {
  const Clock& clock = state_.clock;
  if (!is_part_) throw Diverged(clock.step, clock.time(), who, what, way_out);
  if (failed_) return;
  Failed& failed = failed_.emplace();
  failed.step = clock.step, failed.time = clock.time();
  failed.first_particle = static_cast<std::int64_t>(first_particle);
  put(who, failed.who), put(what, failed.what), put(way_out, failed.way_out);
}

/// All parts end at the step of the first that failed.
void Simulation::agree_on_failure() {
  if (!exchange_.any(failed_.has_value())) return;
  std::vector<Failed> mine;
  if (failed_) mine.push_back(*failed_);
  const std::vector<Failed> all = exchange_.gather(mine);
  const Failed& first = *std::min_element(all.begin(), all.end(), [](const Failed& a, const Failed& b) {
    return std::pair(a.step, a.first_particle) < std::pair(b.step, b.first_particle);
  });
  failed_.reset();
  state_.clock.stage_step += first.step - state_.clock.step;
  state_.clock.step = first.step;
  throw Diverged(first.step, first.time, first.who.data(), first.what.data(), first.way_out.data());
}

double Simulation::reach() const {
  return may_meet() ? std::max(contacts_.reach(), bonding_.reach()) : 0.0;
}

bool knows_all(const Model& model, const Stage& stage, const State& state) {
  return any_capsules(model.contact, state.bonds) ||
         std::any_of(stage.bonding.begin(), stage.bonding.end(),
                     [](const BondingRule& rule) { return rule.recipe.capsule; });
}

Acquaintance acquaintance(const Model& model, const Stage& stage, const State& state) {
  const Order nobody;
  const BondIndex none;
  const Contacts contacts(model, nobody, none);
  const bool may_meet = contacts.any() || any_capsules(model.contact, state.bonds) || !stage.bonding.empty();
  return {may_meet ? std::max(contacts.reach(), Bonding(model, stage, nobody, none).reach()) : 0.0,
          knows_all(model, stage, state)};
}

const Vec3d& Simulation::place_at_begin(std::size_t row) const {
  return r_begin_.empty() ? model_.r_0[bodies_.order.particle[Row{row}]] : r_begin_[row];
}

/// Two of different parts that are not near may come nearer to each other by their distance less what may
/// meet reaches, half of which is for each. Images that may come near are as many edges away as particles lie
/// apart, and what may meet reaches.
void Simulation::note_where_it_begins(const std::vector<BoundingBox>& others) {
  if (!is_known_for_a_while()) return;
  const std::size_t own = bodies_.order.own;
  for (std::size_t k = 0; k < own && !others.empty(); ++k) {
    double distance2 = BoundingBox::inf;
    for (const BoundingBox& box : others) distance2 = std::min(distance2, box.distance2(bodies_.pose[k].r));
    const double ahead = std::max(farthest_, 0.5 * (std::sqrt(distance2) - reach()));
    most_ahead_.push_back(static_cast<float>(ahead * (1.0 - 1e-6)));  // less, as rounded
  }
  for (std::size_t k = 0; k < own && r_begin_.empty(); ++k)
    if (bodies_.pose[k].r != place_at_begin(k)) r_begin_.resize(own);
  for (std::size_t k = 0; k < r_begin_.size(); ++k) r_begin_[k] = bodies_.pose[k].r;
  cell_begin_ = state_.cell;
  if (state_.cell.empty() || !may_meet()) return;
  std::vector<Vec3d> places = outermost(state_.cell, state_.r.values());
  if (!state_.r.holds_all()) places = exchange_.gather(places);
  farthest_image_ = farthest_images(state_.cell, model_.cell.periodic, places, reach() + 2.0 * farthest_);
}

/// How far images go with edges that go so far.
double Simulation::way_of_images(const CellEdges& edges) const {
  double way = 0.0;
  for (std::size_t k = 0; k < edges.size(); ++k) way += farthest_image_[k] * norm(edges[k].along);
  return way;
}

/// How far the particle of a row may go, and any that it may meet as far, before ghosts may be missing.
double Simulation::most_ahead(std::size_t row) const {
  return most_ahead_.empty() ? farthest_ : static_cast<double>(most_ahead_[row]);
}

/// Of the particles of all parts; no ways where they do not matter. What all go alike, as when they fall,
/// brings nobody nearer to others: that is the middle of the ways of those near other parts, or nothing. The
/// cell has moved images on.
Simulation::Ways Simulation::ways_since_begin() const {
  if (!is_known_for_a_while()) return {.room_left = BoundingBox::inf};
  const auto way_of = [this](std::size_t k) { return bodies_.pose[k].r - place_at_begin(k); };
  double most2 = 0.0;
  BoundingBox box;
  for (std::size_t k = 0; k < bodies_.order.own; ++k) {
    most2 = std::max(most2, norm2(way_of(k)));
    if (most_ahead(k) <= 2.0 * farthest_) box.add(way_of(k));
  }
  std::array<double, 7> most{std::sqrt(most2), box.high.x, box.high.y, box.high.z,
                             -box.low.x,       -box.low.y, -box.low.z};
  exchange_.max(most);
  const Vec3d alike = 0.5 * Vec3d{most[1] - most[4], most[2] - most[5], most[3] - most[6]};
  std::array<double, 2> beyond{-BoundingBox::inf, -BoundingBox::inf};  // of what particles may go
  for (std::size_t k = 0; k < bodies_.order.own; ++k) {
    beyond[0] = std::max(beyond[0], norm(way_of(k)) - most_ahead(k));
    if (is_finite(alike)) beyond[1] = std::max(beyond[1], norm(way_of(k) - alike) - most_ahead(k));
  }
  if (!is_finite(alike)) beyond[1] = beyond[0];
  exchange_.max(beyond);
  CellEdges gone = state_.cell;
  for (std::size_t k = 0; k < gone.size(); ++k) gone[k].along -= cell_begin_[k].along;
  return {most[0], -std::min(beyond[0], beyond[1]) - way_of_images(gone)};
}

// ---- the whole body ----------------------------------------------------------------------------------

std::vector<ParticleId> Simulation::own_particles() const {
  std::vector<ParticleId> own;
  own.reserve(bodies_.order.own);
  for (Row k{0}; k.value < bodies_.order.own; ++k.value) own.push_back(bodies_.order.particle[k]);
  std::sort(own.begin(), own.end());
  return own;
}

/// Whoever asks for the whole state asks the model for any particle; the next simulation shares it out again.
void Simulation::complete_model() const {
  if (shared_model_ != nullptr && !shared_model_->mass.holds_all())
    gather_particles(*shared_model_, own_particles(), exchange_);
}

std::vector<BondId> Simulation::own_bonds() const {
  std::vector<BondId> own;
  for (const BondId b : state_.bonds.ids())
    if (bodies_.order.has(state_.bonds[b].i)) own.push_back(b);
  return own;
}

/// They may be far away by now.
void Simulation::show_ends_of_broken() const {
  const Order& order = bodies_.order;
  std::vector<ParticleId> unknown;
  for (const Bond& b : state_.bonds)
    if (order.has(b.i) && !order.knows(b.j)) unknown.push_back(b.j);
  std::sort(unknown.begin(), unknown.end());
  unknown.erase(std::unique(unknown.begin(), unknown.end()), unknown.end());
  struct End {
    ParticleId particle;
    Vec3d r;
    Quatd q;
  };
  std::vector<End> ends;
  for (const ParticleId p : exchange_.gather(unknown))
    if (order.has(p)) ends.push_back({p, state_.r[p], state_.q[p]});
  for (const End& e : exchange_.gather(ends))
    if (state_.q.holds(e.particle)) state_.r[e.particle] = e.r, state_.q[e.particle] = e.q;
}

BodyPart Simulation::part(Show what, double near) const {
  if (what != Show::bonds) show_own();
  if (!is_part_) return state_;
  if (what == Show::ends_of_broken) show_ends_of_broken();
  return own_part(near > 0.0 ? near_own(near) : std::vector<ParticleId>{});
}

BodyPart Simulation::own_part(std::vector<ParticleId> near) const {
  const Order& order = bodies_.order;
  if (is_own_.empty()) {
    is_own_.resize(order.row.size());
    for (const ParticleId p : is_own_.ids())  // nobody moves those that are absent
      is_own_[p] = order.has(p) || (leads() && is_absent(state_, p));
  }
  return {state_, is_own_, part_bonds_, std::move(near), exchange_};
}

/// Ghosts are near enough where what may meet reaches so far; else parts ask each other.
std::vector<ParticleId> Simulation::near_own(double reach) const {
  const Order& order = bodies_.order;
  PerParticle<char> is_near(order.row.size());
  for (Row k{0}; k.value < order.known; ++k.value)
    if (!order.is_empty(k)) is_near[order.particle[k]] = 1;
  if (!(reach <= this->reach())) {
    const std::vector<PlacedParticle> across =
        particles_across_borders(model_, state_, own_particles(), reach, exchange_);
    know(state_.r, across);
    if (shared_model_ != nullptr) know(shared_model_->r_0, across);
    for (const PlacedParticle& p : across) {
      state_.r[p.particle] = p.r;
      if (shared_model_ != nullptr) shared_model_->r_0[p.particle] = p.r_0;
      is_near[p.particle] = 1;
    }
  }
  std::vector<ParticleId> near;
  near.reserve(static_cast<std::size_t>(std::count(is_near.begin(), is_near.end(), 1)));
  for (const ParticleId p : is_near.ids())
    if (is_near[p]) near.push_back(p);
  return near;
}

std::optional<StateOfPart> Simulation::state_of_part() const {
  if (!part_bonds_.own_alone || shown_ == Shown::all) return std::nullopt;
  show_own();
  show_loads();
  books();
  std::vector<ParticleId> own = own_particles();
  if (leads()) {
    const std::vector<ParticleId> of_nobody = absent(state_);
    own.insert(own.end(), of_nobody.begin(), of_nobody.end());
    std::sort(own.begin(), own.end());
  }
  return StateOfPart{state_, std::move(own), part_bonds_.names, shared_, exchange_};
}

/// Nobody looks at these any more.
void Simulation::make_room() {
  bonds_ = {};
  bond_index_ = {};
  bodies_.pose = {}, bodies_.motion = {}, bodies_.load = {}, bodies_.damping = {};
}

/// Where processes have own bonds alone, rows and packs make room for those of the others first.
State Simulation::give_state() {
  if (!part_bonds_.own_alone || shown_ == Shown::all) return std::move(collected());
  complete_model();
  show_own();
  show_loads();
  books();
  const std::vector<ParticleId> own = own_particles();
  make_room();
  gather_owned(state_, own, {}, false, exchange_);
  return with_all_bonds(std::move(state_), part_bonds_, shared_, exchange_);
}

}  // namespace vbond
