// Random columns, blocks and panels, at rest, on their path, at their critical loads and swinging: by factors
// and by multigrid.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "campaigns/judge.hpp"
#include "multigrid/multigrid_bodies.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond {
namespace {

using testing::Dice;
using testing::fixed;
using testing::ids;
using testing::static_stage;
using testing::Tally;

struct Body {
  std::string name;
  testing::Specimen specimen;
  std::vector<Support> supports;
  std::vector<PointLoad> loads;
  bool free = false;  ///< modes without supports
};

PointLoad pushed(std::vector<ParticleId> particles, const Vec3d& force) {
  return {"pushed", std::move(particles), force, {}};
}

/// Clamped below, or on rollers of which three hold it in place; pressed from above.
void stand(Body& b, std::size_t bottom, Dice& dice) {
  const std::size_t n = b.specimen.model.particles();
  if (bottom > 4 && dice.chance(0.4))
    b.supports = {fixed(ids(0, 1), testing::clamped),
                  fixed(ids(1, bottom - 1), {false, false, true, false, false, false}),
                  fixed(ids(1, 1), {false, true, true, false, false, false})};
  else
    b.supports = {fixed(ids(0, bottom), testing::clamped)};
  if (dice.chance(0.5))  // a guide above
    b.supports.push_back(fixed(ids(n - bottom, bottom), {true, true, false, false, false, false}));
  b.loads = {pushed(ids(n - bottom, bottom), {0, 0, -1.0 / static_cast<double>(bottom)})};
}

/// A piece of a cylinder, its straight edges hinged, pushed in the middle.
Body panel(Dice& dice, const BondLaw* law) {
  const std::size_t along = dice.count(4, 9), around = dice.count(8, 16);
  const double radius = dice(12.0, 40.0);
  std::vector<Vec3d> r;
  for (std::size_t j = 0; j < around; ++j)
    for (std::size_t i = 0; i < along; ++i) {
      const double angle = (static_cast<double>(j) - 0.5 * static_cast<double>(around - 1)) / radius;
      r.push_back({static_cast<double>(i), radius * std::sin(angle), radius * std::cos(angle)});
    }
  Body b{"panel", testing::particles_at(r), {}, {}};
  BondRecipe recipe = testing::papers_bond(law);
  for (std::size_t k = 0; k < r.size(); ++k) {
    if (k % along + 1 < along) testing::bond(b.specimen, k, k + 1, recipe);
    if (k + along < r.size()) testing::bond(b.specimen, k, k + along, recipe);
    if (k % along + 1 < along && k + along < r.size()) testing::bond(b.specimen, k, k + along + 1, recipe);
  }
  const HeldDofs hinge{true, true, true, false, true, true};
  b.supports = {fixed(ids(0, along), hinge), fixed(ids(r.size() - along, along), hinge)};
  b.loads = {pushed({ParticleId{around / 2 * along + along / 2}}, {0, 0, -0.01})};
  return b;
}

Body random_body(unsigned seed) {
  Dice dice(seed);
  const BondLaw* law = dice.chance(0.5) ? &bond_law<Evm> : &bond_law<VModel>;
  const std::size_t kind = dice.count(0, 2);
  Body b;
  if (kind == 0) {
    const std::size_t nx = dice.count(1, 3), ny = dice.count(1, 3), nz = dice.count(20, 40);
    b = {"column", testing::lattice_of(nx, ny, nz, law), {}, {}};
    stand(b, nx * ny, dice);
  } else if (kind == 1) {
    const std::size_t nx = dice.count(3, 6), ny = dice.count(3, 6), nz = dice.count(4, 9);
    b = {"block", testing::lattice_of(nx, ny, nz, law), {}, {}};
    stand(b, nx * ny, dice);
  } else {
    b = panel(dice, law);
  }
  b.free = dice.chance(0.3);
  b.name += fmt::format(" {} of {}{}", seed, b.specimen.model.particles(), b.free ? ", free" : "");
  return b;
}

struct Ran {
  std::optional<StaticOutcome> outcome;
  std::string why;
};

Ran run_by(LinearSolver solver, const Body& b, StaticStage stage) {
  stage.newton.solver = solver;
  try {
    return {run_static_stage(b.specimen.model, stage, b.specimen.state, {}), {}};
  } catch (const NoEquilibrium& e) {
    return {{}, e.what()};
  }
}

bool near(double a, double b, double scale) {
  return std::abs(a - b) <= 1e-8 * scale;
}

double distance(const State& a, const State& b) {
  double most = 0.0;
  for (const ParticleId p : a.r.ids()) most = std::max(most, norm(a.r[p] - b.r[p]));
  return most;
}

/// Empty, or what differs; found are the values of the factors' result.
std::string difference(const Body& body, const StaticStage& stage, const StaticOutcome& direct,
                       const StaticOutcome& multigrid, bool& missed) {
  const StaticResult &a = direct.result, &b = multigrid.result;
  const auto compare = [&](const char* what, const std::vector<double>& x,
                           const std::vector<double>& y) -> std::string {
    if (y.size() < x.size()) missed = true;
    if (x.size() != y.size()) return fmt::format("{} {}, not {}", y.size(), what, x.size());
    for (std::size_t k = 0; k < x.size(); ++k)
      if (!near(x[k], y[k], std::abs(x[k])))
        return fmt::format("{} {}: {:.12g}, not {:.12g}", what, k + 1, y[k], x[k]);
    return {};
  };
  std::vector<double> x, y;
  switch (stage.kind) {
    case StageKind::modes:
      for (const NaturalMode& m : a.modes) x.push_back(m.omega2);
      for (const NaturalMode& m : b.modes) y.push_back(m.omega2);
      return compare("modes", x, y);
    case StageKind::buckling:
      for (const CriticalLoad& c : a.critical_loads) x.push_back(c.load_factor);
      for (const CriticalLoad& c : b.critical_loads) y.push_back(c.load_factor);
      return compare("critical loads", x, y);
    case StageKind::path:
      for (const SpecialPoint& p : a.special_points) x.push_back(p.load_factor);
      for (const SpecialPoint& p : b.special_points) y.push_back(p.load_factor);
      if (const std::string text = compare("special points", x, y); !text.empty()) return text;
      if (a.ended != b.ended) return fmt::format("ended by {}, not {}", b.ended, a.ended);
      if (a.ended != "load factor") return {};
      break;
    default: break;
  }
  if (a.unstable != b.unstable)
    return fmt::format("{} unstable, not {}", b.unstable.value_or(-1), a.unstable.value_or(-1));
  if (a.left_saddle || a.neutral) {  // it may have gone to another of several sides that are alike
    const auto energy = [&](const StaticOutcome& o) {
      return StaticBody(body.specimen.model, stage, o.state, 1.0).energies().total();
    };
    const double off = std::abs(energy(multigrid) / energy(direct) - 1.0);
    return off <= 1e-8 ? "" : fmt::format("energies {:.2g} apart", off);
  }
  const double off = distance(direct.state, multigrid.state);
  return off <= 1e-8 ? "" : fmt::format("states {:.2g} apart", off);
}

/// Whether the search for critical loads, by factors, finds the special points of a path by multigrid. Where
/// an eigenvalue is zero to rounding at a point looked at, a path by factors may have it at the point before.
bool confirmed(const Body& b, StaticStage stage, const StaticOutcome& path) {
  if (stage.kind != StageKind::path) return false;
  stage.kind = StageKind::buckling;
  stage.count = static_cast<int>(path.result.special_points.size());
  const Ran search = run_by(LinearSolver::direct, b, stage);
  if (!search.outcome || static_cast<int>(search.outcome->result.critical_loads.size()) != stage.count)
    return false;
  for (std::size_t k = 0; k < path.result.special_points.size(); ++k) {
    const double f = path.result.special_points[k].load_factor;
    if (!near(search.outcome->result.critical_loads[k].load_factor, f, f)) return false;
  }
  return true;
}

void compare(const Body& b, const StaticStage& stage, const std::string& kind, Tally& all) {
  const Ran direct = run_by(LinearSolver::direct, b, stage),
            multigrid = run_by(LinearSolver::multigrid, b, stage);
  if (!direct.outcome) {
    all.add("refused by both");
    return;
  }
  if (!multigrid.outcome) {
    ADD_FAILURE() << b.name << ", " << kind << ": given up: " << multigrid.why;
    return;
  }
  EXPECT_EQ(multigrid.outcome->result.solver, "multigrid");
  bool missed = false;
  const std::string text = difference(b, stage, *direct.outcome, *multigrid.outcome, missed);
  const bool same = text.empty() || confirmed(b, stage, *multigrid.outcome);
  EXPECT_TRUE(same) << b.name << ", " << kind << (missed ? ": missed: " : ": ") << text;
  all.add(kind + " the same", same);
  if (same && !text.empty()) all.add("confirmed by the search");
}

void judge(unsigned seed, Tally& all) {
  const Body b = random_body(seed);
  StaticStage modes = static_stage(StageKind::modes, b.free ? std::vector<Support>{} : b.supports);
  modes.count = 5;
  compare(b, modes, "modes", all);

  StaticStage buckling = static_stage(StageKind::buckling, b.supports, b.loads);
  buckling.count = 2;
  buckling.path.most_points = 30;
  compare(b, buckling, "buckling", all);

  StaticStage path = static_stage(StageKind::path, b.supports, b.loads);
  path.path.most_points = 25;
  path.path.above = 0.05;
  compare(b, path, "path", all);

  StaticStage rest = static_stage(StageKind::equilibrium, b.supports, b.loads);
  for (PointLoad& l : rest.loads) l.force = 0.003 * l.force + Vec3d{2e-4, 1e-4, 0};
  compare(b, rest, "equilibrium", all);
}

TEST(MultigridCampaign, FindsWhatFactorsFind) {
  const Tally all = testing::campaign("multigrid", 6, judge);
  EXPECT_LT(all.sum("refused by both"), 4 * all.cases);
}

}  // namespace
}  // namespace vbond
