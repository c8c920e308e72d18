#include "vbond/statics/detail/kinks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vbond/model/rules.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/model/two_slopes.hpp"
#include "vbond/terms/walls/resting_walls.hpp"

namespace vbond {
namespace {

double rounding_of_gap(const Model& m, const State& s, ParticleId p) {
  return rounding_of_balance * m.radius[p] + rounding_of_place(s, p);
}

std::optional<Kink> kink_of_bonds(const State& s, const Moves& moves) {
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (!has_two_slopes(b) || !is_unstrained(s, k) || !(moves(b.i) || moves(b.j))) continue;
    return Kink{fmt::format("bond {} (particles {}, {}) is at rest, where its slopes in tension and "
                            "compression meet: the body has no single stiffness there",
                            k.value, b.i.value, b.j.value),
                "strain it to either side, or take one slope: motions that stretch no bond are the same"};
  }
  return std::nullopt;
}

/// All that touch once particles are larger by what rounding may be, and would not if they were smaller.
std::optional<Kink> kink_of_contacts(const Model& model, const State& s, const Moves& moves) {
  if (model.contact.law != ContactLaw::linear) return std::nullopt;  // Hertz's begin with none
  const Model larger = with_what_just_touches(model, s);
  const auto rounding = [&](ParticleId p) { return rounding_of_gap(model, s, p); };
  std::string pair;
  for_touching_pairs(larger, s, [&](ParticleId i, ParticleId j, const Image& n, double overlap) {
    if (!pair.empty() || !(overlap <= 2.0 * (rounding(i) + rounding(j)))) return;
    if (moves(i) || moves(j))
      pair = fmt::format("particles {} and {}{}", i.value, j.value, n.is_itself() ? "" : " (an image)");
  });
  if (pair.empty() && !model.walls.empty())
    for (const RestingTouch& t : RestingWalls(larger).touches(s))
      if (pair.empty() && t.overlap <= 2.0 * rounding(t.p) && moves(t.p))
        pair = fmt::format("particle {} and wall \"{}\"", t.p.value, model.walls[t.wall].name);
  if (pair.empty()) return std::nullopt;
  return Kink{pair +
                  " just touch, to rounding, and law = \"linear\" is stiff at once: the body has no single "
                  "stiffness there",
              "press the body a little, move them apart, leave bonded pairs out by pairs = \"unbonded\", or "
              "take law = \"hertz\", which begins with none"};
}

}  // namespace

std::optional<Kink> kink_at(const Model& model, const State& state, const Moves& moves) {
  const Moves here = moves ? moves : [](ParticleId) { return true; };
  if (std::optional<Kink> found = kink_of_bonds(state, here)) return found;
  return kink_of_contacts(model, state, here);
}

Model with_what_just_touches(const Model& model, const State& state) {
  Model larger = model;
  if (model.contact.law == ContactLaw::linear)
    for (const ParticleId p : state.r.ids()) larger.radius[p] += rounding_of_gap(model, state, p);
  return larger;
}

State with_stiffer_slopes(State state) {
  for (Bond& b : state.bonds) {
    if (!has_two_slopes(b)) continue;
    BondStiffness<double> c = b.law->stiffness(b);
    c.c_A *= std::max(1.0, b.rules->stretch.compression);
    b.coefficients = b.law->from_stiffness(c, b.a, b.coefficients);
    BondRules rules = *b.rules;
    rules.stretch = {};
    b.rules = &kept(rules);
  }
  return state;
}

}  // namespace vbond
