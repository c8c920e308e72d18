// Random periodic bodies that a stage has strained and stressed, against an evaluation of its own: bonds join
// particles and copies, which stand whole edges away; forces, moments and stress are differences of the sum
// of their energies.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "periodic.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::cell_campaign_test {
namespace {

using namespace testing;

struct Random {
  Specimen s;
  StaticStage stage;
};

/// Two to twelve particles in a tilted cell, each bonded to all that are near, of either law; one is bonded
/// to an image of its own far away.
Random random_case(unsigned seed) {
  Dice dice(seed);
  const std::size_t n = dice.count(2, 12);
  const double side = 1.2 * std::cbrt(static_cast<double>(n));
  Edges edges = cube(side);
  for (Vec3d& e : edges) e += dice.vector(0.2 * side);
  std::vector<Vec3d> r;
  for (std::size_t tries = 0; r.size() < n && tries < 10000; ++tries) {
    const Vec3d x = dice(0, 1) * edges[0] + dice(0, 1) * edges[1] + dice(0, 1) * edges[2];
    r.push_back(x);
    bool apart = true;
    const Specimen so_far = periodic_body(edges, r);
    for_near_images(so_far.state.cell, {true, true, true}, r, 0.5,
                    [&](std::size_t, std::size_t, const Image&, double) { apart = false; });
    if (!apart) r.pop_back();
  }
  for (Vec3d& x : r) x += double(dice.whole(-2, 2)) * edges[0] + double(dice.whole(-2, 2)) * edges[2];
  Random c{periodic_body(edges, r), {}};
  c.s.model.cell.triangular = dice.chance(0.5);
  for (Quatd& q : c.s.state.q) q = dice.rotation(3.0);
  BondRecipe recipe;
  recipe.law = dice.chance(0.5) ? &bond_law<VModel> : &bond_law<Evm>;
  recipe.parameters = BondStiffness<double>{1.0, dice(0.2, 0.6), dice(0.05, 0.1), dice(0.02, 0.1)};
  bond_within(c.s, 1.7, recipe);
  bond_image(c.s, 0, 0, {1, 0, -1}, recipe);
  std::array<CellComponent, 6> drive{};
  for (CellComponent& k : drive) {
    const double x = dice(0.0, 1.0);
    if (x < 0.35) k = strained(dice(-0.05, 0.05));
    if (x > 0.5) k = stressed(dice(-0.03, 0.03));
  }
  if (!std::any_of(drive.begin(), drive.end(), [](const auto& k) { return k.by != CellComponent::By::held; }))
    drive[0] = strained(0.03);
  c.stage = cell_stage(drive, 2);
  return c;
}

/// Energy of bonds from places alone: no cell, no image but copies.
class Copies {
 public:
  explicit Copies(const State& at) : at_(at) {}
  /// With a particle and its copies shifted, turned, and all strained by F -> (1 + L) F.
  double energy(std::size_t p = 0, const Vec3d& shift = {}, const Vec3d& turn = {},
                const Tensor& L = {}) const {
    double U = 0.0;
    for (const Bond& b : at_.bonds) {
      const Vec3d i = copy(b.i.value, {}, p, shift, L), j = copy(b.j.value, image_of_j(b), p, shift, L);
      const auto turned = [&](ParticleId q) {
        return q.value == p ? rotation_of(turn) * at_.q[q] : at_.q[q];
      };
      const BondEnergy<double> e = b.law->energy(b, bond_pose(b, j - i, turned(b.i), turned(b.j)), {});
      U += e.U_L + e.U_B + e.U_T;
    }
    return U;
  }

 private:
  Vec3d copy(std::size_t q, const Image& n, std::size_t p, const Vec3d& shift, const Tensor& L) const {
    Vec3d r = at_.r[ParticleId{q}];
    for (const auto& [times_edge, edge] : {std::pair{n.a, 0u}, {n.b, 1u}, {n.c, 2u}})
      for (int k = 0; k < std::abs(times_edge); ++k)
        r += (times_edge > 0 ? 1.0 : -1.0) * at_.cell[edge].along;
    if (q == p) r += shift;
    return r + times(L, r);
  }
  const State& at_;
};

TEST(PeriodicCellCampaign, RandomBodiesAreInBalanceUnderWhatWasWanted) {
  constexpr double h = 1e-4, close = 3e-7;  // h^2 of third derivatives
  const Tally all = campaign("periodic cells at rest", 200, [&](unsigned seed, Tally& tally) -> Verdict {
    const Random c = random_case(seed);
    const StaticOutcome out = run_static_stage(c.s.model, c.stage, c.s.state, {});
    const Copies body(out.state);
    double worst = 0.0;
    for (std::size_t p = 0; p < c.s.model.particles(); ++p)
      for (const Vec3d& e : {Vec3d{h, 0, 0}, Vec3d{0, h, 0}, Vec3d{0, 0, h}}) {
        worst = std::max(worst, std::abs(body.energy(p, e) - body.energy(p, -e)) / (2 * h));
        worst = std::max(worst, std::abs(body.energy(p, {}, e) - body.energy(p, {}, -e)) / (2 * h));
      }
    tally.below("force or moment", worst, close);
    const double V = volume(out.state.cell);
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [a, b] = cell_component_axes[k];
      Tensor L;
      component(L.row[static_cast<std::size_t>(a)], b) += 0.5 * h;
      component(L.row[static_cast<std::size_t>(b)], a) += 0.5 * h;
      const double stress = (body.energy(0, {}, {}, L) - body.energy(0, {}, {}, -1.0 * L)) / (2 * h * V);
      const CellComponent& wanted = c.stage.cell.component[k];
      if (wanted.by == CellComponent::By::stress)
        tally.below("stress", std::abs(stress - wanted.value), close);
      else
        tally.below("strain", std::abs(cell_strain(c.s, out.state)[k] - (k < 3 ? 1.0 : 0.0) - wanted.value),
                    1e-14);
      tally.below("stress told", std::abs(stress - stress_of(c.s, out.state)[k]), close);
    }
    return out.result.jumped ? Verdict{"right, after a jump"} : Verdict{};
  });
  EXPECT_LE(20 * all["given up"], all.full ? all.cases : 20 * all.cases);
}

}  // namespace
}  // namespace vbond::cell_campaign_test
