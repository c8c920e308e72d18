#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/model/agreement.hpp"
#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/model/held_tops.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/torn.hpp"
#include "vbond/terms/detail/term_mistakes.hpp"

namespace vbond {
namespace {

template <class Named>
std::string who(const std::string& what, const Named& of) {
  return of.group.empty() ? what : fmt::format("{} on \"{}\"", what, of.group);
}

void look_at_distance(const std::optional<DistanceStop>& stop, Mistakes& found) {
  if (!stop) return;
  found.require_known({stop->i, stop->j}, "the stop at a distance");
  found.require(stop->i != stop->j, "the stop at a distance is between a particle and itself");
  found.require(std::isfinite(stop->value),
                fmt::format("the stop at a distance has the value {}", stop->value));
}

/// What a grip does not hold is free of prescribed motion.
void look_at_free_grip(const Support& s, const std::string& who, Mistakes& found) {
  const Vec3d &way = s.velocity, &turn = s.angular_velocity;
  bool moves_free = false;
  for (std::size_t k = 0; k < 3; ++k) moves_free |= !s.held[k] && component(way, static_cast<int>(k)) != 0.0;
  const bool holds_turns = s.held[3] && s.held[4] && s.held[5];
  found.require(!moves_free && (holds_turns || turn == Vec3d{}),
                who + " is rigid and moves along or about what it leaves free");
  found.require(!s.pivot || (s.held[0] && s.held[1] && s.held[2] && way == Vec3d{}),
                who + " is rigid, free in part, and has a pivot: that must stand still");
  found.require(s.held[3] + s.held[4] + s.held[5] != 1,
                who + " is rigid and holds one turn: it may hold none, two or all three");
}

/// Only grips have a pivot; supports that overlap must agree.
void look_at_supports(const Model& model, const std::vector<Support>& supports, Mistakes& found) {
  for (const Support& s : supports) {
    const std::string who = s.group.empty() ? "a support" : "a support on \"" + s.group + "\"";
    found.require_known(s.particles, "a support", s.group);
    found.require_finite(s.velocity, who, "the velocity");
    found.require_finite(s.angular_velocity, who, "the angular velocity");
    if (is_free_grip(s)) look_at_free_grip(s, who, found);
    found.require(!s.rigid || !s.particles.empty(), who + " is rigid and has no particles");
    found.require(s.rigid || !s.pivot, who + " has a pivot: that is for rigid ones");
    if (s.pivot) found.require_finite(*s.pivot, who, "the pivot");
    if (!s.axes) continue;
    found.require(!s.rigid, who + " is rigid and has axes: those are for what is not rigid");
    for (const Triad& axes : {s.axes->along, s.axes->about})
      found.require(are_right_handed(axes),
                    who + " has axes that are not perpendicular unit vectors, right-handed");
  }
  for (const Disagreement& d : disagreements(supports, model.particles()))
    found.require(
        false,
        fmt::format("{} of particle {} is held twice, {}, by the supports on \"{}\" and \"{}\"", d.dof,
                    d.particle.value,
                    d.oblique ? "along axes that are neither parallel nor perpendicular" : "in two ways",
                    supports[d.first].group, supports[d.second].group));
}

void look_at_load(const PointLoad& l, Mistakes& found) {
  found.require_known(l.particles, "a load", l.group);
  found.require_finite(l.force, who("a load", l), "the force");
  found.require_finite(l.moment, who("a load", l), "the moment");
  found.require_finite(l.force_by_mass, who("a load", l), "the force by mass");
  found.require_finite(l.moment_by_mass, who("a load", l), "the moment by mass");
}

void look_at_visits(const Visits& v, const std::string& who, Mistakes& found) {
  found.require(at_least_zero(v.from) && v.until >= v.from && at_least_zero(v.every),
                fmt::format("{} is visited from {} until {} every {}: 0 <= from <= until, every >= 0", who,
                            v.from, v.until, v.every));
}

void look_at_passage(const Model& model, const Stage& stage, Mistakes& found) {
  for (const Inflow& i : stage.inflows) {
    if (i.source >= model.sources.size()) {
      found.require(false, fmt::format("the stage lets in source {} of {}", i.source, model.sources.size()));
      continue;
    }
    const std::string who = "source \"" + model.sources[i.source].name + "\"";
    found.require(at_least_zero(i.rate), fmt::format("the rate of {} is {}: it must be >= 0", who, i.rate));
    look_at_visits(i.visits, who, found);
  }
  for (const Sink& o : stage.sinks) {
    const std::string who = "sink \"" + o.name + "\"";
    found.require(o.region != nullptr && o.region->holds, who + " has no region");
    found.require(o.particles.empty() || o.particles.size() == model.particles(),
                  fmt::format("{} has {} entries in particles for {} particles", who, o.particles.size(),
                              model.particles()));
    look_at_visits(o.visits, who, found);
  }
  found.require((stage.inflows.empty() && stage.sinks.empty()) || !stage.cell.any(),
                "particles come in or go while the cell moves: let it stand still in this stage");
}

void look_at_stops(const Stops& stops, std::size_t walls, Mistakes& found) {
  found.require(stops.duration > 0.0, fmt::format("the duration is {}: it must be > 0", stops.duration));
  look_at_distance(stops.distance, found);
  if (stops.peak) {
    const PeakStop& peak = *stops.peak;
    found.require_known(peak.particles, "the stop at a peak");
    found.require_increasing(peak.particles, "the stop at a peak");
    found.require(peak.drop > 0.0 && peak.drop < 1.0,
                  fmt::format("the stop at a peak has drop = {}: 0 < drop < 1", peak.drop));
    found.require(at_least_zero(peak.above),
                  fmt::format("the stop at a peak counts those above {}: it must be >= 0", peak.above));
    found.require(above_zero(peak.average_over),
                  fmt::format("the stop at a peak averages over {}: it must be > 0", peak.average_over));
    found.require(
        peak.quantity == PeakQuantity::compressive_force || is_unit(peak.direction),
        "the direction of the stop at a peak is " + text(peak.direction) + ": it must be a unit vector");
    found.require(peak.quantity != PeakQuantity::wall_force || peak.wall < walls,
                  fmt::format("the stop at a peak watches wall {} of {}", peak.wall, walls));
  }
  if (stops.breaks)
    found.require(stops.breaks->count > 0,
                  fmt::format("the stop at breaks counts to {}: it must be > 0", stops.breaks->count));
  if (stops.rest) {
    found.require(
        above_zero(stops.rest->kinetic_energy_below),
        fmt::format("the stop at rest is below {}: it must be > 0", stops.rest->kinetic_energy_below));
    found.require(above_zero(stops.rest->during),
                  fmt::format("the stop at rest is during {}: it must be > 0", stops.rest->during));
  }
}

/// What a cell does not know yet, or what would stand still while it moves.
void look_at_cell(const Model& model, const Stage& stage, Mistakes& found) {
  found.add(mistakes_in_drive(model, stage.cell, false));
  if (!model.cell.any()) return;
  found.require(stage.on_unphysical == OnUnphysical::stop, "a periodic body drops no particles");
  if (!stage.cell.any()) return;
  found.require(stage.supports.empty(), "supports would stand still while the cell moves");
  found.require(stage.loads.empty() && stage.gravity == Vec3d{},
                "loads and gravity do not act on a body whose cell moves");
}

void look_at_waves(const Model& model, const StaticStage& stage, Mistakes& found) {
  const WaveVectors& waves = stage.waves;
  if (waves.q.empty()) return;
  found.require(model.cell.any(), "a body without a cell has no wave vectors");
  found.require(stage.kind == StageKind::modes || stage.kind == StageKind::buckling,
                "wave vectors are for modes and critical loads");
  found.require(stage.newton.solver != LinearSolver::multigrid, "wave vectors are not for multigrid");
  for (const Support& s : stage.supports)
    found.require(!is_free_grip(s), "a rigid group that is free in part has no waves");
  constexpr double most = 1e6;  // beyond it no phase is known
  for (const Vec3d& q : waves.q) {
    found.require_finite(q, "the stage", "a wave vector");
    if (!model.cell.any() || !is_finite(q)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& edge = model.cell.edges[k];
      const double along = waves.of_edges ? component(q, static_cast<int>(k)) : dot(q, edge);
      found.require(model.cell.periodic[k] || along == 0.0,
                    fmt::format("the wave vector {} goes along an open edge of the cell", text(q)));
      found.require(std::abs(along) <= most,
                    fmt::format("the wave vector {} is so large that its phase is rounding", text(q)));
    }
  }
}

/// The same at rest.
void look_at_cell(const Model& model, const StaticStage& stage, Mistakes& found) {
  found.add(mistakes_in_drive(model, stage.cell, true));
  look_at_waves(model, stage, found);
  if (!model.cell.any()) return;
  found.require(stage.kind != StageKind::modes || !stage.cell.any(),
                "the cell moves: modes are about a balance at rest, which an equilibrium stage may find");
  if (!stage.cell.any()) return;
  found.require(stage.kind != StageKind::buckling || !stage.cell.any_stress() || !stage.waves.q.empty(),
                "components of the cell give way to a stress, which has no potential: critical loads of what "
                "repeats with the cell are found for a cell that is strained, those of waves for any");
  found.require(
      stage.supports.empty(),
      "supports would stand still while the cell moves: leave them out, a periodic body needs none");
  found.require(stage.loads.empty() && stage.gravity == Vec3d{},
                "loads and gravity do not act on a body whose cell moves");
}

}  // namespace

std::vector<std::string> mistakes_in(const Model& model, const Stage& stage) {
  Mistakes found(model);
  found.require(above_zero(stage.dt),
                fmt::format("dt is {}: stage.dt must be above zero and finite", stage.dt));
  found.require_finite(stage.gravity, "the stage", "gravity");
  found.require(
      at_least_zero(stage.b_translation) && at_least_zero(stage.b_rotation),
      fmt::format("the damping is {} and {}: it must be >= 0", stage.b_translation, stage.b_rotation));
  found.require(stage.local_damping >= 0.0 && stage.local_damping < 1.0,
                fmt::format("the local damping is {}: it must be >= 0 and below 1", stage.local_damping));
  look_at_supports(model, stage.supports, found);
  for (const Support& s : stage.supports) {
    found.require_factor(s.factor, who("a support", s));
    if (!is_free_grip(s)) continue;
    const std::string grip = who("a grip", s);
    found.require(stage.local_damping == 0.0, grip + " is free in part: local damping does not know it");
    for (const ParticleId p : s.particles)
      if (p.value < model.particles() && model.is_top(p)) {
        found.require(
            false,
            grip + fmt::format(" is free in part, and particle {} has three moments of inertia", p.value));
        break;
      }
  }
  if (const auto top = partly_held_top(model, stage.supports))
    found.require(false, fmt::format("particle {} is held in part: {}", top->p.value, partly_held_top_rule));
  for (const PointLoad& l : stage.loads) {
    look_at_load(l, found);
    found.require_factor(l.factor, who("a load", l));
    found.require(!l.constant, who("a load", l) + " is constant: in motion a load has a factor over time");
  }
  look_at_terms(model, stage, found);
  for (const BondingRule& r : stage.bonding) {
    const std::string rule = "bonding rule \"" + r.name + "\"";
    found.require_sizes(rule, "a bonding rule must say of each particle if it is meant",
                        {{"in_a", r.in_a.size()}, {"in_b", r.in_b.size()}});
    found.require(above_zero(r.distance) || (r.distance == 0.0 && above_zero(r.factor)),
                  fmt::format("{} has distance = {}: it must be > 0", rule, r.distance));
    found.require(r.factor == 0.0 || above_zero(r.factor),
                  fmt::format("{} has factor = {}: it must be >= 0", rule, r.factor));
    found.require(r.share.part > 0.0 && r.share.part <= 1.0,
                  fmt::format("{} has share = {}: it must be > 0 and <= 1", rule, r.share.part));
    const std::size_t n = model.particles();
    if (r.in_a.size() == n && r.in_b.size() == n && (r.factor > 0.0 || r.recipe.needs_radii())) {
      bool all = true;
      for (const ParticleId p : model.radius.ids())
        all = all && (!(r.in_a[p.value] || r.in_b[p.value]) || model.radius[p] > 0.0);
      found.require(all, rule + ": its bonds follow the radii of particles, and some have none");
    }
    found.require(r.in_a.size() != n || r.in_b.size() != n || !breaks_by_prestrain(r, model),
                  rule + ": its prestrain alone breaks its bonds as they are made");
  }
  look_at_cell(model, stage, found);
  look_at_passage(model, stage, found);
  look_at_stops(stage.stops, model.walls.size(), found);
  return std::move(found).take();
}

std::vector<std::string> mistakes_in(const std::vector<Support>& supports, const State& state) {
  std::vector<std::string> found;
  if (state.cell.empty() || state.clock.stage_step != 0) return found;
  for (const Support& s : supports)
    if (const Bond* b = turns_as_one(s) ? bond_through_face(state, s.particles) : nullptr)
      found.push_back(
          fmt::format("{} is rigid and turns, and a bond joins its particles {} and {} through a face of the "
                      "cell: {}; {}",
                      who("a support", s), b->i.value, b->j.value, torn_rule, way_out_of_torn));
  return found;
}

std::vector<std::string> mistakes_in(const Model& model, const StaticStage& stage) {
  Mistakes found(model);
  found.require(is_static(stage.kind), "kind = dynamics: a stage of dynamics is a Stage, not a StaticStage");
  look_at_terms(model, stage, found);
  look_at_cell(model, stage, found);
  found.require_finite(stage.gravity, "the stage", "gravity");
  look_at_supports(model, stage.supports, found);
  for (const Support& s : stage.supports) {
    found.refuse_factor(s.factor, who("a support", s));
    found.require(stage.kind != StageKind::modes || !is_free_grip(s),
                  who("a grip", s) + " is free in part: modes take grips that hold all");
  }
  for (const PointLoad& l : stage.loads) {
    look_at_load(l, found);
    found.refuse_factor(l.factor, who("a load", l));
    found.require(!l.follower || takes_followers(stage.kind),
                  who("a load", l) + " turns with its particles: equilibria and paths take such loads");
  }
  const auto at_least = [&](const char* what, double value, double least) {
    found.require(value >= least && std::isfinite(value),
                  fmt::format("{} is {}: it must be >= {} and finite", what, value, least));
  };
  found.require(above_zero(stage.newton.tolerance),
                fmt::format("newton.tolerance is {}: it must be > 0", stage.newton.tolerance));
  at_least("newton.iterations", stage.newton.iterations, 1);
  if (stage.kind == StageKind::equilibrium || stage.kind == StageKind::fracture)
    at_least("steps", stage.steps, 1);
  if (stage.kind == StageKind::buckling || stage.kind == StageKind::modes) at_least("count", stage.count, 1);
  at_least("frames_per_mode", stage.frames_per_mode, 0);
  at_least("amplitude", stage.amplitude, 0);
  at_least("search_to", stage.search_to, 0);
  const PathSettings& path = stage.path;
  found.require(stage.kind != StageKind::path || (std::isfinite(path.first_step) && path.first_step != 0.0),
                fmt::format("path.first_step is {}: it must be finite, and not 0", path.first_step));
  at_least("path.largest_step", path.largest_step, 0);
  at_least("path.most_points", path.most_points, 1);
  for (const auto& [name, value] : {std::pair{"path.above", path.above}, {"path.below", path.below}})
    found.require(!value || std::isfinite(*value), fmt::format("{} is {}", name, value.value_or(0.0)));
  look_at_distance(path.distance, found);
  if (path.branch) {
    at_least("path.branch.bifurcation", path.branch->bifurcation, 1);
    at_least("path.branch.mode", path.branch->mode, 1);
    found.require(std::abs(path.branch->sense) == 1.0,
                  fmt::format("path.branch.sense is {}: it must be 1 or -1", path.branch->sense));
  }
  const FractureSettings& fracture = stage.fracture;
  found.require(above_zero(fracture.end), fmt::format("fracture.end is {}: it must be > 0", fracture.end));
  at_least("fracture.most_breaks", fracture.most_breaks, 1);
  if (fracture.load_drop)
    found.require(above_zero(*fracture.load_drop) && *fracture.load_drop <= 1.0,
                  fmt::format("fracture.load_drop is {}: it must be > 0 and <= 1", *fracture.load_drop));
  return std::move(found).take();
}

}  // namespace vbond
