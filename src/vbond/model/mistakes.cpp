#include "vbond/model/mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "vbond/model/capsules.hpp"
#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/terms/walls/wall_mistakes.hpp"

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

/// Softening and creep are worked out for the tension of the elastic law.
bool stretches_as_it_flows(const Bond& b) {
  return b.law == nullptr || !b.law->has_rules || b.rules->stretch.form == StretchForm::harmonic ||
         (!b.rules->softening.any() && b.rules->creep.rate == 0.0);
}
/// The tension must fall from its limit to zero along a line.
bool reaches_its_softening(const Bond& b) {
  if (b.law == nullptr || !b.law->has_rules || !b.law->remembers() || !b.rules->softening.any()) return true;
  const double factor = strength_factor(b);
  return b.law->tension(b, b.a + b.rules->softening.length / factor, no_history) >
         factor * b.rules->softening.force;
}

/// Columns have an entry for each particle or bond; those that not all bodies have may be empty, those of one
/// member of State together.
void look_at_sizes(const Model& model, const State& s, Mistakes& found) {
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    bool none = true;
    for_each_field(table, [&]<class Of, class Value, class Member>(const Field<Of, Value, Member>& f) {
      if constexpr (is_column<Value> && !std::is_same_v<Of, State>) none &= (table.in(s).*f.value).empty();
    });
    for_each_field(table, [&]<class Of, class Value, class Member>(const Field<Of, Value, Member>& f) {
      if constexpr (is_column<Value>) {
        const std::size_t size = (table.in(s).*f.value).size();
        const bool of_particles = is_particle_column<Value>;
        const std::size_t wanted = of_particles ? model.particles() : s.bonds.size();
        const bool may_be_empty = f.traits.filed == Filed::where_any && none;
        found.require(size == wanted || (may_be_empty && size == 0),
                      fmt::format("the state has {} entries in {}{} for {} {}: it must have one for each{}",
                                  size, std::string_view(table.path).substr(1), f.name, wanted,
                                  of_particles ? "particles" : "bonds",
                                  may_be_empty ? ", or none" : "; begin with at_rest(model)"));
      }
    });
  });
}

/// Rows name particles and bonds that are there. The first of each kind that does not is told.
void look_at_ids(const Model& model, const State& s, Mistakes& found) {
  for_each_table(state_table, [&]<class Table>(const Table& table) {
    if constexpr (is_row_table<Table>)
      for_each_field(table, [&]<class Of, class Value, class Member>(const Field<Of, Value, Member>& f) {
        if constexpr (std::is_same_v<Value, ParticleId> || std::is_same_v<Value, BondId>) {
          const bool is_particle = std::is_same_v<Value, ParticleId>;
          const std::size_t n = is_particle ? model.particles() : s.bonds.size();
          const auto& rows = table.in(s);
          const auto wrong = std::find_if(rows.begin(), rows.end(),
                                          [&](const Of& row) { return (row.*f.value).value >= n; });
          if (wrong != rows.end())
            found.require(false,
                          fmt::format("{}[{}].{} is {} {}, and there are {}, counted from 0", name_of(table),
                                      wrong - rows.begin(), f.name, is_particle ? "particle" : "bond",
                                      ((*wrong).*f.value).value, n));
        }
      });
  });
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
  found.add(mistakes_in_cell(model));
  if (!model.sources.empty() && model.r_0.size() == model.particles() &&
      model.radius.size() == model.particles() && model.inertia.size() == model.particles())
    found.add(mistakes_in_sources(model));
  return std::move(found).take();
}

std::vector<std::string> mistakes_in(const Model& model, const State& s) {
  Mistakes found(model);
  look_at_sizes(model, s, found);
  look_at_ids(model, s, found);
  const auto require_each = [&found](const auto& rows, const char* name, const char* rule, auto holds) {
    const auto wrong = std::find_if_not(rows.begin(), rows.end(), holds);
    found.require(wrong == rows.end(), fmt::format("{}[{}] {}", name, wrong - rows.begin(), rule));
  };
  require_each(s.bonds, "bonds", "has no law", [](const Bond& b) { return b.law != nullptr; });
  require_each(s.bonds, "bonds", "softens or creeps, and has a form of stretching of its own",
               stretches_as_it_flows);
  require_each(s.bonds, "bonds", "softens from a force that it does not reach before its length of softening",
               reaches_its_softening);
  require_each(s.bonds, "bonds", "joins a particle with itself",
               [](const Bond& b) { return b.i != b.j || !image_of_j(b).is_itself(); });
  require_each(s.bonds, "bonds", "has a capsule whose radius is not >= 0 and finite",
               [](const Bond& b) { return at_least_zero(capsule_of(b)); });
  require_each(s.warm_bonds, "warm_bonds", "has no length above zero",
               [](const WarmBond& w) { return above_zero(w.a); });
  found.require(std::adjacent_find(s.warm_bonds.begin(), s.warm_bonds.end(),
                                   [](const WarmBond& a, const WarmBond& b) { return !(a.bond < b.bond); }) ==
                    s.warm_bonds.end(),
                "warm_bonds are not in the order of their bonds, each once");
  require_each(s.contact_history, "contacts", "is of a pair i < j that keeps an overlap >= 0: it is not",
               [](const PairMemory& m) {
                 return (m.i < m.j || (m.i == m.j && m.image_j > Image{})) && m.kept >= 0.0;
               });
  require_each(s.carried, "carried", "is no particle of the state, or of no body",
               [&](const Carried& c) { return c.particle.value < model.particles() && c.body > 0; });
  found.require(std::adjacent_find(s.carried.begin(), s.carried.end(),
                                   [](const Carried& a, const Carried& b) {
                                     return !(a.particle < b.particle);
                                   }) == s.carried.end(),
                "carried are not in the order of particles, each once");
  found.add(mistakes_in_cell(model, s));
  require_each(s.wall_history, "wall_touches", "names a wall that is not there",
               [&](const WallMemory& m) { return m.wall < model.walls.size(); });
  found.require(s.walls.empty() || s.walls.size() == model.walls.size(),
                fmt::format("the state has {} walls for {} of the model: one for each, or none",
                            s.walls.size(), model.walls.size()));
  if (const auto mistake = mistake_in_dropped(s)) found.require(false, *mistake);
  if (const auto mistake = mistake_in_waiting(model, s)) found.require(false, *mistake);
  found.require(any_capsules(model.contact, s.bonds) ? s.waiting.empty() : true,
                "bonds touch as capsules, and particles wait to come in: capsules do not know them");
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
  found.require_all(s.spin, "the angular momentum", "finite", finite, text);
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

std::vector<std::string> mistakes_in_sources(const Model& model) {
  std::vector<std::string> found;
  std::vector<char> taken(model.particles(), 0);
  for (const Source& source : model.sources) {
    const std::string who = "source \"" + source.name + "\"";
    if (source.body.empty() || source.bodies < 1) {
      found.push_back(who + " has no body, or no particles in it");
      continue;
    }
    bool known = source.bodies == 1 ||
                 source.copies.value + (source.bodies - 1) * source.body.size() <= model.particles();
    for (const ParticleId p : source.body) known = known && p.value < model.particles();
    if (!known) {
      found.push_back(fmt::format("{} has particles that the model, of {}, has not", who, model.particles()));
      continue;
    }
    bool once = true, alike = true;
    for (std::size_t body = 0; body < source.bodies; ++body)
      for (std::size_t k = 0; k < source.body.size(); ++k) {
        const ParticleId p = source.particle(body, k), first = source.body[k];
        once = once && taken[p.value]++ == 0;
        alike = alike && model.mass[p] == model.mass[first] && model.radius[p] == model.radius[first] &&
                model.inertia[p] == model.inertia[first] && model.r_0[p] == model.r_0[first];
      }
    if (!once) found.push_back(who + " has a particle twice, or one of another source");
    if (!alike)
      found.push_back(who +
                      " has bodies that are not alike: masses, inertias, radii and r_0 must be the same");
    for (const SourceBond& b : source.bonds)
      if (b.i >= source.body.size() || b.j >= source.body.size() || b.i == b.j ||
          b.recipe >= source.recipes.size()) {
        found.push_back(who + " has a bond of particles or of a recipe that it has not");
        break;
      }
    if (!source.region || !source.region->holds || !(source.region->box.diagonal() < INFINITY))
      found.push_back(who + " has no region, or one without end");
    if (source.tries < 1) found.push_back(who + " tries no place: tries must be >= 1");
    if (!is_finite(source.velocity) || !is_finite(source.angular_velocity) ||
        !(source.velocity_spread >= 0.0 && source.angular_velocity_spread >= 0.0))
      found.push_back(who + " has a velocity that is not finite, or a spread below 0");
  }
  return found;
}

std::optional<std::string> mistake_in_waiting(const Model& model, const State& s) {
  if (!std::includes(s.dropped.begin(), s.dropped.end(), s.taken.begin(), s.taken.end()))
    return "a sink took out particles that are not among those that were dropped, or not in increasing order";
  if (!s.came_at.empty() &&
      (s.came_at.size() != s.r.size() ||
       !std::all_of(s.came_at.begin(), s.came_at.end(), [](const Vec3d& r) { return is_finite(r); })))
    return "places where particles came in are missing, or not finite";
  for (std::size_t k = 0; k < s.waiting.size(); ++k)
    if (s.waiting[k].value >= s.r.size() || (k > 0 && !(s.waiting[k - 1] < s.waiting[k])) ||
        is_dropped(s, s.waiting[k]))
      return fmt::format(
          "particle {} waits: those that do must be particles of the state that were not dropped, in "
          "increasing "
          "order",
          s.waiting[k].value);
  if (!s.sources.empty() && s.sources.size() != model.sources.size())
    return fmt::format("the state has records of {} sources, and the model has {}", s.sources.size(),
                       model.sources.size());
  if (s.waiting.empty()) return std::nullopt;
  for (const Bond& b : s.bonds)
    if (is_waiting(s, b.i) || is_waiting(s, b.j))
      return fmt::format("a bond joins particles {} and {}, one of which waits", b.i.value, b.j.value);
  for (const Source& source : model.sources) {
    const std::size_t in = bodies_in(source, s);
    for (std::size_t body = 0; body < source.bodies; ++body)
      for (std::size_t k = 0; k < source.body.size(); ++k)
        if (is_waiting(s, source.particle(body, k)) != (body >= in))
          return fmt::format(
              "bodies of source \"{}\" come in as a whole and in order: particle {} of body {} must {}",
              source.name, source.particle(body, k).value, body, body >= in ? "wait" : "not wait");
  }
  return std::nullopt;
}

}  // namespace vbond
