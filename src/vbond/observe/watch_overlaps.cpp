// What the watch says of particles that overlap, pass through each other or are too fast.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/fibre_rings.hpp"
#include "vbond/model/present.hpp"
#include "vbond/model/turn_bound.hpp"
#include "vbond/observe/watch.hpp"

namespace vbond {
namespace {

struct Overlap {
  ParticleId i, j;
  Image of_j;
  double depth = 0;
};

/// Pairs that overlap by more than this part of the smaller radius beyond what they did at r_0, and are not
/// bonded, of those of this process. Few, so that bonds are asked last.
std::vector<Overlap> own_overlaps(const Model& m, const BodyPart& body, double part) {
  const State& s = body.state;
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
  for_overlapping_present(m, body, 0.0, look);
  if (found.empty()) return found;
  std::set<std::tuple<ParticleId, ParticleId, Image>> bonded;  // seen from either end
  body.for_bonded([&](ParticleId i, ParticleId j, const Image& n, bool cracked) {
    if (!cracked) bonded.insert({i, j, n}), bonded.insert({j, i, -n});
  });
  const std::vector<char> of_fibre = particles_of_fibres(m.particles(), s.bonds);  // looked at as capsules
  found.erase(
      std::remove_if(found.begin(), found.end(),
                     [&](const Overlap& o) {
                       if (!of_fibre.empty() && (of_fibre[o.i.value] || of_fibre[o.j.value])) return true;
                       return bonded.count({o.i, o.j, o.of_j}) > 0 || are_one_body(s, o.i, o.j, o.of_j);
                     }),
      found.end());
  return found;
}

/// The same of all processes, in the order of particles.
std::vector<Overlap> new_overlaps(const Model& m, const BodyPart& body, double part) {
  std::vector<Overlap> found = body.all.gather(own_overlaps(m, body, part));
  std::sort(found.begin(), found.end(), [](const Overlap& a, const Overlap& b) {
    return std::tuple(a.i, a.j, a.of_j) < std::tuple(b.i, b.j, b.of_j);
  });
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

void Watch::look_at_overlaps(const BodyView& body, double part) {
  const Model& model = body.model();
  look_at_overlaps(model, body.part(Show::places, reach_of_overlaps(model)), part, when(body));
}

void Watch::look_at_overlaps(const Model& model, const BodyPart& body, double part, const std::string& when) {
  for (const Overlap& o : new_overlaps(model, body, part)) report_overlap(model, o.i, o.j, o.depth, when);
  const auto ring = ring_of_contact(model, body.state);  // all processes know all capsules
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
                 fmt::format("if something turns it so fast, use time.step = {:.3g} or less, or turn it more "
                             "slowly; if nothing does, the motion is unstable: use a tenth of the step",
                             would_do)),
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

}  // namespace vbond
