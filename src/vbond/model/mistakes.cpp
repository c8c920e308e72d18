#include "vbond/model/mistakes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "vbond/model/capsules.hpp"
#include "vbond/model/detail/mistakes.hpp"
#include "vbond/model/drop.hpp"
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
  if (const auto mistake = mistake_in_dropped(s)) found.require(false, *mistake);
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

void refuse(const std::string& who, const std::vector<std::string>& mistakes) {
  if (mistakes.empty()) return;
  std::string text = who;
  for (const std::string& m : mistakes) text += (mistakes.size() == 1 ? ": " : "\n  ") + m;
  throw std::invalid_argument(text);
}

}  // namespace vbond
