#include "vbond/model/passage.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "vbond/core/counter_random.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/free_room.hpp"
#include "vbond/model/make_bond.hpp"

namespace vbond {
namespace {

/// Times of a stage in whole steps; no_visit: never.
std::int64_t step_at(double time, double dt) {
  const double steps = std::ceil(time / dt - 1e-6);
  return steps < 0x1p62 ? static_cast<std::int64_t>(std::max(0.0, steps)) : no_visit;
}
std::int64_t last_step_at(double time, double dt) {
  const double steps = std::floor(time / dt + 1e-6);
  return steps < 0x1p62 ? static_cast<std::int64_t>(steps) : no_visit - 1;
}

std::int64_t next_visit(const Visits& v, std::int64_t last, double dt, std::int64_t stage_step) {
  const std::int64_t n = steps_between(v, dt),
                     first = std::max({std::int64_t{1}, stage_step, step_at(v.from, dt)});
  if (first > no_visit - n) return no_visit;
  const std::int64_t at = (first + n - 1) / n * n;
  return at <= last ? at : no_visit;
}
template <class Visited>
bool is_visited(const Visited& v, const Stage& stage, const State& s) {
  return next_visit(v, stage.dt, s.clock.stage_step) == s.clock.stage_step;
}

/// What becomes due in these steps of a stage.
void count_due(const Model& model, const Inflow& inflow, double dt, std::int64_t first, std::int64_t last,
               State& s) {
  s.sources.resize(model.sources.size());
  double& due = s.sources[inflow.source].due;
  const auto all = static_cast<double>(model.sources[inflow.source].bodies);
  const std::int64_t from = std::max(first, step_at(inflow.visits.from, dt)),
                     to = std::min(last, last_step_at(inflow.visits.until, dt));
  if (!(inflow.rate > 0.0)) {
    if (last >= from && from <= to) due = all;
  } else if (to > from) {
    due = std::min(all, due + inflow.rate * dt * static_cast<double>(to - from));
  }
}

Vec3d centre_of_mass(const Model& model, const State& s, const Source& source, std::size_t body) {
  double mass = 0.0;
  Vec3d sum;
  for (std::size_t k = 0; k < source.body.size(); ++k) {
    const ParticleId p = source.particle(body, k);
    mass += model.mass[p], sum += model.mass[p] * s.r[p];
  }
  return sum / mass;
}

double rotation_energy_of(const Model& model, const State& s, ParticleId p) {
  if (!model.is_top(p)) return 0.5 * model.inertia[p] * norm2(s.omega[p]);
  return rotation_energy(model.principal[p].moments, s.q[p] * model.principal[p].axes, s.omega[p]);
}

/// A body as it is placed.
std::vector<FreeRoom::Ball> balls_of(const Model& model, const Source& source, std::size_t body,
                                     const Placing& at) {
  std::vector<FreeRoom::Ball> balls;
  for (std::size_t k = 0; k < at.r.size(); ++k)
    balls.push_back({at.r[k], model.radius[source.particle(body, k)]});
  return balls;
}

/// Of the repulsion between particles of a body that has come in with these bonds.  [energy]
double contact_energy_inside(const Model& model, const State& s, const Source& source, std::size_t body,
                             const std::vector<Bond>& bonds) {
  if (!particles_touch(model.contact)) return 0.0;
  std::set<std::pair<ParticleId, ParticleId>> exempt;
  if (model.contact.pairs == ContactPairs::unbonded)
    for (const Bond& b : bonds) exempt.insert(std::minmax(b.i, b.j));
  double U = 0.0;
  for (std::size_t k = 0; k < source.body.size(); ++k)
    for (std::size_t l = k + 1; l < source.body.size(); ++l) {
      const ParticleId p = source.particle(body, k), q = source.particle(body, l);
      if (exempt.count(std::minmax(p, q)) == 0) U += contact_pair_energy(model, s, p, q);
    }
  return U;
}

/// Puts the body where it comes in, with its bonds. Bonds are made as the particles wait, so that all bodies
/// of a source are alike to the last bit.
void come_in(const Model& model, const Source& source, std::size_t body, const Placing& at, State& s,
             Passage& done) {
  std::vector<Bond> bonds;
  std::vector<std::uint32_t> recipes;
  for (const SourceBond& b : source.bonds)
    if (const auto bond = bond_of_body(model, s, source, body, b))
      bonds.push_back(*bond), recipes.push_back(b.recipe);
  if (s.came_at.empty()) s.came_at = model.r_0;
  for (std::size_t k = 0; k < source.body.size(); ++k) {
    const ParticleId p = source.particle(body, k);
    s.r[p] = s.came_at[p] = at.r[k];
    s.q[p] = source.turned ? normalised(at.turn * s.q[p]) : s.q[p];
    s.v[p] = at.velocity + cross(at.angular_velocity, between(at.centre, at.r[k]));
    s.omega[p] = at.angular_velocity;
    if (!s.spin.empty())  // follows from omega
      s.spin[p] = model.is_top(p) ? angular_momentum(model.principal[p].moments,
                                                     s.q[p] * model.principal[p].axes, s.omega[p])
                                  : Vec3d{};
    s.mass.mass_in += model.mass[p];
    s.mass.momentum_in += model.mass[p] * s.v[p];
    done.brought += 0.5 * model.mass[p] * norm2(s.v[p]) + rotation_energy_of(model, s, p);
  }
  s.mass.particles_in += static_cast<std::int64_t>(source.body.size());
  const EnergyBooks books = s.books;  // of bonds that are made in the run
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    const BondId id{s.bonds.size()};
    add_bond(model, bonds[k], source.recipes[recipes[k]], s);
    done.events.push_back({BondEvent::Kind::made, id, s.clock.step});
    const BondEnergy<double> U = bond_energy(s, id);
    done.brought += U.U_L + U.U_B + U.U_T;
    done.flowed += history_of_bond(s, id)[memory::dissipated];
  }
  s.books = books;
  done.brought += contact_energy_inside(model, s, source, body, bonds);
  done.any_come = true;
}

/// A box around the part of a region that images of a cell's particles need: of infinite sides some edges.
BoundingBox limited(BoundingBox box, const CellEdges& cell) {
  double far = 0.0;
  for (const CellEdge& edge : cell) far += norm(edge.along);
  for (int k = 0; k < 3; ++k) {
    double &low = component(box.low, k), &high = component(box.high, k);
    if (std::isinf(low) && std::isinf(high)) low = -far, high = far;
    if (std::isinf(low)) low = high - far;
    if (std::isinf(high)) high = low + far;
  }
  return box;
}

/// Whether a sink's region holds the particle, or in a periodic body one of its images.
bool is_in(const Space& region, const Model& model, const State& s, ParticleId p) {
  if (s.cell.empty()) return region.holds(s.r[p], 0.0);
  const Vec3d r =
      s.r[p] + to_image(s.cell, image_in_cell(s.cell, model.cell.periodic, model.cell.corner, s.r[p]));
  bool holds = region.holds(r, 0.0);
  for_images_in(limited(region.box, s.cell), s.cell, model.cell.periodic, r,
                [&](const Image& n) { holds = holds || region.holds(r + to_image(s.cell, n), 0.0); });
  return holds;
}

/// Particles that are where they are to be taken out.
std::vector<ParticleId> who_goes(const Model& model, const Stage& stage, const State& s) {
  std::vector<ParticleId> gone;
  for (const Sink& o : stage.sinks) {
    if (!is_visited(o, stage, s)) continue;
    for (const ParticleId p : s.r.ids())
      if ((o.particles.empty() || o.particles[p.value] != 0) && !is_absent(s, p) &&
          is_in(*o.region, model, s, p) != o.outside)
        gone.push_back(p);
  }
  std::sort(gone.begin(), gone.end());
  gone.erase(std::unique(gone.begin(), gone.end()), gone.end());
  if (!gone.empty()) std::erase_if(gone, [&stage](ParticleId p) { return !can_do_without(stage, p); });
  return gone;
}

void take_out(const Model& model, const Stage& stage, State& s, Passage& done) {
  const std::vector<ParticleId> gone = who_goes(model, stage, s);
  if (gone.empty()) return;
  for (const ParticleId p : gone) {
    s.mass.mass_out += model.mass[p];
    s.mass.momentum_out += model.mass[p] * s.v[p];
  }
  s.mass.particles_out += static_cast<std::int64_t>(gone.size());
  done.events = drop(gone, s);
  s.taken.insert(s.taken.end(), gone.begin(), gone.end());
  std::sort(s.taken.begin(), s.taken.end());
  done.any_gone = true;
}

/// Loads of the new particles are not known; those of others stay.
void forget_loads(Loads& loads, ParticleId p) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  if (p.value < loads.F.size()) loads.F[p] = loads.M[p] = {unknown, unknown, unknown};
}

/// The bodies that are due and for which there is room.
void let_in(const Model& model, const Stage& stage, const Inflow& inflow, State& s, Passage& done) {
  const Source& source = model.sources[inflow.source];
  std::size_t next = bodies_in(source, s);
  const std::size_t last = next + bodies_due(model, inflow.source, s);
  if (next == last) return;
  double size = 0.0, largest = 0.0;
  const Vec3d centre = centre_of_mass(model, s, source, next);
  for (std::size_t k = 0; k < source.body.size(); ++k) {
    const ParticleId p = source.particle(next, k);
    size = std::max(size, norm(between(centre, s.r[p])) + model.radius[p]);
    largest = std::max(largest, model.radius[p]);
  }
  BoundingBox box = source.region->box;
  const Vec3d wide{size, size, size};
  box.low -= wide, box.high += wide;
  FreeRoom room(model, stage, s, box, largest);
  for (bool fits = true; next < last && fits; ++next) {
    fits = false;
    for (std::int64_t attempt = 0; attempt < source.tries && !fits; ++attempt) {
      const auto place = place_of_try(model, s, source, next, s.clock.step, attempt);
      if (!place) break;
      const std::vector<FreeRoom::Ball> balls = balls_of(model, source, next, *place);
      if (!room.has_room_for(balls)) continue;
      room.take(balls);
      come_in(model, source, next, *place, s, done);
      for (std::size_t k = 0; k < source.body.size(); ++k) {
        const ParticleId p = source.particle(next, k);
        for (Loads* loads : {&s.loads, &s.damping, &s.local_damping}) forget_loads(*loads, p);
        s.waiting.erase(std::lower_bound(s.waiting.begin(), s.waiting.end(), p));
      }
      fits = true;
    }
  }
}

}  // namespace

std::int64_t steps_between(const Visits& visits, double dt) {
  return visits.every > 0.0 ? steps_in(visits.every, dt) : Visits::default_steps;
}

std::int64_t next_visit(const Sink& sink, double dt, std::int64_t stage_step) {
  return next_visit(sink.visits, last_step_at(sink.visits.until, dt), dt, stage_step);
}

std::int64_t next_visit(const Inflow& inflow, double dt, std::int64_t stage_step) {
  const std::int64_t n = steps_between(inflow.visits, dt), last = last_step_at(inflow.visits.until, dt);
  return next_visit(inflow.visits, last > no_visit - n ? last : (last + n - 1) / n * n, dt, stage_step);
}

std::int64_t next_visit(const Stage& stage, std::int64_t stage_step) {
  std::int64_t next = no_visit;
  for (const Sink& o : stage.sinks) next = std::min(next, next_visit(o, stage.dt, stage_step));
  for (const Inflow& i : stage.inflows) next = std::min(next, next_visit(i, stage.dt, stage_step));
  return next;
}

std::optional<Bond> bond_of_body(const Model& model, const State& s, const Source& source, std::size_t body,
                                 const SourceBond& b) {
  BondSite i = bond_site(model, s, source.particle(body, b.i)),
           j = bond_site(model, s, source.particle(body, b.j));
  i.offset = b.offset_i, i.radius = b.R_i;
  j.offset = b.offset_j, j.radius = b.R_j;
  return make_bond(source.recipes[b.recipe], i, j);
}

std::size_t bodies_in(const Source& source, const State& s) {
  std::size_t first = 0, last = source.bodies;  // they come in in order
  while (first < last) {
    const std::size_t middle = (first + last) / 2;
    if (is_waiting(s, source.particle(middle, 0)))
      last = middle;
    else
      first = middle + 1;
  }
  return first;
}

std::size_t bodies_due(const Model& model, std::size_t source, const State& s) {
  if (source >= s.sources.size()) return 0;
  const double due =
      std::floor(s.sources[source].due + 1e-9);  // sums of a rate end just below a whole number
  const std::size_t in = bodies_in(model.sources[source], s);
  const auto all = std::min(static_cast<std::size_t>(std::max(0.0, due)), model.sources[source].bodies);
  return all > in ? all - in : 0;
}

std::optional<Placing> place_of_try(const Model& model, const State& s, const Source& source,
                                    std::size_t body, std::int64_t step, std::int64_t attempt) {
  constexpr int draws = 1000;
  CounterRandom random{source.seed, body, static_cast<std::uint64_t>(step),
                       static_cast<std::uint64_t>(attempt)};
  const Vec3d centre = centre_of_mass(model, s, source, body);
  const BoundingBox& box = source.region->box;
  Placing at;
  at.r.resize(source.body.size());
  for (int draw = 0; draw < draws; ++draw) {
    if (source.turned) at.turn = random.rotation();
    BoundingBox around;  // the body about its centre
    for (std::size_t k = 0; k < at.r.size(); ++k) {
      const ParticleId p = source.particle(body, k);
      const Vec3d arm = between(centre, s.r[p]);
      at.r[k] = source.turned ? rotate(at.turn, arm) : arm;
      if (source.whole) around.add(at.r[k], model.radius[p]);
    }
    if (!source.whole) around.add({});
    const Vec3d low = box.low - around.low, high = box.high - around.high;
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    if (!(low.x <= high.x && low.y <= high.y && low.z <= high.z)) continue;
    const auto along = [](double from, double to, double part) {
      return std::min(to, from + (to - from) * part);
    };
    at.centre = {along(low.x, high.x, x), along(low.y, high.y, y), along(low.z, high.z, z)};
    bool holds = source.whole || source.region->holds(at.centre, 0.0);
    if (source.whole)
      for (std::size_t k = 0; k < at.r.size() && holds; ++k)
        holds = source.region->holds(at.centre + at.r[k], model.radius[source.particle(body, k)]);
    if (!holds) continue;
    for (Vec3d& r : at.r) r += at.centre;
    at.velocity = source.velocity;
    at.angular_velocity = source.angular_velocity;
    if (source.velocity_spread > 0.0) at.velocity += source.velocity_spread * random.gaussian_vector();
    if (source.angular_velocity_spread > 0.0)
      at.angular_velocity += source.angular_velocity_spread * random.gaussian_vector();
    return at;
  }
  return std::nullopt;
}

Passage visit(const Model& model, const Stage& stage, State& s) {
  Passage done;
  take_out(model, stage, s, done);
  for (const Inflow& inflow : stage.inflows) {
    if (!is_visited(inflow, stage, s)) continue;
    count_due(model, inflow, stage.dt, s.clock.stage_step - steps_between(inflow.visits, stage.dt),
              s.clock.stage_step, s);
    let_in(model, stage, inflow, s, done);
  }
  done.changed = done.any_come || done.any_gone;
  return done;
}

void count_due_at_end(const Model& model, const Stage& stage, State& s) {
  for (const Inflow& inflow : stage.inflows) {
    const std::int64_t n = steps_between(inflow.visits, stage.dt), end = s.clock.stage_step;
    if (inflow.rate > 0.0 && end > 0) count_due(model, inflow, stage.dt, (end - 1) / n * n, end, s);
  }
}

State with_bonds_to_come(const Model& model, const State& state) {
  State s = state;
  for (const Source& source : model.sources) {
    const std::size_t next = bodies_in(source, state);
    if (next == source.bodies) continue;
    for (const SourceBond& b : source.bonds)
      if (const auto bond = bond_of_body(model, state, source, next, b))
        add_bond(model, *bond, source.recipes[b.recipe], s);
  }
  s.books = state.books;
  return s;
}

}  // namespace vbond
