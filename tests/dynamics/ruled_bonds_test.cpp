// Bonds with rules in random bodies: against a time loop with formulas of this test's own, and against the
// same body numbered and turned in another way.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <utility>
#include <vector>

#include "plain_bonds.hpp"
#include "rods.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/physics/far_from_breaking.hpp"

namespace vbond::ruled_bonds_test {
namespace {

using testing::Dice;
using testing::draw_limits;
using testing::Specimen;
using testing::strength_of;

/// What the reference of these tests knows of a bond, in words of materials.md and model.md.
struct PlainBond {
  std::size_t i, j;
  bool evm = false, broken = false;
  double a = 1, R_i = 0, R_j = 0;
  std::array<double, 4> c{}, g{};
  Stretch stretch;
  Criterion criterion = Criterion::none;
  testing::PlainLimits limit{1, 1, 1, 1};
  double factor = 1;
  Vec3d axes_i[3], axes_j[3];  // in the bodies
};

/// The axial force of a form, written apart from physics/stretch.hpp.
double axial_force(const Stretch& s, double c_A, double u) {
  switch (s.form) {
    case StretchForm::cubic: return c_A * u + s.k3 * u * u + s.k4 * u * u * u;
    case StretchForm::two_slopes: return u > 0 ? c_A * u : s.compression * c_A * u;
    case StretchForm::fene: return c_A * u / (1 - u * u / (s.largest * s.largest));
    case StretchForm::morse: return c_A / s.alpha * (std::exp(-s.alpha * u) - std::exp(-2 * s.alpha * u));
    default: return c_A * u;
  }
}

/// A time loop with its own formulas of loads, damping and strength, particles and bonds in their own order.
class OwnLoop {
 public:
  std::vector<PlainBond> bonds;
  std::vector<Vec3d> r, v, w;
  std::vector<Quatd> q;
  double Theta = 0.064, dissipated = 0;
  double nearest = 1;  ///< how near a utilisation came to 1 without a doubt on which side

  void start() { loads(v, w); }
  /// The bonds that broke in this step.
  std::vector<std::size_t> step(double dt) {
    kick(dt / 2);
    const auto v_half = v, w_half = w;
    for (std::size_t p = 0; p < r.size(); ++p) {
      r[p] += dt * v[p];
      q[p] = normalised(rotation_of(dt * w[p]) * q[p]);
    }
    const std::vector<double> used = loads(v_half, w_half);
    kick(dt / 2);
    std::vector<std::size_t> broken;
    for (std::size_t k = 0; k < bonds.size(); ++k) {
      if (bonds[k].broken || bonds[k].criterion == Criterion::none) continue;
      nearest = std::min(nearest, std::abs(used[k] - 1.0));
      if (used[k] >= 1.0) broken.push_back(k);
    }
    for (const std::size_t k : broken) bonds[k].broken = true;
    if (!broken.empty()) loads(v_half, w_half);
    return broken;
  }

 private:
  std::vector<Vec3d> F_, M_;
  void kick(double h) {
    for (std::size_t p = 0; p < r.size(); ++p) v[p] += h * F_[p], w[p] += (h / Theta) * M_[p];
  }
  /// Sums all loads; the utilisation of each bond.
  std::vector<double> loads(const std::vector<Vec3d>& v_at, const std::vector<Vec3d>& w_at) {
    F_.assign(r.size(), {}), M_.assign(r.size(), {});
    std::vector<double> used(bonds.size(), 0.0);
    for (std::size_t k = 0; k < bonds.size(); ++k) {
      const PlainBond& b = bonds[k];
      if (b.broken) continue;
      Vec3d n[3], m[3];  // of i and of j
      for (int x = 0; x < 3; ++x) n[x] = rotate(q[b.i], b.axes_i[x]), m[x] = rotate(q[b.j], b.axes_j[x]);
      const Vec3d D = r[b.j] - r[b.i] + b.R_j * m[0] - b.R_i * n[0];
      const double length = std::sqrt(dot(D, D)), N = axial_force(b.stretch, b.c[0], length - b.a);
      const Vec3d d = (1 / length) * D;
      auto [F, M_i, M_j] = testing::plain_loads({b.evm, b.a, b.c}, N, D, n, m);
      // M_i, M_j are without F's own arm
      used[k] = testing::plain_utilisation(b.criterion, b.limit, b.factor, b.c,
                                           testing::plain_section(d, F, M_i, M_j), length / b.a - 1);
      const Vec3d rate =
          v_at[b.j] - v_at[b.i] + b.R_j * cross(w_at[b.j], m[0]) - b.R_i * cross(w_at[b.i], n[0]);
      const Vec3d turn = w_at[b.j] - w_at[b.i];
      const Vec3d v_s = rate - dot(rate, d) * d - 0.5 * cross(w_at[b.i] + w_at[b.j], D);
      const Vec3d f = b.g[0] * dot(rate, d) * d + b.g[1] * v_s, h = 0.5 * cross(D, b.g[1] * v_s);
      const Vec3d couple = b.g[2] * (turn - dot(turn, d) * d) + b.g[3] * dot(turn, d) * d;
      F += f;
      F_[b.i] += F, F_[b.j] -= F;
      M_[b.i] += M_i + b.R_i * cross(n[0], F) + h + couple;
      M_[b.j] += M_j - b.R_j * cross(m[0], F) + h - couple;
    }
    return used;
  }
};

struct Body {
  Specimen specimen;
  OwnLoop own;
};

/// 2 to 30 particles of a grid, bonded to near neighbours at random, all kinds of bonds, moving and turning.
Body random_body(unsigned seed) {
  Dice dice(seed);
  const auto n = static_cast<std::size_t>(dice(2, 31));
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)
    r.push_back(
        Vec3d{static_cast<double>(k % 3), static_cast<double>(k / 3 % 3), static_cast<double>(k / 9)} +
        Vec3d{dice(-.1, .1), dice(-.1, .1), dice(-.1, .1)});
  Body body{testing::particles_at(r), {}};
  Specimen& s = body.specimen;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      if (norm(r[j] - r[i]) > 1.35 || (j > i + 1 && dice(0, 1) < 0.3)) continue;
      PlainBond b;
      b.i = i, b.j = j, b.evm = dice(0, 1) < 0.5;
      b.R_i = dice(0, 0.2), b.R_j = dice(0, 0.2);
      b.a = norm(r[j] - r[i]) - b.R_i - b.R_j;
      b.c = {dice(0.5, 2), dice(0.02, 0.5), dice(0.002, 0.1), dice(0.002, 0.1)};
      if (dice(0, 1) < 0.5) b.g = {dice(0, .2), dice(0, .02), dice(0, .01), dice(0, .001)};
      b.stretch.form = static_cast<StretchForm>(static_cast<int>(dice(0, 5)));
      b.stretch.k3 = dice(-1, 1), b.stretch.k4 = dice(0, 3), b.stretch.compression = dice(0.5, 3);
      b.stretch.largest = dice(0.5, 1), b.stretch.alpha = dice(0.5, 3);
      b.criterion = static_cast<Criterion>(static_cast<int>(dice(0, 8)));
      draw_limits(b.criterion, dice, b.limit);

      BondRecipe recipe;
      recipe.law = b.evm ? &bond_law<Evm> : &bond_law<VModel>;
      recipe.parameters = BondStiffness<double>{b.c[0], b.c[1], b.c[2], b.c[3]};
      recipe.attachment = Attachment::given;
      recipe.R_i = b.R_i, recipe.R_j = b.R_j;
      recipe.rules.stretch = b.stretch, recipe.rules.strength = strength_of(b.criterion, b.limit);
      recipe.damping = {DampingBy::coefficients, b.g};
      if (dice(0, 1) < 0.5) recipe.weibull = {dice(3, 12), 0, 0, seed};
      testing::bond(s, i, j, recipe);
      const Bond& made = s.state.bonds[BondId{s.state.bonds.size() - 1}];
      b.factor = 1.0 / (1.0 + made.coefficients[8]);
      const BondPose<double> pose = bond_pose(made, s.state);
      for (int k = 0; k < 3; ++k) b.axes_i[k] = pose.n_i[k], b.axes_j[k] = pose.n_j[k];
      body.own.bonds.push_back(b);
    }
  const double speed = dice(0.02, 0.15);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.v[p] = {dice(-speed, speed), dice(-speed, speed), dice(-speed, speed)};
    s.state.omega[p] = {dice(-speed, speed), dice(-speed, speed), dice(-speed, speed)};
  }
  body.own.r = s.state.r.values(), body.own.q = s.state.q.values();
  body.own.v = s.state.v.values(), body.own.w = s.state.omega.values();
  return body;
}

/// How many random bodies; more by VBOND_CAMPAIGN=1000.
unsigned cases_wanted() {
  const char* wanted = std::getenv("VBOND_CAMPAIGN");
  return wanted ? static_cast<unsigned>(std::atoi(wanted)) : 200;
}

// The same bonds break in the same steps, and the particles are where the other loop has them: rounding of
// 1e-16 grows in 200 steps of such motion to well below 1e-9. A utilisation within 1e-9 of 1 could fall on
// either side: such a case would be counted as undecided, and must be rare.
TEST(RuledBonds, MoveAndBreakAsByFormulasOfTheTestsOwn) {
  unsigned right = 0, wrong = 0, undecided = 0, aborted = 0;
  std::size_t breaks = 0;
  for (unsigned seed = 1; seed <= cases_wanted(); ++seed) {
    Body body = random_body(seed);
    if (body.own.bonds.empty()) {
      ++right;
      continue;
    }
    const double dt = 0.2 * step_bound(body.specimen.model, body.specimen.state).dt;
    bool same = true;
    try {
      Simulation run(body.specimen.model, testing::plain_stage(dt, 1e9), body.specimen.state);
      body.own.start();
      std::size_t seen = 0;
      for (int k = 0; k < 200 && same; ++k) {
        run.step();
        const std::vector<std::size_t> broken = body.own.step(dt);
        same = run.events().size() == seen + broken.size();
        for (std::size_t b = 0; same && b < broken.size(); ++b)
          same = run.events()[seen + b].bond == BondId{broken[b]};
        seen += broken.size(), breaks += broken.size();
      }
      const State& state = run.state();
      for (std::size_t p = 0; same && p < body.own.r.size(); ++p)
        same = norm(state.r[ParticleId{p}] - body.own.r[p]) < 1e-9;
    } catch (const std::exception& e) {
      ++aborted;
      ADD_FAILURE() << "seed " << seed << ": " << e.what();
      continue;
    }
    if (same)
      ++right;
    else if (body.own.nearest < 1e-9)
      ++undecided;
    else {
      ++wrong;
      ADD_FAILURE() << "seed " << seed;
    }
  }
  std::printf("%u right, %u wrong, %u undecided, %u aborted; %zu bonds broke\n", right, wrong, undecided,
              aborted, breaks);
  EXPECT_LE(undecided, 1 + cases_wanted() / 500);
  EXPECT_GT(breaks, cases_wanted());
}

// The loops work out the utilisation only of bonds whose bound is not below 1. Loads of these bonds are
// scaled until the criterion is reached exactly, or nearly so: there the bound must be past 1, and it must be
// of use far below.
TEST(RuledBonds, AreNearBreakingWhereverTheQuickBoundSaysThatTheyAreNot) {
  Dice dice(77);
  unsigned reached = 0, left_out = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    BondRules rules;
    testing::PlainLimits limits{1, 1, 1, 1};
    const auto criterion = static_cast<Criterion>(1 + trial % 7);
    draw_limits(criterion, dice, limits);
    rules.strength = strength_of(criterion, limits);
    if (trial % 2 == 0)
      rules.strength.compression = dice(0, 10), rules.strength.compression_bending = dice(0, 1e3);
    auto law = WithRules<VModel>::Law<double>::from({1.0, dice(0.02, 0.5), dice(0.002, 0.1), 0.01}, 1.0,
                                                    dice(0, .3), dice(0, .3));
    law.rules = &rules, law.weakness = dice(-0.5, 1);
    const auto vector = [&](double size) { return size * Vec3d{dice(-1, 1), dice(-1, 1), dice(-1, 1)}; };
    const Quatd q_i = rotation_of(vector(1.0)), q_j = rotation_of(vector(0.3)) * q_i;
    const BondFrames<double> frames{{1, 0, 0, 0}, {1, 0, 0, 0}};
    const Vec3d r_ij = rotate(q_i, Vec3d{1.0 + law.R_i + law.R_j, 0, 0}) + vector(0.1);
    const BondPose<double> pose = bond_pose(frames, r_ij, q_i, q_j);
    const BondAxis<double> axis = bond_axis(pose, law.R_i, law.R_j);
    const BondLoads<double> given{vector(dice(0, 1)), vector(dice(0, 0.1)), vector(dice(0, 0.1))};
    const auto scaled = [&](double x) {
      return BondLoads<double>{x * given.F, x * given.M_ij, x * given.M_ji};
    };
    double low = 0.0, high = 1.0;
    while (high < 1e6 && utilisation(law, pose, axis, scaled(high)) < 1.0) high *= 2.0;
    if (high >= 1e6) continue;  // in compression, or by its elongation
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (utilisation(law, pose, axis, scaled(middle)) < 1.0 ? low : high) = middle;
    }
    ++reached;
    EXPECT_GE(utilisation_bound(law, scaled(high)), 1.0) << "criterion " << static_cast<int>(criterion);
    left_out += utilisation_bound(law, scaled(0.2 * low)) < 1.0 ? 1 : 0;
  }
  EXPECT_GT(reached, 2000u);
  // at a fifth of these loads, a third was measured: `energy` has none, and random loads often press
  EXPECT_GT(left_out, reached / 4);
}

/// The same body, its particles numbered anew, its bonds in another order with their ends exchanged where
/// `swap` says so, and all of it turned.
Specimen renamed(const Specimen& s, const std::vector<std::size_t>& number, const Quatd& turn, Dice& dice) {
  Specimen to = s;
  for (const ParticleId p : s.state.r.ids()) {
    const ParticleId q{number[p.value]};
    to.state.r[q] = rotate(turn, s.state.r[p]);
    to.state.v[q] = rotate(turn, s.state.v[p]);
    to.state.omega[q] = rotate(turn, s.state.omega[p]);
    to.state.q[q] = turn * s.state.q[p];
  }
  to.model.r_0 = to.state.r;
  std::vector<Bond> bonds(s.state.bonds.begin(), s.state.bonds.end());
  for (std::size_t k = bonds.size(); k > 1; --k) {
    const auto other = static_cast<std::size_t>(dice(0, static_cast<double>(k)));
    std::swap(bonds[k - 1], bonds[other]);
  }
  to.state.bonds = {};
  for (Bond b : bonds) {
    b.i = ParticleId{number[b.i.value]}, b.j = ParticleId{number[b.j.value]};
    if (dice(0, 1) < 0.5) {               // by its own mirror: n_1 from the other end, n_2 as it was
      const Quatd half_turn{0, 0, 1, 0};  // about n_2
      std::swap(b.i, b.j), std::swap(b.R_i, b.R_j), std::swap(b.frame_i, b.frame_j);
      b.frame_i = b.frame_i * half_turn, b.frame_j = b.frame_j * half_turn;
    }
    to.state.bonds.push_back(b);
  }
  return to;
}

using StepAndPairs = std::vector<std::pair<std::int64_t, std::pair<std::size_t, std::size_t>>>;

/// Steps and pairs of all bonds that break in 200 steps; pairs by these numbers, smaller first, in order.
StepAndPairs breaks_of(const Specimen& s, double dt, const std::vector<std::size_t>& number) {
  Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
  for (int k = 0; k < 200; ++k) run.step();
  StepAndPairs breaks;
  for (const BondEvent& e : run.events()) {
    const Bond& b = s.state.bonds[e.bond];
    const std::size_t i = number[b.i.value], j = number[b.j.value];
    breaks.push_back({e.step, {std::min(i, j), std::max(i, j)}});
  }
  std::sort(breaks.begin(), breaks.end());
  return breaks;
}

// A case could fall on the other side of a limit by rounding; with these seeds none does.
TEST(RuledBonds, BreakAlikeHoweverTheBodyIsNumberedAndTurned) {
  std::size_t breaks = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Specimen s = random_body(seed).specimen;
    if (s.state.bonds.empty()) continue;
    Dice dice(seed + 1000);
    std::vector<std::size_t> same(s.model.particles()), number(s.model.particles()), back(number.size());
    for (std::size_t k = 0; k < same.size(); ++k) same[k] = number[k] = k;
    for (std::size_t k = number.size(); k > 1; --k)
      std::swap(number[k - 1], number[static_cast<std::size_t>(dice(0, static_cast<double>(k)))]);
    for (std::size_t k = 0; k < number.size(); ++k) back[number[k]] = k;
    const Quatd turn = rotation_of({dice(-2, 2), dice(-2, 2), dice(-2, 2)});
    const double dt = 0.2 * step_bound(s.model, s.state).dt;
    const StepAndPairs first = breaks_of(s, dt, same),
                       second = breaks_of(renamed(s, number, turn, dice), dt, back);
    EXPECT_EQ(first, second) << "seed " << seed;
    breaks += first.size();
  }
  EXPECT_GT(breaks, 100u);
}

}  // namespace
}  // namespace vbond::ruled_bonds_test
