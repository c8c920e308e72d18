#include "vbond/model/step_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/model/capsules.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/physics/contact.hpp"
#include "vbond/physics/stability.hpp"

namespace vbond {
namespace {

constexpr double bonds_of_close_packing = 12.0;

struct Largest {
  double lambda = 0.0;
  std::optional<BondId> bond;
  std::string source;
};

/// Which of the three kinds of motion of a bond its bound came from.
std::string motion_of(const BondStiffness<double>& c, const BondEnd& i, const BondEnd& j, double lambda) {
  if (element_bound({c.c_A, 0.0, 0.0, 0.0}, i, j) >= lambda) return "stretching";
  if (element_bound({0.0, 0.0, 0.0, c.c_T}, i, j) >= lambda) return "torsion";
  return "shear and bending";
}

PerParticle<double> bonds_of_particles(const Model& model, const State& state,
                                       const std::vector<BondingRule>& rules) {
  PerParticle<double> n(model.particles(), 0.0);
  for (const Bond& b : state.bonds)
    if (!b.broken) n[b.i] += 1.0, n[b.j] += 1.0;
  for (const BondingRule& rule : rules)
    for (const ParticleId p : n.ids())
      if (rule.in_a[p.value] || rule.in_b[p.value]) n[p] = std::max(n[p], bonds_of_close_packing);
  return n;
}

Largest largest_of_bonds(const Model& model, const State& state, const PerParticle<double>& n) {
  Largest largest;
  const auto end = [&](ParticleId p, double R, double a) {
    return BondEnd{n[p], model.mass[p], model.inertia[p], R + 0.5 * a};
  };
  for (const BondId id : state.bonds.ids()) {
    const Bond& b = state.bonds[id];
    if (b.broken) continue;
    const double lambda =
        element_bound(b.law->stiffest(b), b.law->damping(b), end(b.i, b.R_i, b.a), end(b.j, b.R_j, b.a));
    if (!(lambda <= largest.lambda)) largest.lambda = lambda, largest.bond = id;
  }
  if (largest.bond) {
    const Bond& b = state.bonds[*largest.bond];
    largest.source =
        motion_of(b.law->stiffest(b), end(b.i, b.R_i, b.a), end(b.j, b.R_j, b.a), largest.lambda) +
        " of bond " + std::to_string(largest.bond->value) + " (particles " + std::to_string(b.i.value) +
        ", " + std::to_string(b.j.value) + ")";
  }
  return largest;
}

/// The bond a rule may make: as long as the rule's distance, between the lightest particles.
double lambda_of_rule(const Model& model, const BondingRule& rule, std::string& motion) {
  const auto lightest = [&](const std::vector<char>& in, double& radius) {
    BondEnd e{bonds_of_close_packing, std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity(), 0.0};
    for (const ParticleId p : model.mass.ids())
      if (in[p.value]) {
        e.m = std::min(e.m, model.mass[p]);
        e.Theta = std::min(e.Theta, model.inertia[p]);
        radius = std::max(radius, model.radius[p]);
      }
    return e;
  };
  double R_i = 0.0, R_j = 0.0;
  BondEnd i = lightest(rule.in_a, R_i), j = lightest(rule.in_b, R_j);
  if (rule.recipe.attachment == Attachment::centres) R_i = R_j = 0.0;
  if (rule.recipe.attachment == Attachment::given) R_i = rule.recipe.R_i, R_j = rule.recipe.R_j;
  const double left = rule.distance - R_i - R_j;
  // particles of different size may leave no length at the rule's distance; then nothing is known yet
  const double a = left > 0.0 ? left : rule.distance;
  i.lever = R_i + 0.5 * a;
  j.lever = R_j + 0.5 * a;
  const BondStiffness<double> c = stiffness_of(rule.recipe, a);
  const double lambda = element_bound(c, i, j);
  motion = motion_of(c, i, j, lambda);
  return lambda;
}

struct PresentContacts {
  double overlap = 0.0;  ///< largest
  double most = 1.0;     ///< of one particle, at least 1
};

PresentContacts present_contacts(const Model& model, const State& state) {
  PresentContacts found;
  PerParticle<double> n(model.particles(), 0.0);
  for_touching_pairs(model, state, [&](ParticleId i, ParticleId j, double overlap) {
    found.overlap = std::max(found.overlap, overlap);
    n[i] += 1.0, n[j] += 1.0;
  });
  for (const FibreContact& c : fibre_contacts(model, state.bonds, state.r)) {
    if (!c.body) continue;
    const auto at = [&state](ParticleId p) { return MovingPoint{state.r[p], {}, {}}; };
    found.overlap = std::max(found.overlap, touching_of(model, c, at).overlap);
    for (const FibrePlace& place : {c.a, c.b}) for_shares(place, [&n](ParticleId p, double) { n[p] += 1.0; });
  }
  for (const double count : n) found.most = std::max(found.most, count);
  return found;
}

/// The radii by which particles are touched: their own, or that of a capsule that is thicker.
PerParticle<double> touched_radii(const Model& model, const State& state) {
  PerParticle<double> R = model.radius;
  if (!any_capsules(model.contact, state.bonds)) return R;
  for (const Bond& b : state.bonds)
    for (const ParticleId p : {b.i, b.j})
      if (!b.broken) R[p] = std::max(R[p], b.capsule);
  return R;
}

/// Slope of the normal force, and of slip where that is larger in what it does to the step: a particle that
/// rolls feels slip with (1/m + R^2/Theta).
struct ContactSlopes {
  double normal = 0, tangential = 0, damping = 0;  ///< [force/length], [force*time/length]
};
ContactSlopes slopes_of(const ContactModel& contact, const TouchNumbers<double>& numbers, double R, double m,
                        double overlap) {
  const TouchForms forms = touch_forms(contact);
  TouchForms repulsion = forms;
  repulsion.adhesion = AdhesionForm::none;
  const NormalForce<double> n = normal_force(repulsion, numbers, R, overlap);
  ContactSlopes to;
  to.normal = (forms.normal == NormalForm::linear ? 1.0 : 1.5) * n.secant;
  if (forms.tangential != TangentialForm::none) to.tangential = tangential_stiffness(forms, numbers, n.a);
  to.damping = numbers.damping * std::sqrt(m * n.secant);
  return to;
}

struct LargestOfContacts {
  double lambda = 0.0;
  ParticleId p;
  std::uint32_t first = 0, second = 0;  ///< materials
  /// For reports.
  std::string source(const Model& model) const {
    const std::string of = "contacts of particle " + std::to_string(p.value);
    if (model.materials.empty()) return of;
    return of + ", " + model.materials[first].name + " with " + model.materials[second].name;
  }
};

/// A particle of the first material may touch a particle or a wall of the second.
struct MaterialPair {
  std::uint32_t first, second;
  TouchNumbers<double> numbers;
};
std::vector<MaterialPair> pairs_that_may_meet(const Model& model) {
  const std::size_t materials = std::max<std::size_t>(1, model.materials.size());
  std::vector<char> of_particles(materials, 0), of_any(materials, 0);
  for (const ParticleId p : model.mass.ids()) of_particles[model.material_of(p)] = 1;
  if (particles_touch(model.contact)) of_any = of_particles;
  for (const Wall& w : model.walls) of_any[w.material] = 1;
  std::vector<MaterialPair> pairs;
  for (std::uint32_t first = 0; first < materials; ++first)
    for (std::uint32_t second = 0; second < materials; ++second)
      if (of_particles[first] != 0 && of_any[second] != 0)
        pairs.push_back({first, second, touch_numbers(model.contact, model.materials, first, second)});
  return pairs;
}

/// Of the stiffest pair of materials with each particle against the largest: k_c (1/m_i + 1/m_j) <= 2/m_i
/// times k_c, if i is the lighter one.
LargestOfContacts largest_of_contacts(const Model& model, const State& state) {
  const ContactModel& contact = model.contact;
  if (contact.law == ContactLaw::none || model.particles() == 0) return {};
  if (model.walls.empty() && (model.particles() < 2 || !particles_touch(contact))) return {};
  const PerParticle<double> radius = touched_radii(model, state);
  const double R_max = *std::max_element(radius.begin(), radius.end());
  if (!(R_max > 0.0)) return {};
  const PresentContacts present = present_contacts(model, state);
  const std::vector<MaterialPair> pairs = pairs_that_may_meet(model);
  LargestOfContacts largest;
  for (const ParticleId p : model.mass.ids()) {
    const double R = radius[p], m = model.mass[p];
    const double R_pair = model.walls.empty() ? R * R_max / (R + R_max) : R;
    const double overlap = std::max(present.overlap, 0.1 * (R + R_max));
    for (const auto& [first, second, n] : pairs) {
      if (first != model.material_of(p)) continue;
      const ContactSlopes s = slopes_of(contact, n, R_pair, m, overlap);
      const double per_m = 2.0 / m, per_slip = 2.0 * (1.0 / m + sq(R) / model.inertia[p]);
      const double elastic = std::max(s.normal * per_m, s.tangential * per_slip);
      const double damping = std::max(per_m, s.tangential > 0.0 ? n.tangential_damping * per_slip : 0.0);
      const double lambda = damped_bound(present.most * elastic, present.most * s.damping * damping);
      if (lambda > largest.lambda) largest = {lambda, p, first, second};
    }
  }
  return largest;
}

}  // namespace

StepBound step_bound(const Model& model, const State& state, const std::vector<BondingRule>& rules) {
  Largest largest = largest_of_bonds(model, state, bonds_of_particles(model, state, rules));
  for (const BondingRule& rule : rules) {
    std::string motion;
    const double lambda = lambda_of_rule(model, rule, motion);
    if (!(lambda <= largest.lambda))
      largest = {lambda, std::nullopt, motion + " of a bond that \"" + rule.name + "\" may still make"};
  }
  const LargestOfContacts contact = largest_of_contacts(model, state);
  if (contact.lambda > 0.0) {
    const std::string source = contact.source(model);
    if (contact.lambda > largest.lambda) largest.bond.reset();
    largest.source = largest.source.empty()            ? source
                     : contact.lambda > largest.lambda ? source + ", and " + largest.source
                                                       : largest.source + ", and " + source;
    largest.lambda += contact.lambda;
  }
  if (largest.lambda == 0.0)
    return {std::numeric_limits<double>::infinity(), std::nullopt, "no bonds and no contacts"};
  return {critical_step(largest.lambda), largest.bond, largest.source};
}

}  // namespace vbond
