#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "dynamics/plain_flow.hpp"
#include "statics/bodies.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/heat.hpp"

/// Random small bodies whose bonds yield, creep, soften, damp, break and grow with temperature, and the count
/// of those that go as an evaluation of the tests' own says. How many: VBOND_CAMPAIGN.
namespace vbond::testing {

struct Body {
  Specimen specimen;
  std::vector<PlainBond> bonds;
};

/// Draws how a bond flows; rules and words of the test in step.
inline void draw_flow(Dice& dice, bool may_creep, BondRules& rules, PlainBond& b) {
  const auto limit = [&](double low, double high, bool shifts) {
    PlainLimit l{dice(low, high), 0, 0};
    if (dice(0, 1) < 0.4) l.isotropic = dice(0.01, 0.5) * l.limit / low * 1e-2;
    if (shifts && dice(0, 1) < 0.4) l.kinematic = dice(0.01, 0.5) * l.limit / low * 1e-2;
    return l;
  };
  const double kind = dice(0, 1);
  if (kind < 0.15) return;  // elastic
  if (kind < 0.3) {
    b.N_c = dice(0.02, 0.06), b.u_f = b.N_c / b.law.c[0] * dice(2, 6);
    rules.softening = {b.N_c, b.u_f};
    return;
  }
  if (may_creep && kind < 0.5) {
    b.exponent = dice(0, 1) < 0.5 ? 1 : static_cast<int>(dice(2, 5));
    b.creep = 2e-3 / std::pow(0.05, b.exponent - 1);
    rules.creep = {b.creep, static_cast<std::size_t>(b.exponent)};
    if (dice(0, 1) < 0.5) return;
  }
  if (dice(0, 1) < 0.6) b.axial = limit(0.01, 0.05, true), b.compression = dice(0.01, 0.05);
  if (dice(0, 1) < 0.6) b.shear = limit(1e-3, 1e-2, false);
  if (dice(0, 1) < 0.6) b.bending = limit(2e-4, 2e-3, true);
  if (dice(0, 1) < 0.6) b.torsion = limit(2e-4, 2e-3, true);
  const auto fill = [&](double PlainLimit::*part) {
    return FlowLimits{b.axial.*part, b.shear.*part, b.bending.*part, b.torsion.*part};
  };
  rules.yield.limit = fill(&PlainLimit::limit);
  rules.yield.compression = b.axial.limit > 0.0 ? b.compression : 0.0;
  rules.yield.isotropic = fill(&PlainLimit::isotropic);
  rules.yield.kinematic = fill(&PlainLimit::kinematic);
}

/// 2 to 30 particles of a grid, each bonded to one before it and to some others.
inline Body random_body(unsigned seed, bool may_creep, bool may_break, bool may_flow = true) {
  Dice dice(seed);
  const auto n = static_cast<std::size_t>(dice(2, 31));
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)
    r.push_back(
        Vec3d{static_cast<double>(k % 3), static_cast<double>(k / 3 % 3), static_cast<double>(k / 9)} +
        Vec3d{dice(-.1, .1), dice(-.1, .1), dice(-.1, .1)});
  Body body{particles_at(r), {}};
  Specimen& s = body.specimen;
  const bool warm = dice(0, 1) < 0.5;
  for (std::size_t j = 1; j < n; ++j) {
    bool held = false;
    for (std::size_t i = j; i-- > 0;) {
      if (norm(r[j] - r[i]) > 1.35 || (held && dice(0, 1) < 0.4)) continue;
      held = true;
      PlainBond b;
      b.i = i, b.j = j, b.law.evm = dice(0, 1) < 0.5;
      BondRecipe recipe;
      recipe.law = b.law.evm ? &bond_law<Evm> : &bond_law<VModel>;
      recipe.attachment = Attachment::given;
      recipe.R_i = b.R_i = dice(0, 0.2), recipe.R_j = b.R_j = dice(0, 0.2);
      b.law.a = b.a = norm(r[j] - r[i]) - b.R_i - b.R_j;
      b.law.c = {dice(0.5, 2), dice(0.02, 0.5), dice(0.01, 0.1), dice(0.01, 0.1)};
      recipe.parameters = BondStiffness<double>{b.law.c[0], b.law.c[1], b.law.c[2], b.law.c[3]};
      if (may_creep && dice(0, 1) < 0.5) b.g = {dice(0, .2), dice(0, .02), dice(0, .01), dice(0, .001)};
      recipe.damping = {DampingBy::coefficients, b.g};
      if (may_flow) draw_flow(dice, may_creep, recipe.rules, b);
      if (may_break) {
        b.criterion = static_cast<Criterion>(static_cast<int>(dice(0, 8)));
        draw_limits(b.criterion, dice, b.limits);
        recipe.rules.strength = strength_of(b.criterion, b.limits);
        if (dice(0, 1) < 0.5) recipe.weibull = {dice(3, 12), 0, 0, seed};
      }
      if (warm && dice(0, 1) < 0.7) recipe.expansion = dice(-1e-3, 1e-3);
      const auto made = make_bond(recipe, bond_site(s.model, s.state, ParticleId{i}),
                                  bond_site(s.model, s.state, ParticleId{j}));
      add_bond(s.model, made.value(), recipe, s.state);
      b.factor = strength_factor(*made);
      const BondPose<double> pose = bond_pose(*made, s.state);
      b.points_i = pose.n_i[0], b.points_j = pose.n_j[0];
      for (int k = 0; k < 3; ++k) b.axes_i[k] = pose.n_i[k], b.axes_j[k] = pose.n_j[k];
      body.bonds.push_back(b);
    }
  }
  const double speed = dice(0.02, 0.12);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.v[p] = {dice(-speed, speed), dice(-speed, speed), dice(-speed, speed)};
    s.state.omega[p] = {dice(-speed, speed), dice(-speed, speed), dice(-speed, speed)};
  }
  return body;
}

/// Bonds get the lengths that belong to these temperatures of particles.
inline void warm_up(std::vector<PlainBond>& bonds, const State& at_zero, const std::vector<double>& T) {
  for (const WarmBond& w : at_zero.warm_bonds) {
    PlainBond& b = bonds[w.bond.value];
    const double factor = 1.0 + w.expansion * 0.5 * (T[b.i] + T[b.j]);
    b.a = factor * w.a, b.R_i = factor * w.R_i, b.R_j = factor * w.R_j;
  }
}

/// Sums of what bonds have lost by yield, in the ways that the test works out.
inline double largest_difference(const Losses& found, const std::vector<PlainBond>& bonds) {
  Losses own;
  for (const PlainBond& b : bonds) own += b.lost;
  double largest = 0.0;
  for (const Loss cause :
       {Loss::yield_axial, Loss::yield_shear, Loss::yield_bending, Loss::yield_torsion, Loss::creep})
    largest = std::max(largest, std::abs(found[cause] - own[cause]));
  return largest;
}

struct Verdict {
  std::string wrong;  // empty: right
  bool undecided = false;
  std::string given_up;  // what the program did not find
  std::size_t breaks = 0, adopted = 0;
  std::string ended;
  Losses lost{};
};

inline unsigned bodies_wanted() {
  const char* wanted = std::getenv("VBOND_CAMPAIGN");
  return wanted ? static_cast<unsigned>(std::atoi(wanted)) : 60;
}

/// Runs the bodies and counts.
template <class Try>
void campaign(const char* name, Try one, std::initializer_list<Loss> must_occur) {
  const char* only = std::getenv("VBOND_CAMPAIGN_SEED");
  unsigned right = 0, wrong = 0, undecided = 0, given_up = 0, aborted = 0;
  std::size_t breaks = 0, adopted = 0;
  std::map<std::string, unsigned> ended;
  Losses lost;
  for (unsigned seed = 1; seed <= bodies_wanted(); ++seed) {
    if (only && seed != static_cast<unsigned>(std::atoi(only))) continue;
    try {
      const Verdict v = one(seed);
      breaks += v.breaks, adopted += v.adopted, lost += v.lost;
      if (!v.ended.empty()) ++ended[v.ended];
      if (!v.given_up.empty()) {
        ++given_up;
        std::printf("%s seed %u: %s\n", name, seed, v.given_up.c_str());
      } else if (v.wrong.empty()) {
        ++right;
      } else if (v.undecided) {
        ++undecided;
      } else {
        ++wrong;
        ADD_FAILURE() << name << " seed " << seed << ": " << v.wrong;
      }
    } catch (const NoEquilibrium& e) {
      ++given_up;
      std::printf("%s seed %u: %s\n", name, seed, e.what());
    } catch (const std::exception& e) {
      ++aborted;
      ADD_FAILURE() << name << " seed " << seed << ": " << e.what();
    }
  }
  std::printf("%s: %u right, %u wrong, %u undecided, %u given up, %u aborted; %zu bonds broke\n", name, right,
              wrong, undecided, given_up, aborted, breaks);
  for (const auto& [how, times] : ended) std::printf("  ended by %s: %u\n", how.c_str(), times);
  if (adopted > 0) std::printf("  balances after a break taken from the program: %zu\n", adopted);
  EXPECT_LE(undecided, 1 + bodies_wanted() / 100);
  EXPECT_LE(given_up, bodies_wanted() / 20);
  if (bodies_wanted() < 60) return;  // fewer need not have all
  for (const Loss cause : must_occur) EXPECT_GT(lost[cause], 0.0) << static_cast<int>(cause);
}

}  // namespace vbond::testing
