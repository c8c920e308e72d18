#pragma once
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "campaigns/judge.hpp"
#include "dynamics/plain_flow.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/terms/heat/heat.hpp"

/// Random small bodies whose bonds have all forms of stretching, yield, creep, soften, damp, break and grow
/// with temperature, and how they move by formulas of the tests' own.
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

/// What the bonds of a body may do.
struct Kinds {
  bool damps_and_creeps = false, breaks = false, flows = true, warms = true;
  bool has_forms = false;  ///< of stretching; then bonds may be softer in bending and torsion as well
};

/// 2 to 30 particles of a grid, each bonded to one before it and to some others, moving and turning.
inline Body random_body(unsigned seed, const Kinds& kinds) {
  Dice dice(seed);
  const std::size_t n = dice.count(2, 30);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)
    r.push_back(
        Vec3d{static_cast<double>(k % 3), static_cast<double>(k / 3 % 3), static_cast<double>(k / 9)} +
        dice.vector(0.1));
  Body body{particles_at(r), {}};
  Specimen& s = body.specimen;
  const bool warm = kinds.warms && dice.chance(0.5);
  for (std::size_t j = 1; j < n; ++j) {
    bool held = false;
    for (std::size_t i = j; i-- > 0;) {
      if (norm(r[j] - r[i]) > 1.35 || (held && dice.chance(0.4))) continue;
      held = true;
      PlainBond b;
      b.i = i, b.j = j, b.law.evm = dice.chance(0.5);
      BondRecipe recipe;
      recipe.law = b.law.evm ? &bond_law<Evm> : &bond_law<VModel>;
      recipe.attachment = Attachment::given;
      recipe.R_i = b.R_i = dice(0, 0.2), recipe.R_j = b.R_j = dice(0, 0.2);
      b.law.a = b.a = norm(r[j] - r[i]) - b.R_i - b.R_j;
      const double softest = kinds.has_forms ? 0.002 : 0.01;
      b.law.c = {dice(0.5, 2), dice(0.02, 0.5), dice(softest, 0.1), dice(softest, 0.1)};
      recipe.parameters = BondStiffness<double>{b.law.c[0], b.law.c[1], b.law.c[2], b.law.c[3]};
      if (kinds.damps_and_creeps && dice.chance(0.5))
        b.g = {dice(0, .2), dice(0, .02), dice(0, .01), dice(0, .001)};
      recipe.damping = {DampingBy::coefficients, b.g};
      if (kinds.has_forms) {
        b.form.form = static_cast<StretchForm>(dice.whole(0, 4));
        b.form.k3 = dice(-1, 1), b.form.k4 = dice(0, 3), b.form.compression = dice(0.5, 3);
        b.form.largest = dice(0.5, 1), b.form.alpha = dice(0.5, 3);
        recipe.rules.stretch = b.form;
      }
      if (kinds.flows) draw_flow(dice, kinds.damps_and_creeps, recipe.rules, b);
      if (kinds.breaks) {
        b.criterion = static_cast<Criterion>(dice.whole(0, 7));
        draw_limits(b.criterion, dice, b.limits);
        recipe.rules.strength = strength_of(b.criterion, b.limits);
        if (dice.chance(0.5)) recipe.weibull = {dice(3, 12), 0, 0, seed};
      }
      if (warm && dice.chance(0.7)) recipe.expansion = dice(-1e-3, 1e-3);
      const auto make = [&] {
        return make_bond(recipe, bond_site(s.model, s.state, ParticleId{i}),
                         bond_site(s.model, s.state, ParticleId{j}));
      };
      auto made = make();
      const double factor = strength_factor(made.value());
      if (b.N_c > 0.0 && !(b.law.c[0] * b.u_f > sq(factor) * b.N_c))  // it would snap back, and is refused
        recipe.weibull = {}, made = make();
      add_bond(s.model, made.value(), recipe, s.state);
      b.factor = strength_factor(*made);
      const BondPose<double> pose = bond_pose(*made, s.state);
      b.points_i = pose.n_i[0], b.points_j = pose.n_j[0];
      for (int k = 0; k < 3; ++k) b.axes_i[k] = pose.n_i[k], b.axes_j[k] = pose.n_j[k];
      body.bonds.push_back(b);
    }
  }
  const double speed = dice(0.02, kinds.has_forms ? 0.15 : 0.12);
  for (const ParticleId p : s.state.r.ids())
    s.state.v[p] = dice.vector(speed), s.state.omega[p] = dice.vector(speed);
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

/// A time loop of the tests' own: formulas of loads, flow, damping and strength, particles and bonds in their
/// own order.
class PlainMotion {
 public:
  explicit PlainMotion(const Body& body) : bonds(body.bonds) {
    const State& s = body.specimen.state;
    r = s.r.values(), q = s.q.values(), v = s.v.values(), w = s.omega.values();
    add_loads(v, w);
  }
  std::vector<PlainBond> bonds;
  std::vector<Vec3d> r, v, w;
  std::vector<Quatd> q;
  double nearest = 1;  ///< how near a utilisation came to 1

  /// Bonds have the lengths of the end of the step. Returns those that break.
  std::vector<std::size_t> step(double dt) {
    kick(dt / 2);
    const auto v_half = v, w_half = w;
    for (std::size_t p = 0; p < r.size(); ++p) {
      r[p] += dt * v[p];
      q[p] = normalised(rotation_of(dt * w[p]) * q[p]);
    }
    for (PlainBond& b : bonds) {
      if (b.broken) continue;
      const PlainPose p = pose_of(b, r[b.i], q[b.i], r[b.j], q[b.j]);
      const Vec3d rate =
          v_half[b.j] - v_half[b.i] + cross(w_half[b.j], p.arm_j) - cross(w_half[b.i], p.arm_i);
      flow_on(b, r[b.i], q[b.i], r[b.j], q[b.j], dot(rate, p.d), dt);
    }
    const std::vector<double> used = add_loads(v_half, w_half);
    kick(dt / 2);
    std::vector<std::size_t> broken;
    for (std::size_t k = 0; k < bonds.size(); ++k) {
      if (bonds[k].broken) continue;
      nearest = std::min(nearest, std::abs(used[k] - 1.0));
      if (used[k] >= 1.0) broken.push_back(k);
    }
    for (const std::size_t k : broken) bonds[k].broken = true;
    if (!broken.empty()) add_loads(v_half, w_half);
    return broken;
  }

 private:
  static constexpr double Theta = 0.064;
  std::vector<Vec3d> F_, M_;
  void kick(double h) {
    for (std::size_t p = 0; p < r.size(); ++p) v[p] += h * F_[p], w[p] += (h / Theta) * M_[p];
  }
  std::vector<double> add_loads(const std::vector<Vec3d>& v_at, const std::vector<Vec3d>& w_at) {
    F_.assign(r.size(), {}), M_.assign(r.size(), {});
    std::vector<double> used;
    for (const PlainBond& b : bonds) {
      used.push_back(0.0);
      if (b.broken) continue;
      const PlainPose p = pose_of(b, r[b.i], q[b.i], r[b.j], q[b.j]);
      PlainLoads l = loads_of(b, p);
      used.back() = utilisation_of(b, p, l);
      const Vec3d rate = v_at[b.j] - v_at[b.i] + cross(w_at[b.j], p.arm_j) - cross(w_at[b.i], p.arm_i);
      const Vec3d turn = w_at[b.j] - w_at[b.i];
      const Vec3d v_s = part_across(rate, p.d) - 0.5 * cross(w_at[b.i] + w_at[b.j], p.D);
      const Vec3d h = 0.5 * cross(p.D, b.g[1] * v_s);
      const Vec3d couple = b.g[2] * part_across(turn, p.d) + b.g[3] * dot(turn, p.d) * p.d;
      l.F += b.g[0] * dot(rate, p.d) * p.d + b.g[1] * v_s;
      F_[b.i] += l.F, F_[b.j] -= l.F;
      M_[b.i] += l.M_i + cross(p.arm_i, l.F) + h + couple;
      M_[b.j] += l.M_j - cross(p.arm_j, l.F) + h - couple;
    }
    return used;
  }
};

/// How a body went.
struct Course {
  Verdict verdict;
  std::size_t breaks = 0, adopted = 0;  ///< adopted: balances after a break that were taken from the program
  std::string ended;
  Losses lost{};
  bool right() const { return verdict.word == "right"; }
};

/// A campaign of such bodies: one(seed) gives a Course. All of these losses must come about.
template <class One>
void campaign_of_bodies(const char* name, One one, std::initializer_list<Loss> must_occur) {
  Losses lost;
  const Tally tally = campaign(name, 60, [&](unsigned seed, Tally& all) {
    const Course c = one(seed);
    lost += c.lost;
    all.add("breaks", static_cast<double>(c.breaks)), all.add("adopted", static_cast<double>(c.adopted));
    if (!c.ended.empty()) all.add("ended by " + c.ended);
    return c.verdict;
  });
  EXPECT_LE(tally["undecided"], 1 + tally.cases / 100);
  EXPECT_LE(tally["given up"], tally.cases / 20);
  if (!tally.full) return;  // fewer need not have all
  for (const Loss cause : must_occur) EXPECT_GT(lost[cause], 0.0) << static_cast<int>(cause);
}

}  // namespace vbond::testing
