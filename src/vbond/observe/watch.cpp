#include "vbond/observe/watch.hpp"
#include "vbond/model/present.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/fibre_rings.hpp"
#include "vbond/model/turn_bound.hpp"
#include "vbond/observe/bond_look.hpp"

namespace vbond {
namespace {

std::string name_of(BondId k, const Bond& b) {
  return fmt::format("bond {} (particles {}, {})", k.value, b.i.value, b.j.value);
}

bool is_finite(const Energies& e) {
  return std::isfinite(e.total());
}

bool is_finite(const State& s, ParticleId p) {
  const Quatd& q = s.q[p];
  return is_finite(s.r[p]) && is_finite(s.v[p]) && is_finite(s.omega[p]) &&
         std::isfinite(q.w + q.x + q.y + q.z);
}

double energy_of(BondId k, const State& s) {
  const BondEnergy<double> U = bond_energy(s, k);
  return U.U_L + U.U_B + U.U_T;
}

constexpr const char* smaller_step =
    "use a smaller time.step (or time.fraction); history and frames are sound as long as the balance error "
    "was small";

/// Angle between two vectors, sound at every angle.  [degrees]
double angle(const Vec3d& a, const Vec3d& b) {
  return 180.0 / std::numbers::pi * std::atan2(norm(cross(a, b)), dot(a, b));
}

/// The angles that a bond is judged by, for a report.
std::string angles_of(BondId k, const State& s) {
  const BondPose<double> pose = elastic_pose(s, k);
  const Vec3d& D = pose.r_ij;
  return fmt::format("its ends are tilted by {:.1f} and {:.1f} degrees and twisted by {:.1f}",
                     angle(D, pose.n_i[0]), angle(-D, pose.n_j[0]),
                     180.0 / std::numbers::pi * bond_shape(pose, 0.0, 0.0).twist);
}

/// Names the first thing that is not finite.
[[noreturn]] void blame_not_finite(const State& s) {
  const auto unsound = [&s](const std::string& subject, const std::string& finding) {
    return Diverged(s.clock.step, s.clock.time(), subject, finding, smaller_step);
  };
  for (const ParticleId p : s.r.ids())
    if (!is_finite(s, p))
      throw unsound(fmt::format("particle {}", p.value),
                    fmt::format("position ({}, {}, {}), velocity ({}, {}, {}): not finite", s.r[p].x,
                                s.r[p].y, s.r[p].z, s.v[p].x, s.v[p].y, s.v[p].z));
  for (const BondId k : s.bonds.ids())
    if (const double U = energy_of(k, s); !std::isfinite(U))
      throw unsound(name_of(k, s.bonds[k]), fmt::format("energy {}", U));
  throw unsound("all particles", "the energy is not finite although each particle and bond is: it overflows");
}

/// The bond with the largest energy, which is where an instability usually starts.
std::string most_loaded(const State& s) {
  std::string name = "all particles";
  double most = 0.0;
  for (const BondId k : s.bonds.ids()) {
    const double U = energy_of(k, s);
    if (U > most) most = U, name = "most loaded is " + name_of(k, s.bonds[k]);
  }
  return name;
}

/// How a report of a balance begins.
std::string load_factor_of(const BalancePoint& balance) {
  return fmt::format("load factor {:.6g}", balance.load_factor);
}

struct Overlap {
  ParticleId i, j;
  Image of_j;
  double depth;
};

/// Pairs that overlap by more than this part of the smaller radius beyond what they did at r_0, and are not
/// bonded. Few, so that bonds are asked last.
std::vector<Overlap> new_overlaps(const Model& m, const State& s, double part) {
  std::vector<Overlap> found;
  if (m.particles() < 2 && s.cell.empty()) return found;
  const CellEdges at_start = cell_at_start(m);
  const auto look = [&](std::size_t a, std::size_t b, const Image& n, double distance2) {
    const ParticleId i{a}, j{b};
    const double R_i = m.radius[i], R_j = m.radius[j], allowed = part * std::min(R_i, R_j);
    const double depth = R_i + R_j - std::sqrt(distance2);
    if (!(depth > allowed) || std::min(R_i, R_j) == 0.0) return;
    const double at_first =
        stood_together(m, i, j) ? std::max(0.0, R_i + R_j - norm(between(m.r_0, at_start, i, j, n))) : 0.0;
    if (depth > at_first + allowed) found.push_back({i, j, n, depth});
  };
  for_overlapping_present(m, s, 0.0, look);
  if (found.empty()) return found;
  std::set<std::tuple<ParticleId, ParticleId, Image>> bonded;  // seen from either end
  for (const Bond& b : s.bonds)
    if (!has_failed(b)) bonded.insert({b.i, b.j, b.image_j}), bonded.insert({b.j, b.i, -b.image_j});
  const std::vector<char> of_fibre = particles_of_fibres(m.particles(), s.bonds);  // looked at as capsules
  found.erase(std::remove_if(found.begin(), found.end(),
                             [&](const Overlap& o) {
                               if (!of_fibre.empty() && (of_fibre[o.i.value] || of_fibre[o.j.value]))
                                 return true;
                               return bonded.count({o.i, o.j, o.of_j}) > 0;
                             }),
              found.end());
  return found;
}

/// Line of centres where a stay within a distance of one another begins and ends, as far as this step knows.
struct EndsOfStay {
  Vec3d first, last;
};

EndsOfStay ends_of_stay(const Encounter& e, double distance) {
  const Vec3d nearest = nearest_point(e), way = e.to - e.from;
  const double half = std::sqrt(std::max(0.0, sq(distance) - norm2(nearest)));  // of the way inside
  const auto edge = [&](const Vec3d& end, double sign) {
    return norm(end) < distance ? end : nearest + (sign * half / norm(way)) * way;
  };
  return {edge(e.from, -1.0), edge(e.to, 1.0)};
}

/// Of a pair that have passed through one another: a single one before one of a body, the lighter one before
/// the heavier one, then the later one.
LostParticle rather_to_go(const Model& m, const State& s, ParticleId i, ParticleId j) {
  const auto holds = [&](ParticleId p) {
    const auto is_its = [p](const Bond& b) { return !b.broken && (b.i == p || b.j == p); };
    return std::pair(std::count_if(s.bonds.begin(), s.bonds.end(), is_its), m.mass[p]);
  };
  return holds(j) <= holds(i) ? LostParticle{j, i} : LostParticle{i, j};
}

/// What contacts can do about a pair depends on its energy: no step helps where that is too large.
Diverged passed(const Model& m, const Encounter& e, double nearest, const State& s) {
  const double R_i = m.radius[e.i], R_j = m.radius[e.j], reach = R_i + R_j;
  const Vec3d of_image = s.cell.empty() ? Vec3d{} : image_velocity(s.cell, e.of_j);
  const double speed_now = norm(s.v[e.j] + of_image - s.v[e.i]);
  const double speed = std::max(speed_now, norm(e.to - e.from) / s.clock.dt);
  const double reduced_mass = m.mass[e.i] * m.mass[e.j] / (m.mass[e.i] + m.mass[e.j]);
  const double motion = 0.5 * reduced_mass * sq(speed_now) + contact_pair_energy(m, s, e.i, e.j, e.of_j);
  const double most =
      normal_energy(touch_forms(m.contact), touch_numbers(m, e.i, e.j), reduced_radius(R_i, R_j), reach);
  const double step = 0.5 * longest_approach * reach / speed;
  std::string way_out = "the step is small enough: use a stiffer contact, or lower velocities and loads";
  if (motion > most)
    way_out = fmt::format(
        "this contact stores {:.3g} at most, and their motion holds {:.3g}: use a stiffer "
        "contact or lower velocities",
        most, motion);
  else if (step < s.clock.dt)
    way_out = fmt::format("use time.step = {:.3g} or less, or a stiffer contact", step);
  return {
      s.clock.step, s.clock.time(), fmt::format("particles {} and {}", e.i.value, e.j.value),
      fmt::format("they have passed through one another: their centres came within {:.3g}, their radii are "
                  "{:.3g} and {:.3g}, their relative speed is {:.4g}",
                  nearest, R_i, R_j, speed),
      way_out + "; watch.overlap = 0 lets particles pass"};
}

}  // namespace

Watch::Watch(double energy_error, Tell tell, WatchRecord record)
    : energy_error_(energy_error), tell_(std::move(tell)), record_(std::move(record)) {}

void Watch::look(const Survey& survey, double balance_error, const CollectState& collect,
                 const std::function<std::string()>& suspect) {
  look(survey, balance_error, collect, time_of, suspect);
}

std::string Watch::in_wall(const Model& model, const std::vector<DeepInWall>& deep) {
  const auto part = [&](const DeepInWall& d) { return d.overlap / model.radius[d.p]; };
  const auto worst = std::max_element(
      deep.begin(), deep.end(), [&](const DeepInWall& x, const DeepInWall& y) { return part(x) < part(y); });
  if (worst == deep.end()) return {};
  return fmt::format(
      "particle {} is on its way through wall \"{}\", which it overlaps by {:.3g} of its radius",
      worst->p.value, model.walls[worst->wall].name, part(*worst));
}

std::string Watch::time_of(const Clock& clock) {
  return fmt::format("t = {:.6g}", clock.time());
}

void Watch::look(const Survey& survey, double balance_error, const CollectState& collect,
                 const std::function<std::string(const Clock&)>& when,
                 const std::function<std::string()>& suspect) {
  const bool finite = is_finite(survey.energies), balanced = std::abs(balance_error) <= energy_error_;
  if (finite && balanced && survey.deformed.empty()) return;
  const State& state = collect();
  if (!finite) blame_not_finite(state);
  if (!balanced) {
    const std::string cause = suspect ? suspect() : "";
    throw Diverged(state.clock.step, state.clock.time(), cause.empty() ? most_loaded(state) : cause,
                   fmt::format("the energy balance is off by {:.3g} of the energy in the run, more than "
                               "watch.energy_error = {:g}",
                               balance_error, energy_error_),
                   cause.empty()
                       ? smaller_step + std::string("; raise watch.energy_error only if the jump is expected")
                       : "use a stiffer contact, lower velocities and loads, or a smaller time.step");
  }
  for (const BondId k : survey.deformed) look_at_bond(k, state, when(state.clock));
}

void Watch::look(const BodyView& body, const std::function<std::string()>& suspect) {
  const BalancePoint* const at_rest = body.balance();
  look(
      body.survey(), body.balance_error(), [&body]() -> const State& { return body.state(); },
      [at_rest](const Clock& clock) { return at_rest ? load_factor_of(*at_rest) : time_of(clock); }, suspect);
  look_at_handover(body);
}

/// Faces of flat joints that part leave spheres that may overlap far more than the faces were pressed. Told
/// once.
void Watch::look_at_handover(const BodyView& body) {
  constexpr double much = 0.05;  // of the energy in the body
  const double gained = -body.books().released;
  if (told_handover_ || !(gained > 0.0)) return;
  const double energy = body.energies().total();
  if (!(gained > much * energy)) return;
  const PerBond<Bond>& bonds = body.state().bonds;
  const auto parted = [](const Bond& b) { return b.broken && b.law->crack != nullptr; };
  if (std::none_of(bonds.begin(), bonds.end(), parted)) return;
  told_handover_ = true;
  if (tell_)
    tell_(fmt::format(
        "{}: breaking has brought in {:.4g} of energy, where there is {:.4g}: faces of flat joints have "
        "parted, and their spheres, which overlap, now push each other apart",
        time_of(body.clock()), gained, energy));
}

void Watch::look_at_overlaps(const BodyView& body, double part) {
  const BalancePoint* const at_rest = body.balance();
  look_at_overlaps(body.model(), body.state(), part,
                   at_rest ? load_factor_of(*at_rest) : time_of(body.clock()));
}

void Watch::look_at_overlaps(const Model& model, const State& state, double part, const std::string& when) {
  for (const Overlap& o : new_overlaps(model, state, part)) report_overlap(model, o.i, o.j, o.depth, when);
  const auto ring = ring_of_contact(model, state);
  if (!ring || !record_.overlapping.insert(std::minmax(ring->i, ring->j)).second) return;
  auto count = static_cast<std::int64_t>(record_.overlapping.size()) - 1;
  report(count, untold_overlapping_,
         fmt::format("{}: {} and {} touch all along a closed way, as fibres do that have no ends: such a "
                     "contact is not felt, see docs/contacts.md",
                     when, ring->first, ring->second));
}

void Watch::look_at_capsules(const std::vector<DeepCapsules>& deep, const Clock& clock) {
  for (const DeepCapsules& d : deep) {
    if (!record_.overlapping.insert(std::minmax(d.i, d.j)).second) continue;
    auto count = static_cast<std::int64_t>(record_.overlapping.size()) - 1;
    report(count, untold_overlapping_,
           fmt::format(
               "{}: {} and {} overlap as capsules by {:.4g}, {:.3g} of the smaller radius: they may slip "
               "through one another",
               time_of(clock), d.first, d.second, d.overlap, d.overlap / d.radius));
  }
}

void Watch::report_overlap(const Model& model, ParticleId i, ParticleId j, double depth,
                           const std::string& when) {
  if (!record_.overlapping.insert({i, j}).second) return;
  auto count = static_cast<std::int64_t>(record_.overlapping.size()) - 1;
  report(count, untold_overlapping_,
         fmt::format("{}: particles {} and {} are not bonded and overlap by {:.4g}, {:.3g} of the smaller "
                     "radius: they may slip through one another",
                     when, i.value, j.value, depth, depth / std::min(model.radius[i], model.radius[j])));
}

void Watch::look_at_encounters(const Model& model, const std::vector<Encounter>& encounters,
                               const Clock& clock, double part, const CollectState& collect) {
  std::map<std::pair<ParticleId, ParticleId>, DeepPair> still_deep;
  std::optional<Diverged> first;
  std::vector<LostParticle> lost;
  for (const Encounter& e : encounters) {
    const double reach = model.radius[e.i] + model.radius[e.j];
    const EndsOfStay stay = ends_of_stay(e, deep_part * reach);
    const auto before = record_.deep.find({e.i, e.j});
    const bool goes_on = before != record_.deep.end() && before->second.last_step + 1 >= clock.step;
    const double distance = norm(nearest_point(e));
    const DeepPair pair{e.i, e.j, goes_on ? before->second.entered : stay.first,
                        goes_on ? std::min(before->second.nearest, distance) : distance, clock.step};
    if (dot(pair.entered, stay.last) < 0.0) {
      const State& state = collect();
      if (!first) first = passed(model, e, pair.nearest, state);
      lost.push_back(rather_to_go(model, state, e.i, e.j));
      continue;
    }
    if (norm(e.to) < deep_part * reach) still_deep[{e.i, e.j}] = pair;
    if (reach - distance > part * std::min(model.radius[e.i], model.radius[e.j]))
      report_overlap(model, e.i, e.j, reach - distance, time_of(clock));
  }
  if (!encounters.empty()) record_.deep = std::move(still_deep);
  if (first) throw ParticlesLost(*first, std::move(lost));
}

void Watch::look_at_speed(const FastParticle& fastest, const Clock& clock) {
  const double ratio = fastest.way / fastest.limit;
  if (!(ratio >= 2.0 * record_.fastest)) return;
  record_.fastest = ratio;
  if (tell_)
    tell_(fmt::format(
        "{}: step {}: particle {} moves by {:.3g} in a step, at a speed of {:.4g} against the mean "
        "of all: from {:.3g} on, an eighth of the least sum of two radii, particles may pass "
        "through one another before contacts push them apart; time.step = {:.3g} would do",
        time_of(clock), clock.step, fastest.p.value, fastest.way, fastest.way / clock.dt, fastest.limit,
        0.9 * clock.dt / ratio));
}

void Watch::look_at_turns(const FastTurn& fastest, const Clock& clock, bool insist) {
  const std::string particle = fmt::format("particle {}", fastest.p.value);
  const double would_do = 0.9 * clock.dt * longest_turn / fastest.angle;
  if (fastest.angle > std::numbers::pi && !insist)
    throw ParticlesLost(
        Diverged(clock.step, clock.time(), particle,
                 fmt::format("it turns by {:.3g} rad in a step, more than half a turn: its bonds see no "
                             "more which way",
                             fastest.angle),
                 fmt::format("use time.step = {:.3g} or less, or turn it more slowly", would_do)),
        {{fastest.p, {}, fmt::format("it turns by {:.3g} rad in a step", fastest.angle)}});
  if (!(fastest.angle >= 2.0 * record_.farthest_turn)) return;
  record_.farthest_turn = fastest.angle;
  if (tell_)
    tell_(
        fmt::format("{}: step {}: {} turns by {:.3g} rad in a step: from {} rad on the moments that turn "
                    "with it are off by 2 % and more; time.step = {:.3g} would do",
                    time_of(clock), clock.step, particle, fastest.angle, longest_turn, would_do));
}

void Watch::look_at_walls(const Model& model, const std::vector<DeepInWall>& deep, const Clock& clock) {
  for (const DeepInWall& d : deep) {
    if (!record_.in_walls.insert({d.p, d.wall}).second) continue;
    auto count = static_cast<std::int64_t>(record_.in_walls.size()) - 1;
    report(count, untold_in_walls_,
           fmt::format("{}: particle {} overlaps wall \"{}\" by {:.4g}, {:.3g} of its radius: it may come "
                       "through",
                       time_of(clock), d.p.value, model.walls[d.wall].name, d.overlap,
                       d.overlap / model.radius[d.p]));
  }
}

void Watch::look_at_servos(const Simulation& run) {
  constexpr double enough = 0.9;  // of the force: a wall that swings about it is there
  for (const WallDrive& d : run.stage().walls) {
    if (!d.servo || !tell_) continue;
    const WallState& wall = run.walls()[d.index];
    const double wanted = d.servo->factor(static_cast<double>(run.clock().stage_step) * run.clock().dt) *
                          d.servo->force,
                 is = 0.0 - dot(wall.force, d.servo->direction);
    if (!(is < enough * wanted)) continue;
    tell_(fmt::format(
        "{}: wall \"{}\" ends stage \"{}\" without its force: its servo presses with {:.4g}, not "
        "{:.4g}{}; since the start of the run it has gone {:.4g} along its direction",
        time_of(run.clock()), d.wall, run.stage().name, is, wanted,
        wall.force == Vec3d{} ? ", as it touches nothing" : "", dot(wall.displacement, d.servo->direction)));
  }
}

void Watch::look_at_bond(BondId k, const State& state, const std::string& when) {
  constexpr double closed_up = 1e-6;  // of a: d = D / |D| has lost its meaning
  const Bond& b = state.bonds[k];
  const BondShape shape = bond_shape(state, k);
  if (!(shape.length >= closed_up * b.a))
    throw Diverged(state.clock.step, state.clock.time(), name_of(k, b),
                   fmt::format("its bonded points are {:.3g} apart, it has closed up (length at rest {:.6g})",
                               shape.length, b.a),
                   "use smaller loads or velocities, a stiffer bond or a contact law; a smaller time.step "
                   "if the energy balance was already off");
  if (shape.length > 2.0 * b.a && record_.stretched.insert(k).second) {
    auto count = static_cast<std::int64_t>(record_.stretched.size()) - 1;
    report(count, untold_stretched_,
           fmt::format("{}: {} is longer than twice its length at rest: {:.4g} of {:.4g}", when,
                       name_of(k, b), shape.length, b.a));
  }
  const bool is_short = shape.length < 0.5 * b.a;
  const BondRange range = bond_range(b, shape);
  if (!is_short && range == BondRange::good) return;
  if (record_.bonds.size() <= k.value) record_.bonds.resize(k.value + std::size_t{1});
  BondRecord& seen = record_.bonds[k];
  if (is_short && !std::exchange(seen.was_short, true))
    report(record_.shortened, untold_shortened_,
           fmt::format("{}: {} is shorter than half its length at rest: {:.4g} of {:.4g}", when,
                       name_of(k, b), shape.length, b.a));
  if (range <= seen.worst) return;
  seen.worst = range;
  const bool snapped = range == BondRange::snapped;
  report(snapped ? record_.snapped : record_.strained, snapped ? untold_snapped_ : untold_strained_,
         fmt::format("{}: {} {}: {}", when, name_of(k, b),
                     snapped ? "has snapped, past 90 degrees"
                             : fmt::format("is strained, past {} degrees", b.law->strained_past),
                     angles_of(k, state)));
}

void Watch::report(std::int64_t& count, std::int64_t& untold, const std::string& text) {
  if (++count > told_in_full)
    ++untold;
  else if (tell_)
    tell_(text);
}

void Watch::summarise() {
  const auto sum_up = [this](std::int64_t& untold, std::int64_t count, const char* what) {
    if (untold > 0 && tell_) tell_(fmt::format("{} more {}: {} in all so far", untold, what, count));
    untold = 0;
  };
  sum_up(untold_strained_, record_.strained, "bonds were strained");
  sum_up(untold_snapped_, record_.snapped, "bonds have snapped");
  sum_up(untold_shortened_, record_.shortened, "bonds were shorter than half their length at rest");
  sum_up(untold_stretched_, static_cast<std::int64_t>(record_.stretched.size()),
         "bonds were longer than twice their length at rest");
  sum_up(untold_overlapping_, static_cast<std::int64_t>(record_.overlapping.size()),
         "pairs of particles that are not bonded overlapped");
  sum_up(untold_in_walls_, static_cast<std::int64_t>(record_.in_walls.size()), "particles overlapped walls");
}

}  // namespace vbond
