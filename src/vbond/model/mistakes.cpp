#include "vbond/model/mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "vbond/model/agreement.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/held_tops.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/wall_mistakes.hpp"

namespace vbond {
namespace {

bool is_finite_quat(const Quatd& q) {
  return std::isfinite(q.w + q.x + q.y + q.z);
}

/// Rotations written with single precision pass; the first drift normalises them.
bool is_unit(const Quatd& q) {
  constexpr double tolerance = 1e-6;
  return std::abs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1.0) <= tolerance;
}

bool is_unit(const Vec3d& e) {
  constexpr double tolerance = 1e-6;
  return std::abs(norm(e) - 1.0) <= tolerance;
}

bool at_least_zero(double x) {
  return x >= 0.0 && std::isfinite(x);
}

bool above_zero(double x) {
  return x > 0.0 && std::isfinite(x);
}

std::string text(const Vec3d& x) {
  return fmt::format("({}, {}, {})", x.x, x.y, x.z);
}

/// Gathers mistakes.
std::pair<Vec3d, Vec3d> prescribed_motion(const Support& s) {
  return {s.velocity, s.angular_velocity};
}
std::pair<Vec3d, Vec3d> prescribed_motion(const StaticSupport& s) {
  return {s.displacement, s.rotation};
}

class Mistakes {
 public:
  explicit Mistakes(const Model& model) : n_(model.particles()) {}
  std::vector<std::string> take() && { return std::move(list_); }

  void add(std::vector<std::string> mistakes) {
    for (std::string& m : mistakes) list_.push_back(std::move(m));
  }

  void require(bool holds, const std::string& mistake) {
    if (!holds) list_.push_back(mistake);
  }

  /// The first entry of a column for which the rule does not hold; `told(value)` is how it is shown.
  template <class T, class Rule, class Told>
  void require_all(const PerParticle<T>& column, const char* name, const char* rule, Rule holds, Told told) {
    const auto wrong = std::find_if_not(column.begin(), column.end(), holds);
    if (wrong != column.end())
      list_.push_back(fmt::format("{} of particle {} is {}: it must be {}", name, wrong - column.begin(),
                                  told(*wrong), rule));
  }

  void require_sizes(const std::string& whose, const char* rule,
                     std::initializer_list<std::pair<const char*, std::size_t>> columns) {
    for (const auto& [name, size] : columns)
      require(size == n_,
              fmt::format("{} has {} entries in {} for {} particles: {}", whose, size, name, n_, rule));
  }

  bool knows(ParticleId p) const { return p.value < n_; }

  void require_known(const std::vector<ParticleId>& particles, const std::string& who,
                     const std::string& group = {}) {
    for (const ParticleId p : particles)
      if (!knows(p))
        return require(false, fmt::format("{} names particle {}{}, and there are {}, counted from 0", who,
                                          p.value, group.empty() ? "" : " (group \"" + group + "\")", n_));
  }

  /// Groups are looked up by bisection.
  void require_increasing(const std::vector<ParticleId>& particles, const std::string& who) {
    require(std::adjacent_find(particles.begin(), particles.end(), std::greater_equal<>()) == particles.end(),
            who + " does not name its particles in increasing order, each once");
  }

  void require_finite(const Vec3d& x, const std::string& who, const char* what) {
    require(is_finite(x), fmt::format("{} of {} is {}: it must be finite", what, who, text(x)));
  }

  void look_at(const std::optional<DistanceStop>& stop) {
    if (!stop) return;
    require_known({stop->i, stop->j}, "the stop at a distance");
    require(stop->i != stop->j, "the stop at a distance is between a particle and itself");
    require(std::isfinite(stop->value), fmt::format("the stop at a distance has the value {}", stop->value));
  }

  void look_at(const TimeFunction& f, const std::string& who) {
    for (const TimeFunction::Point& p : f.points)
      if (!std::isfinite(p.t) || !std::isfinite(p.factor))
        return require(false, fmt::format("the factor of {} has the point ({}, {})", who, p.t, p.factor));
    const auto before = [](const auto& a, const auto& b) { return b.t < a.t; };  // equal times: a jump
    require(std::adjacent_find(f.points.begin(), f.points.end(), before) == f.points.end(),
            "the factor of " + who + " does not have its points in increasing time");
  }

  /// What a grip does not hold is free of prescribed motion.
  template <class AnySupport>
  void look_at_free_grip(const AnySupport& s, const std::string& who) {
    const auto [way, turn] = prescribed_motion(s);
    bool moves_free = false;
    for (std::size_t k = 0; k < 3; ++k)
      moves_free |= !s.held[k] && component(way, static_cast<int>(k)) != 0.0;
    const bool holds_turns = s.held[3] && s.held[4] && s.held[5];
    require(!moves_free && (holds_turns || turn == Vec3d{}),
            who + " is rigid and moves along or about what it leaves free");
    require(!s.pivot || (s.held[0] && s.held[1] && s.held[2] && way == Vec3d{}),
            who + " is rigid, free in part, and has a pivot: that must stand still");
  }

  /// Only grips have a pivot; supports that overlap must agree.
  template <class AnySupport>
  void look_at_supports(const std::vector<AnySupport>& supports) {
    for (const AnySupport& s : supports) {
      const std::string who = s.group.empty() ? "a support" : "a support on \"" + s.group + "\"";
      if (is_free_grip(s)) look_at_free_grip(s, who);
      require(!s.rigid || !s.particles.empty(), who + " is rigid and has no particles");
      require(s.rigid || !s.pivot, who + " has a pivot: that is for rigid ones");
      if (s.pivot) require_finite(*s.pivot, who, "the pivot");
      if (!s.axes) continue;
      require(!s.rigid, who + " is rigid and has axes: those are for what is not rigid");
      for (const Triad& axes : {s.axes->along, s.axes->about})
        require(are_right_handed(axes),
                who + " has axes that are not perpendicular unit vectors, right-handed");
    }
    for (const Disagreement& d : disagreements(supports, n_))
      require(false, fmt::format(
                         "{} of particle {} is held twice, {}, by the supports on \"{}\" and \"{}\"", d.dof,
                         d.particle.value,
                         d.oblique ? "along axes that are neither parallel nor perpendicular" : "in two ways",
                         supports[d.first].group, supports[d.second].group));
  }

 private:
  std::size_t n_;
  std::vector<std::string> list_;
};

template <class Named>
std::string who(const std::string& what, const Named& of) {
  return of.group.empty() ? what : fmt::format("{} on \"{}\"", what, of.group);
}

void look_at_surface(const Surface& s, const std::string& of, Mistakes& found) {
  const auto not_negative = [&](const std::optional<double>& x, const char* name) {
    found.require(!x || at_least_zero(*x),
                  fmt::format("{}.{} is {}: it must be >= 0", of, name, x.value_or(0)));
  };
  not_negative(s.friction, "friction");
  not_negative(s.rolling_friction, "rolling_friction");
  not_negative(s.twisting_friction, "twisting_friction");
  not_negative(s.work_of_adhesion, "work_of_adhesion");
  const double e = s.restitution.value_or(1.0);
  found.require(e >= least_restitution && e <= 1.0,
                fmt::format("{}.restitution is {}: {} <= e <= 1", of, e, least_restitution));
}

void look_at_elasticity(double E, double nu, const std::string& of, Mistakes& found) {
  found.require(at_least_zero(E), fmt::format("{}.E is {}: it must be >= 0", of, E));
  found.require(nu > -1.0 && nu <= 0.5, fmt::format("{}.nu is {}: -1 < nu <= 0.5", of, nu));
}

void look_at_contact(const Model& model, Mistakes& found) {
  const ContactModel& c = model.contact;
  const auto not_negative = [&](double x, const char* name) {
    found.require(at_least_zero(x), fmt::format("contact.{} is {}: it must be >= 0", name, x));
  };
  switch (c.law) {
    case ContactLaw::none: break;
    case ContactLaw::paper_hertz:
      not_negative(c.c_H, "c_H");
      found.require(above_zero(c.length), fmt::format("contact.length is {}: it must be > 0", c.length));
      break;
    case ContactLaw::hertz:
      if (model.materials.empty()) look_at_elasticity(c.E, c.nu, "contact", found);
      break;
    case ContactLaw::linear: not_negative(c.k, "k"); break;
  }
  found.require(c.adhesion == AdhesionForm::none || c.law == ContactLaw::hertz,
                "contact.adhesion is for law hertz");
  found.require(!is_mindlin(c.tangential) || c.law == ContactLaw::hertz,
                "contact.tangential = mindlin is for law hertz, which has E and nu");
  found.require(
      c.rolling != RollingForm::spring || c.rolling_stiffness > 0.0 || c.tangential != TangentialForm::none,
      "contact.rolling = spring needs rolling_stiffness, or a tangential form that it follows from");
  not_negative(c.k_t, "k_t");
  not_negative(c.damping, "damping");
  not_negative(c.tangential_damping, "tangential_damping");
  not_negative(c.rolling_stiffness, "rolling_stiffness");
  look_at_surface(c.surface, "contact", found);
  for (const ContactMaterial& m : model.materials)
    look_at_surface(m.surface, "material \"" + m.name + "\"", found);
  for (const ContactPair& p : c.between) look_at_surface(p.surface, "contact.between", found);
}

void look_at_stops(const Stops& stops, std::size_t walls, Mistakes& found) {
  found.require(stops.duration > 0.0, fmt::format("the duration is {}: it must be > 0", stops.duration));
  found.look_at(stops.distance);
  if (stops.peak) {
    const PeakStop& peak = *stops.peak;
    found.require_known(peak.particles, "the stop at a peak");
    found.require_increasing(peak.particles, "the stop at a peak");
    found.require(peak.drop > 0.0 && peak.drop < 1.0,
                  fmt::format("the stop at a peak has drop = {}: 0 < drop < 1", peak.drop));
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

void look_at_strain(const StrainProgram& strain, Mistakes& found) {
  found.require_known(strain.particles, "the imposed strain");
  found.require_finite(strain.centre, "the imposed strain", "the centre");
  found.require(is_unit(strain.direction), "the direction of the imposed strain is " +
                                               text(strain.direction) + ": it must be a unit vector");
  found.require(std::isfinite(strain.increment),
                fmt::format("the increment of the imposed strain is {}", strain.increment));
  found.require(above_zero(strain.every),
                fmt::format("the strain is imposed every {}: it must be > 0", strain.every));
}

void look_at_principal_inertia(const Model& model, Mistakes& found) {
  if (model.principal.empty()) return;
  found.require_sizes("the model", "principal is empty, or has an entry for each particle",
                      {{"principal", model.principal.size()}});
  const auto told = [](const PrincipalInertia& I) { return text(I.moments); };
  found.require_all(
      model.principal, "the principal moments of inertia", "> 0, finite, none above the sum of the other two",
      [](const PrincipalInertia& I) {
        return above_zero(I.moments.x) && above_zero(I.moments.y) && above_zero(I.moments.z) &&
               keep_the_triangle_inequality(I.moments);
      },
      told);
  found.require_all(
      model.principal, "the principal axes", "a unit quaternion",
      [](const PrincipalInertia& I) { return is_finite_quat(I.axes) && is_unit(I.axes); }, told);
  for (const ParticleId p : model.principal.ids())
    if (found.knows(p) && p.value < model.inertia.size() &&
        model.inertia[p] != least_of(model.principal[p].moments))
      return found.require(false, fmt::format("the inertia of particle {} is {}: it must be the least of its "
                                              "principal moments: use make_top()",
                                              p.value, model.inertia[p]));
}

}  // namespace

std::vector<std::string> mistakes_in(const Model& model) {
  Mistakes found(model);
  const char* rule = "it must have a mass, inertia, radius and first position for each particle";
  found.require_sizes("the model", rule,
                      {{"inertia", model.inertia.size()},
                       {"radius", model.radius.size()},
                       {"r_0", model.r_0.size()},
                       {"specimen", model.specimen.empty() ? model.particles() : model.specimen.size()}});
  const auto number = [](double x) { return fmt::format("{}", x); };
  found.require_all(model.mass, "the mass", "> 0 and finite", above_zero, number);
  found.require_all(model.inertia, "the inertia", "> 0 and finite", above_zero, number);
  found.require_all(model.radius, "the radius", ">= 0 and finite", at_least_zero, number);
  found.require_all(
      model.r_0, "r_0", "finite", [](const Vec3d& r) { return is_finite(r); }, text);
  look_at_principal_inertia(model, found);
  for (const Group& g : model.groups) {
    found.require_known(g.particles, "group \"" + g.name + "\"");
    found.require_increasing(g.particles, "group \"" + g.name + "\"");
  }
  look_at_contact(model, found);
  found.add(mistakes_in_walls(model));
  return std::move(found).take();
}

std::vector<std::string> mistakes_in(const Model& model, const State& s) {
  Mistakes found(model);
  found.require_sizes(
      "the state", "it must have r, v, q and omega for each particle of the model: begin with at_rest(model)",
      {{"r", s.r.size()}, {"v", s.v.size()}, {"q", s.q.size()}, {"omega", s.omega.size()}});
  found.require(s.spin.empty() || s.spin.size() == model.particles(),
                fmt::format("spin has {} entries for {} particles: it must have one for each, or none",
                            s.spin.size(), model.particles()));
  found.require(s.bond_history.empty() || s.bond_history.size() == s.bonds.size(),
                fmt::format("bond_history has {} entries for {} bonds: it must have one for each, or none",
                            s.bond_history.size(), s.bonds.size()));
  for (const Loads* l : {&s.loads, &s.damping, &s.local_damping})
    found.require(
        (l->F.empty() && l->M.empty()) ||
            (l->F.size() == model.particles() && l->M.size() == model.particles()),
        fmt::format("loads of the state have {} and {} entries for {} particles: one for each, or none",
                    l->F.size(), l->M.size(), model.particles()));
  found.require(
      s.temperature.empty() || s.temperature.size() == model.particles(),
      fmt::format("the state has {} temperatures for {} particles: it must have one for each, or none",
                  s.temperature.size(), model.particles()));
  for (std::size_t k = 0; k < s.warm_bonds.size(); ++k) {
    const WarmBond& w = s.warm_bonds[k];
    if (w.bond.value < s.bonds.size() && above_zero(w.a) && (k == 0 || s.warm_bonds[k - 1].bond < w.bond))
      continue;
    found.require(false, fmt::format("warm_bonds has bond {} of {} with the length {}: they are bonds of the "
                                     "state in their order, with lengths above zero",
                                     w.bond.value, s.bonds.size(), w.a));
    break;
  }
  found.require(s.walls.empty() || s.walls.size() == model.walls.size(),
                fmt::format("the state has {} walls for {} of the model: one for each, or none",
                            s.walls.size(), model.walls.size()));
  for (const WallMemory& m : s.wall_history)
    if (!found.knows(m.p) || m.wall >= model.walls.size()) {
      found.require(false, fmt::format("wall_history has particle {} of {} and wall {} of {}", m.p.value,
                                       model.particles(), m.wall, model.walls.size()));
      break;
    }
  for (const FibreMemory& m : s.fibre_history)
    for (const ParticleId p : {m.a_i, m.a_j, m.b_i, m.b_j})
      found.require(found.knows(p),
                    fmt::format("fibre_history has particle {} of {}", p.value, model.particles()));
  for (const PairMemory& m : s.contact_history)
    if (!found.knows(m.i) || !found.knows(m.j) || m.i == m.j || !(m.kept >= 0.0)) {
      found.require(false,
                    fmt::format("contact_history has a pair of particles {} and {} of {} that keeps {}",
                                m.i.value, m.j.value, model.particles(), m.kept));
      break;
    }
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (b.law == nullptr) {
      found.require(false, fmt::format("bond {} has no law", k.value));
      break;
    }
    found.require(
        at_least_zero(b.capsule),
        fmt::format("the capsule of bond {} has the radius {}: it must be >= 0", k.value, b.capsule));
    if (found.knows(b.i) && found.knows(b.j) && b.i != b.j) continue;
    found.require(false,
                  fmt::format("bond {} joins particles {} and {} of {}: a bond must join two particles "
                              "of the model",
                              k.value, b.i.value, b.j.value, model.particles()));
    break;
  }
  const bool capsules = any_capsules(model.contact, s.bonds);
  found.require(model.contact.adhesion == AdhesionForm::none || !capsules,
                "bonds touch as capsules, which take no adhesion: contact.adhesion must be none");
  found.require(!model.contact.keeps_overlap || !capsules,
                "bonds touch as capsules, which keep no overlap: contact.keeps_overlap must be false");
  const Clock& c = s.clock;
  found.require(
      c.step >= 0 && c.stage_step >= 0 && c.stage >= 0 && at_least_zero(c.dt) && std::isfinite(c.stage_start),
      fmt::format("the clock is at step {}, stage {}, its step {}, dt = {}: none may be below zero", c.step,
                  c.stage, c.stage_step, c.dt));
  return std::move(found).take();
}

std::vector<std::string> mistakes_in_values(const Model& model, const State& s) {
  Mistakes found(model);
  const auto finite = [](const Vec3d& x) { return is_finite(x); };
  const auto quat = [](const Quatd& q) { return fmt::format("({}, {}, {}, {})", q.w, q.x, q.y, q.z); };
  found.require_all(s.r, "the position", "finite", finite, text);
  found.require_all(s.v, "the velocity", "finite", finite, text);
  found.require_all(s.omega, "the angular velocity", "finite", finite, text);
  found.require_all(
      s.q, "the orientation", "a unit quaternion",
      [](const Quatd& q) { return is_finite_quat(q) && is_unit(q); }, quat);
  return std::move(found).take();
}

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
  for (const Support& s : stage.supports) {
    found.require_known(s.particles, "a support", s.group);
    found.require_finite(s.velocity, who("a support", s), "the velocity");
    found.require_finite(s.angular_velocity, who("a support", s), "the angular velocity");
    found.look_at(s.factor, who("a support", s));
  }
  found.look_at_supports(stage.supports);
  for (const Support& s : stage.supports) {
    if (!is_free_grip(s)) continue;
    const std::string grip = who("a grip", s);
    found.require(s.held[3] + s.held[4] + s.held[5] != 1,
                  grip + " holds one turn: in motion it holds none, two or all three");
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
    found.require_known(l.particles, "a load", l.group);
    found.require_finite(l.force, who("a load", l), "the force");
    found.require_finite(l.moment, who("a load", l), "the moment");
    found.require_finite(l.force_by_mass, who("a load", l), "the force by mass");
    found.require_finite(l.moment_by_mass, who("a load", l), "the moment by mass");
    found.look_at(l.factor, who("a load", l));
  }
  for (const Heating& h : stage.heating) {
    found.require_known(h.particles, "a temperature", "");
    found.require(std::isfinite(h.temperature), "a temperature is not finite");
    found.look_at(h.factor, "a temperature");
  }
  if (stage.strain) {
    look_at_strain(*stage.strain, found);
    found.require(!strained_and_gripped(stage),
                  "the imposed strain moves particles of a rigid support, which would take them back");
  }
  for (const BondingRule& r : stage.bonding) {
    const std::string rule = "bonding rule \"" + r.name + "\"";
    found.require_sizes(rule, "a bonding rule must say of each particle if it is meant",
                        {{"in_a", r.in_a.size()}, {"in_b", r.in_b.size()}});
    found.require(above_zero(r.distance),
                  fmt::format("{} has distance = {}: it must be > 0", rule, r.distance));
    const std::size_t n = model.particles();
    found.require(r.in_a.size() != n || r.in_b.size() != n || !breaks_by_prestrain(r, model),
                  rule + ": its prestrain alone breaks its bonds as they are made");
  }
  found.add(mistakes_in_drives(model, stage.walls));
  for (const WallDrive& d : stage.walls) {
    found.look_at(d.factor, "the drive of wall \"" + d.wall + "\"");
    if (d.servo) found.look_at(d.servo->factor, "the servo of wall \"" + d.wall + "\"");
  }
  look_at_stops(stage.stops, model.walls.size(), found);
  return std::move(found).take();
}

std::vector<std::string> mistakes_in(const Model& model, const StaticStage& stage) {
  Mistakes found(model);
  found.require(is_static(stage.kind), "kind = dynamics: a stage of dynamics is a Stage, not a StaticStage");
  found.add(mistakes_in_drives(model, stage));
  found.require_finite(stage.gravity, "the stage", "gravity");
  for (const StaticSupport& s : stage.supports) {
    found.require_known(s.particles, "a support", s.group);
    found.require_finite(s.displacement, who("a support", s), "the displacement");
    found.require_finite(s.rotation, who("a support", s), "the rotation");
    found.require(!is_free_grip(s),
                  who("a grip", s) + " is free in part: stages at rest take grips that hold all");
  }
  found.look_at_supports(stage.supports);
  for (const StaticLoad& l : stage.loads) {
    found.require_known(l.particles, "a load", l.group);
    found.require_finite(l.force, who("a load", l), "the force");
    found.require_finite(l.moment, who("a load", l), "the moment");
    found.require_finite(l.force_by_mass, who("a load", l), "the force by mass");
    found.require_finite(l.moment_by_mass, who("a load", l), "the moment by mass");
  }
  for (const StaticHeating& h : stage.heating) {
    found.require_known(h.particles, "a temperature", "");
    found.require(std::isfinite(h.change), "the change of a temperature is not finite");
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
  found.look_at(path.distance);
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

void refuse(const std::string& who, const std::vector<std::string>& mistakes) {
  if (mistakes.empty()) return;
  std::string text = who;
  for (const std::string& m : mistakes) text += (mistakes.size() == 1 ? ": " : "\n  ") + m;
  throw std::invalid_argument(text);
}

}  // namespace vbond
