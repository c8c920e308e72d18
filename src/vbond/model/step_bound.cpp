#include "vbond/model/step_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vbond/model/contact_bound.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/physics/bond_step.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {
namespace {

constexpr double bonds_of_close_packing = 12.0;

/// What a bond's part of the bound is made of.
struct Element {
  BondStiffness<double> c, g;
  BondEnd i, j;
  Pull pull = {};

  double lambda() const { return element_bound(c, g, i, j, pull); }
};

struct Largest {
  double lambda = 0.0;
  std::optional<BondId> bond;
  Element element{};
  std::string source;
};

/// A bond at rest with the length a, as it is under this force: what resists shear are angles, and so c_D a^2
/// stays, while the arms of the forces become longer or shorter.
Element under(const Pull& pull, double a, Element e) {
  e.pull = pull;
  e.c.c_D *= sq(a / pull.D);
  for (BondEnd* end : {&e.i, &e.j}) end->lever += 0.5 * (pull.D - a);
  return e;
}

/// Which of the three kinds of motion of a bond its bound came from, and whether it is their damping (g),
/// which without any stiffness would give most of it, or the force of the bond.
std::string motion_of(const Element& e) {
  const auto& [c, g, i, j, pull] = e;
  constexpr double rounding = 1e-9;
  const double lambda = e.lambda();
  if (pull_bound(pull, i, j) >= 0.5 * lambda) return "turning against the tension";
  const auto sets = [&](const BondStiffness<double>& of_c, const BondStiffness<double>& of_g) {
    return element_bound(of_c, of_g, e.i, e.j) >= (1.0 - rounding) * lambda;
  };
  const std::string motion = i.is_offset() || j.is_offset()                         ? "deformation"
                             : sets({c.c_A, 0.0, 0.0, 0.0}, {g.c_A, 0.0, 0.0, 0.0}) ? "stretching"
                             : sets({0.0, 0.0, 0.0, c.c_T}, {0.0, 0.0, 0.0, g.c_T}) ? "torsion"
                                                                                    : "shear and bending";
  return element_bound(c, i, j, pull) < 0.5 * lambda ? "the damping of " + motion : motion;
}

PerParticle<double> bonds_of_particles(const Model& model, const BodyPart& body,
                                       const std::vector<BondingRule>& rules) {
  PerParticle<double> n(model.particles(), 0.0);
  const PerParticle<std::uint32_t> bonds = body.bonds_of_each();
  for (const ParticleId p : n.ids()) n[p] = static_cast<double>(bonds[p]);
  for (const BondingRule& rule : rules)
    for (const ParticleId p : n.ids())
      if (rule.in_a[p.value] || rule.in_b[p.value]) n[p] = std::max(n[p], bonds_of_close_packing);
  return n;
}

/// A bond at rest between particles that have so many bonds.
Element element_of(const Model& model, const Bond& b, const PerParticle<double>& n) {
  const auto end = [&](ParticleId p, double R, double o_2, double o_3) {
    return BondEnd{n[p], model.mass[p], model.inertia[p], R + 0.5 * b.a, o_2, o_3};
  };
  const auto [o_i2, o_i3, o_j2, o_j3] = offsets_of(b);
  return {b.law->stiffest(b), b.law->damping(b), end(b.i, b.R_i, o_i2, o_i3), end(b.j, b.R_j, o_j2, o_j3)};
}

/// The same as it is stretched or pressed now, as far as that is more than rounding. What has cracked has the
/// stiffness of the whole, and so enough; what has no length has no direction, and a run says so.
std::optional<Element> element_now(const State& state, BondId id, const Element& at_rest) {
  constexpr double rounding = 1e-9;
  const Bond& b = state.bonds[id];
  if (is_cracked(b)) return std::nullopt;
  const BondHistory& history = history_of_bond(state, id);
  const double D = bond_axis(b, bond_pose(b, state)).D;
  if (!(D > 0.0)) return std::nullopt;
  const double N = b.law->tension(b, D, history);
  const bool rests = std::abs(D - b.a) <= rounding * b.a && std::abs(N) <= rounding * b.a * at_rest.c.c_A;
  if (rests) return std::nullopt;
  Element now = under({N, D}, b.a, at_rest);
  if (b.law->has_rules && b.rules->stretch.form != StretchForm::harmonic) {
    const double d = 1e-6 * b.a;
    const double slope = (b.law->tension(b, D + d, history) - b.law->tension(b, D - d, history)) / (2.0 * d);
    now.c.c_A = std::max(now.c.c_A, slope);
  }
  return now;
}

/// That of all processes, of which each has looked at its own bonds: of equal ones that of the first bond.
void take_largest_of_all(const Communicator& all, Largest& largest) {
  struct Found {
    double lambda;
    BondId bond;
  };
  std::vector<Found> mine;
  if (largest.bond) mine.push_back({largest.lambda, *largest.bond});
  const std::vector<Found> found = all.gather(mine);
  if (found.empty()) return;
  const Found& of_all = *std::min_element(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.lambda > b.lambda || (a.lambda == b.lambda && a.bond < b.bond);
  });
  const bool is_mine = largest.bond && *largest.bond == of_all.bond;
  const std::vector<char> source = all.gather(
      is_mine ? std::vector<char>(largest.source.begin(), largest.source.end()) : std::vector<char>{});
  largest = {of_all.lambda, of_all.bond, {}, std::string(source.begin(), source.end())};
}

Largest largest_of_bonds(const Model& model, const BodyPart& body, const PerParticle<double>& n) {
  const State& state = body.state;
  Largest largest;
  const auto take = [&](BondId id, const Element& e) {
    const double lambda = e.lambda();
    if (!(lambda <= largest.lambda)) largest.lambda = lambda, largest.bond = id, largest.element = e;
  };
  for (const BondId id : state.bonds.ids()) {
    if (state.bonds[id].broken) continue;
    const Element at_rest = element_of(model, state.bonds[id], n);
    take(id, at_rest);
    if (const auto now = element_now(state, id, at_rest)) take(id, *now);
  }
  if (largest.bond) {
    const Bond& b = state.bonds[*largest.bond];
    largest.bond = body.name(*largest.bond);
    largest.source = motion_of(largest.element) + " of bond " + std::to_string(largest.bond->value) +
                     " (particles " + std::to_string(b.i.value) + ", " + std::to_string(b.j.value) + ")";
  }
  if (!body.has_all_bonds()) take_largest_of_all(body.all, largest);
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
  BondRadii radii;  // the largest
  BondEnd i = lightest(rule.in_a, radii.i), j = lightest(rule.in_b, radii.j);
  const double reach = rule.reach(radii.i, radii.j);
  const BondLengths lengths = bond_lengths(rule.recipe, reach, radii);
  // particles of different size may leave no length at the rule's distance; then nothing is known yet
  const double D = lengths.a > 0.0 ? lengths.a : reach, a = D / (1.0 + rule.recipe.prestrain);
  i.lever = lengths.R_i + 0.5 * a;
  j.lever = lengths.R_j + 0.5 * a;
  const BondStiffness<double> c = stiffness_of(rule.recipe, a, radii);
  Element at_rest{c, {}, i, j};
  const bool harmonic = rule.recipe.rules.stretch.form == StretchForm::harmonic;
  if (!harmonic || rule.recipe.damping.by != DampingBy::none) {
    const BondSite first{ParticleId{0}, {0, 0, 0}, {1, 0, 0, 0}, radii.i, i.m, i.Theta},
        second{ParticleId{1}, {D, 0, 0}, {1, 0, 0, 0}, radii.j, j.m, j.Theta};
    if (const std::optional<Bond> bond = make_bond(rule.recipe, first, second))
      at_rest.c = bond->law->stiffest(*bond), at_rest.g = bond->law->damping(*bond);
  }
  const Element made = under({tension(rule.recipe.rules.stretch, c.c_A, a, D), D}, a, at_rest);
  const Element& e = rule.recipe.prestrain != 0.0 && made.lambda() > at_rest.lambda() ? made : at_rest;
  motion = motion_of(e);
  return e.lambda();
}

}  // namespace

StepBound step_bound(const Model& model, const BodyPart& body, const std::vector<BondingRule>& rules,
                     const std::vector<WallDrive>& drives, double contacts_to_come,
                     const std::vector<Support>& supports) {
  const State& state = body.state;
  if (!state.waiting.empty() && !model.sources.empty()) {  // bodies bring bonds along
    State with_all = with_bonds_to_come(model, state);
    with_all.waiting.clear();
    with_all.dropped = absent(state);
    return step_bound(model, with_all, rules, drives, contacts_to_come, supports);
  }
  Largest largest = largest_of_bonds(model, body, bonds_of_particles(model, body, rules));
  for (const BondingRule& rule : rules) {
    std::string motion;
    const double lambda = lambda_of_rule(model, rule, motion);
    if (!(lambda <= largest.lambda))
      largest = {lambda, std::nullopt, {}, motion + " of a bond that \"" + rule.name + "\" may still make"};
  }
  const ContactBound contact = contact_bound(model, body, drives, rules, contacts_to_come, supports);
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

StepBound step_bound(const Model& model, const BodyPart& body, const Stage& stage, Spins spins) {
  const State& state = body.state;
  StepBound bound = step_bound(model, body, stage.bonding, stage.walls, 1.0, stage.supports);
  const auto take_up = [&](const State& extreme) {
    StepBound then = step_bound(model, extreme, stage.bonding, stage.walls, 1.0, stage.supports);
    if (then.dt < bound.dt) bound = std::move(then);
  };
  Terms::for_each([&]<class T>(T) { T::for_extremes(state, stage, take_up); });
  return within_turns(with_terms(std::move(bound), model, state, stage), model, body, stage, spins);
}

StepBound with_terms(StepBound bound, const Model& model, const State& state, const Stage& stage) {
  Terms::for_each([&]<class T>(T) {
    const AddedFrequency added = T::added_frequency(model, state, stage, bound.dt);
    if (!(added.lambda > 0.0)) return;
    const double without = std::exchange(bound.dt, critical_step(sq(2.0 / bound.dt) + added.lambda));
    constexpr double shorter = 0.99;  // by less it is not worth a word
    if (bound.dt < shorter * without) bound.source += std::string(", and ") + added.of;
  });
  return bound;
}

StepBound within_turns(StepBound bound, const Model& model, const BodyPart& body, const Stage& stage,
                       Spins spins) {
  // where nothing is elastic, supports and walls that turn set no step: nothing feels it
  const Stage none;
  const FastestTurn turn = fastest_turn(model, body, std::isinf(bound.dt) ? none : stage, spins);
  if (!(turn.rate * bound.dt > longest_turn)) return bound;
  return {longest_turn / turn.rate, std::nullopt, turn.source + ", which has to be below 0.5 rad in a step"};
}

}  // namespace vbond
