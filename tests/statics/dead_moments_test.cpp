// Rods and frames in space under moments and forces of fixed direction, which have no potential together,
// against a plain load stepping that shares nothing with statics but the loads of a bond: it differences
// them, and solves with all unknowns at once.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "campaigns/bodies.hpp"
#include "campaigns/judge.hpp"
#include "statics/bodies.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/physics/laws.hpp"
#include "vbond/statics/detail/dense.hpp"

namespace vbond::dead_moments_test {
namespace {

using testing::Dice;
using testing::Specimen;

struct Loaded {
  Specimen s;
  StaticStage stage;
};

BondRecipe drawn_recipe(Dice& dice) {
  BondRecipe recipe;
  recipe.law = dice.chance(0.5) ? &bond_law<VModel> : &bond_law<Evm>;
  const double c_B = std::pow(10.0, dice(-2.5, -1.0));
  recipe.parameters =
      BondStiffness<double>{1.0, dice(0.3, 1.0) * std::min(1.0, 12.0 * c_B), c_B, dice(0.5, 2.0) * c_B};
  return recipe;
}

/// A line with random kinks, of which every third is straight.
Specimen drawn_rod(Dice& dice, std::size_t n) {
  const double kink = dice.chance(0.33) ? 0.0 : dice(0.0, 0.8);
  std::vector<Vec3d> r{{}};
  Vec3d e{1, 0, 0};
  while (r.size() < n) {
    r.push_back(r.back() + e);
    e = normalised(e + kink * dice.direction());
  }
  Specimen s = testing::particles_at(r);
  const BondRecipe recipe = drawn_recipe(dice);
  for (std::size_t k = 0; k + 1 < n; ++k) testing::bond(s, k, k + 1, recipe);
  return s;
}

/// Random places, each bonded to the nearest before it and to some others: trees with loops.
Specimen drawn_frame(Dice& dice, std::size_t n) {
  std::vector<Vec3d> r{{}};
  while (r.size() < n) {
    const Vec3d p = r[dice.below(r.size())] + dice(0.9, 1.2) * dice.direction();
    if (std::all_of(r.begin(), r.end(), [&](const Vec3d& q) { return norm(p - q) > 0.8; })) r.push_back(p);
  }
  Specimen s = testing::particles_at(r);
  const BondRecipe recipe = drawn_recipe(dice);
  for (std::size_t j = 1; j < n; ++j) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < j; ++i)
      if (norm(r[i] - r[j]) < norm(r[nearest] - r[j])) nearest = i;
    for (std::size_t i = 0; i < j; ++i)
      if (i == nearest || (norm(r[i] - r[j]) < 1.4 && dice.chance(0.3))) testing::bond(s, i, j, recipe);
  }
  return s;
}

/// Clamped at the first particle; a moment and a force at the last one, and of every other body a second
/// pair. They would turn a rod of these bonds by some radians.
Loaded drawn_case(unsigned seed) {
  Dice dice(seed);
  const bool rod = dice.chance(0.6);
  const std::size_t n = dice.count(4, rod ? 20 : 12);
  Loaded c{rod ? drawn_rod(dice, n) : drawn_frame(dice, n), {}};
  const Bond& b = c.s.state.bonds[BondId{0}];
  const double c_B = b.law->stiffness(b).c_B, length = rod ? static_cast<double>(n - 1) : 3.0;
  std::vector<PointLoad> loads;
  for (const std::size_t at : {n - 1, n / 2}) {
    const Vec3d moment = dice(0.2, 4.0) * c_B / length * dice.direction(),
                force = dice(0.0, 3.0) * c_B / (length * length) * dice.direction();
    loads.push_back(testing::pushed(at, force, moment));
    if (dice.chance(0.5)) break;
  }
  c.stage = testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)},
                                  std::move(loads));
  return c;
}

/// The same, and far off a grain that touches a wall of one particle: it keeps its place and may turn.
Loaded beside_a_grain(const Loaded& alone) {
  std::vector<Vec3d> r(alone.s.model.r_0.begin(), alone.s.model.r_0.end());
  const ParticleId wall{r.size()}, grain{r.size() + 1};
  r.push_back({0, 0, 100});
  r.push_back({0, 0, 100.7});
  Loaded c{testing::particles_at(r), alone.stage};
  c.s.model.contact = alone.s.model.contact;
  c.s.state.bonds = alone.s.state.bonds;
  c.stage.supports.push_back(testing::fixed({wall}, testing::clamped));
  c.stage.supports.push_back(testing::fixed({grain}, {true, true, true, false, false, false}));
  return c;
}

/// Plain Newton steps at growing load, by central differences of the loads of each bond.
class PlainStepping {
 public:
  explicit PlainStepping(const Loaded& c) : c_(c), s_(c.s.state), n_(6 * (c.s.model.particles() - 1)) {}

  /// The end of the way, or nothing where no balance is found in steps down to 1e-6.
  std::optional<State> run(int steps) {
    double f = 0.0, step = 1.0 / steps;
    while (f < 1.0) {
      const State from = s_;
      const double to = std::min(1.0, f + step);
      move((to - f) * solve_dense(tangent(), applied(1.0)));
      if (correct(to)) {
        f = to;
        step = std::min(1.0 / steps, 2.0 * step);
        continue;
      }
      s_ = from;
      step *= 0.5;
      if (step < 1e-6) return std::nullopt;
    }
    return s_;
  }

 private:
  using Dense = Eigen::MatrixXd;
  using Column = Eigen::VectorXd;

  static Eigen::Index row(ParticleId p) { return 6 * (static_cast<Eigen::Index>(p.value) - 1); }

  void move_dof(ParticleId p, int dof, double by) {
    Vec3d way;
    component(way, dof % 3) = by;
    if (dof < 3)
      s_.r[p] += way;
    else
      s_.q[p] = rotation_of(way) * s_.q[p];
  }

  void move(const Column& x) {
    for (const ParticleId p : s_.r.ids())
      if (p.value > 0) {
        const auto x_p = x.segment(row(p), 6);
        s_.r[p] += {x_p[0], x_p[1], x_p[2]};
        s_.q[p] = normalised(rotation_of(Vec3d{x_p[3], x_p[4], x_p[5]}) * s_.q[p]);
      }
  }

  Column applied(double f) const {
    Column g = Column::Zero(n_);
    for (const PointLoad& l : c_.stage.loads)
      for (int k = 0; k < 3; ++k) {
        g[row(l.particles[0]) + k] += f * component(l.force, k);
        g[row(l.particles[0]) + 3 + k] += f * component(l.moment, k);
      }
    return g;
  }

  Eigen::Matrix<double, 12, 1> loads_of(BondId k) const {
    const BondLoads<double> l = bond_loads(s_, k);
    Eigen::Matrix<double, 12, 1> g;
    g << l.F.x, l.F.y, l.F.z, l.M_ij.x, l.M_ij.y, l.M_ij.z, -l.F.x, -l.F.y, -l.F.z, l.M_ji.x, l.M_ji.y,
        l.M_ji.z;
    return g;
  }

  Dense tangent() {
    constexpr double h = 1e-5;
    Dense K = Dense::Zero(n_, n_);
    for (const BondId k : s_.bonds.ids()) {
      const ParticleId ends[2] = {s_.bonds[k].i, s_.bonds[k].j};
      for (int dof = 0; dof < 12; ++dof) {
        const ParticleId p = ends[dof / 6];
        if (p.value == 0) continue;
        const Vec3d r = s_.r[p];
        const Quatd q = s_.q[p];
        move_dof(p, dof % 6, h);
        const auto after = loads_of(k);
        s_.r[p] = r, s_.q[p] = q;
        move_dof(p, dof % 6, -h);
        const Eigen::Matrix<double, 12, 1> slope = (after - loads_of(k)) / (2.0 * h);
        s_.r[p] = r, s_.q[p] = q;
        for (int end = 0; end < 2; ++end)
          if (ends[end].value > 0)
            K.block(row(ends[end]), row(p) + dof % 6, 6, 1) -= slope.segment(6 * end, 6);
      }
    }
    return K;
  }

  /// False if it takes more than six corrections, or one of more than 0.1.
  bool correct(double f) {
    for (int k = 0; k < 6; ++k) {
      Column g = applied(f);
      for (const BondId b : s_.bonds.ids()) {
        const auto l = loads_of(b);
        if (s_.bonds[b].i.value > 0) g.segment(row(s_.bonds[b].i), 6) += l.head(6);
        if (s_.bonds[b].j.value > 0) g.segment(row(s_.bonds[b].j), 6) += l.tail(6);
      }
      const Column x = solve_dense(tangent(), g);
      const double largest = x.cwiseAbs().maxCoeff();
      if (!(largest < 0.1)) return false;
      move(x);
      if (largest < 1e-8) return true;  // the next would be 1e-8 of it, and rounding
    }
    return false;
  }

  const Loaded& c_;
  State s_;
  Eigen::Index n_;
};

using testing::distance_between;

// Corrections end at 1e-10 of the largest force: some 1e-7 of places in bodies as soft as these.
TEST(DeadMoments, LeadToTheBalanceOfAPlainLoadSteppingWhateverTheSteps) {
  const testing::Tally all = testing::campaign("dead moments", 25, [](unsigned seed) -> testing::Verdict {
    const Loaded c = drawn_case(seed);
    const std::optional<State> coarse = PlainStepping(c).run(60), fine = PlainStepping(c).run(150);
    if (!coarse && !fine) return {"without a way at growing load"};
    if (!coarse || !fine || distance_between(*coarse, *fine) > 1e-7) return {"of unsure reference"};
    for (const int steps : {1, 5, 23, 0}) {
      StaticStage stage = c.stage;
      if (steps > 0) stage.steps = steps;
      if (steps == 0) stage.kind = StageKind::path, stage.path.first_step = 0.05, stage.path.above = 1.0;
      const std::string which = steps == 0 ? "path" : "steps " + std::to_string(steps);
      try {
        const StaticOutcome w = run_static_stage(c.s.model, stage, c.s.state, {});
        const double off = distance_between(w.state, *fine);
        if (!(off < 1e-5) || w.result.load_factor != 1.0)
          return testing::wrong(which + ": off by " + std::to_string(off) +
                                (w.result.jumped ? ", told" : ""));
      } catch (const NoEquilibrium& e) {
        return testing::wrong(which + ": " + e.what());
      }
    }
    return {};
  });
  EXPECT_GE(all["right"], all.full ? all.cases / 2 : 0);
}

// A second stage that names no loads lets the body go back: on the way it is as if the loads stayed, and
// their opposites grew.
TEST(DeadMoments, FadeAsTheyGrew) {
  const testing::Tally all =
      testing::campaign("dead moments that fade", 25, [](unsigned seed) -> testing::Verdict {
        Loaded c = drawn_case(seed);
        c.stage.steps = 5;
        State loaded;
        const auto back = [&](std::vector<PointLoad> loads) -> std::optional<double> {
          StaticStage second = c.stage;
          second.loads = std::move(loads);
          try {
            return distance_between(run_static_stage(c.s.model, second, loaded, {}).state, c.s.state);
          } catch (const NoEquilibrium&) {
            return std::nullopt;
          }
        };
        try {
          loaded = run_static_stage(c.s.model, c.stage, c.s.state, {}).state;
        } catch (const NoEquilibrium&) {
          return {"not loaded"};
        }
        std::vector<PointLoad> both = c.stage.loads;
        for (PointLoad& l : both) l.constant = true;
        for (PointLoad l : c.stage.loads) {
          l.force = -1.0 * l.force, l.moment = -1.0 * l.moment;
          both.push_back(l);
        }
        const std::optional<double> faded = back({}), taken = back(both);
        if (!taken || !(*taken < 1e-6)) return {"elsewhere by its opposites, too"};
        if (!faded) return testing::wrong("no balance");
        if (!(*faded < 1e-6)) return testing::wrong("off by " + std::to_string(*faded));
        return {};
      });
  EXPECT_GE(all["right"], all.full ? all.cases / 2 : 0);
}

// A grain that may turn freely, as one that has come off and is touched at a point, meets no stiffness: the
// tangent is singular with it. It changes neither the balance nor how many load steps lead there.
TEST(DeadMoments, LeadToTheSameBalanceBesideAGrainThatTurnsFreely) {
  const testing::Tally all =
      testing::campaign("moments beside a grain", 25, [](unsigned seed) -> testing::Verdict {
        Loaded alone = drawn_case(seed);
        alone.s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::all};
        alone.s.model.contact.k = 1e-3;
        const Loaded beside = beside_a_grain(alone);
        StaticOutcome without;
        try {
          without = run_static_stage(alone.s.model, alone.stage, alone.s.state, {});
        } catch (const NoEquilibrium&) {
          return {"not loaded"};
        }
        const StaticOutcome with = run_static_stage(beside.s.model, beside.stage, beside.s.state, {});
        double off = 0.0;
        for (const ParticleId p : alone.s.state.r.ids())
          off = std::max(off, norm(with.state.r[p] - without.state.r[p]));
        if (!(off < 1e-5)) return testing::wrong("off by " + std::to_string(off));
        if (with.result.points > 4 * without.result.points)
          return testing::wrong(std::to_string(with.result.points) + " load steps");
        return {};
      });
  EXPECT_GE(all["right"], all.full ? all.cases / 2 : 0);
}

/// A cantilever of twelve bonds, EI = 100 and EA = 1e4, that a moment of 50 about z rolls up while a force of
/// 3 pulls it across the plane.
Loaded rolled_cantilever() {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= 12; ++k) r.push_back({0.8333333333 * static_cast<double>(k), 0, 0});
  Loaded c{testing::particles_at(r, 0.02), {}};
  BondRecipe recipe;
  recipe.law = &bond_law<Evm>;
  recipe.parameters = TheoryParameters{BondTheory::timoshenko, {1e4, 0.0}, {1.0, 0.01, 0.02}, 2.0};
  for (std::size_t k = 0; k < 12; ++k) testing::bond(c.s, k, k + 1, recipe);
  c.stage = testing::static_stage(StageKind::equilibrium, {testing::fixed({ParticleId{0}}, testing::clamped)},
                                  {testing::pushed(12, {0, 0, 3}, {0, 0, 50})});
  return c;
}

// The symmetric part of its tangent becomes singular on the way, where nothing happens to the body.
TEST(DeadMoments, AreCarriedWhateverTheNumberOfSteps) {
  Loaded c = rolled_cantilever();
  const std::optional<State> right = PlainStepping(c).run(200);
  ASSERT_TRUE(right);
  EXPECT_NEAR(right->r[ParticleId{12}].x - 10.0, -11.969, 1e-3);
  for (const int steps : {1, 2, 10, 15, 20, 25, 40, 50, 100, 150, 200}) {
    c.stage.steps = steps;
    const StaticOutcome w = run_static_stage(c.s.model, c.stage, c.s.state, {});
    EXPECT_FALSE(w.result.jumped) << steps;
    EXPECT_LT(distance_between(w.state, *right), 1e-7) << steps;
  }
  for (const double largest : {0.0, 0.5, 2.0}) {
    c.stage.kind = StageKind::path;
    c.stage.path.largest_step = largest;
    c.stage.path.above = 1.0;
    EXPECT_LT(distance_between(run_static_stage(c.s.model, c.stage, c.s.state, {}).state, *right), 1e-7)
        << largest;
  }
}

}  // namespace
}  // namespace vbond::dead_moments_test
