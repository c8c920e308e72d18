// Random periodic bodies of 1 to 40 particles in any cell, with bonds and contacts through its faces, judged
// by a sum over explicit copies of all particles, which knows nothing of images, rows or neighbour lists.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "vbond/core/images.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/periodic_cell.hpp"

namespace vbond::cell_campaign_test {
namespace {

using testing::Dice;
using testing::Tally;
using testing::Verdict;

struct Body {
  Model model;
  State state;
};

/// Any cell with a volume, right-handed: edges of different lengths, tilted up to half their lengths.
CellShape any_cell(Dice& dice, double size) {
  CellShape cell;
  while (true) {
    const double a = size * dice(0.6, 1.6), b = size * dice(0.6, 1.6), c = size * dice(0.6, 1.6);
    cell.edges = {Vec3d{a, 0, 0}, {dice(-0.5, 0.5) * a, b, 0}, {dice(-0.5, 0.5) * a, dice(-0.5, 0.5) * b, c}};
    const Quatd turn = dice.rotation(3.0);
    for (Vec3d& edge : cell.edges) edge = rotate(turn, edge);
    const double V = dot(cell.edges[0], cross(cell.edges[1], cell.edges[2]));
    if (V > 0.2 * a * b * c) break;
  }
  cell.periodic = {true, true, true};
  cell.triangular = dice.chance(0.5);
  return cell;
}

Body any_body(Dice& dice) {
  const std::size_t n = dice.log_count(1, 40);
  const double size = std::cbrt(static_cast<double>(n)) * dice(0.9, 1.5);
  CellShape cell = any_cell(dice, size);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k)  // some cells away, too
    r.push_back(dice(-1, 2) * cell.edges[0] + dice(-1, 2) * cell.edges[1] + dice(-1, 2) * cell.edges[2]);
  Body b{equal_particles(r, 1.0, 0.1, 0.5), {}};
  for (double& R : b.model.radius) R = dice(0.3, 0.6);
  b.model.cell = cell;
  b.state = at_rest(b.model);
  BondRecipe recipe;
  recipe.law = find_law(dice.chance(0.5) ? "v-model" : "evm");
  recipe.parameters = BondStiffness<double>{1.0, dice(0.1, 0.5), dice(0.05, 0.2), dice(0.02, 0.1)};
  const double reach = dice(0.7, 1.3);
  for_near_images(b.state.cell, cell.periodic, b.state.r.values(), reach,
                  [&](std::size_t i, std::size_t j, const Image& image, double d2) {
                    if (d2 < 0.09 || dice.chance(0.3)) return;
                    b.state.bonds.push_back(*make_bond(recipe, bond_site(b.model, b.state, ParticleId{i}),
                                                       bond_site(b.model, b.state, ParticleId{j}, image)));
                    if (dice.chance(0.5)) return;  // the same bond, seen from its other end
                    Bond& bond = b.state.bonds[BondId{b.state.bonds.size() - 1}];
                    bond = *make_bond(recipe, bond_site(b.model, b.state, ParticleId{j}, image),
                                      bond_site(b.model, b.state, ParticleId{i}));
                  });
  if (dice.chance(0.7)) {
    b.model.contact.law = ContactLaw::hertz;
    b.model.contact.pairs = dice.chance(0.5) ? ContactPairs::unbonded : ContactPairs::all;
    b.model.contact.E = dice(0.5, 5.0), b.model.contact.nu = 0.25;
  }
  for (const ParticleId p : b.state.r.ids()) {
    b.state.r[p] += dice.vector(0.05);
    b.state.q[p] = dice.rotation(0.2);
    b.state.v[p] = dice.vector(0.05);
  }
  return b;
}

/// What copies of the body do to it.
struct Plain {
  std::vector<Vec3d> F, M;
  double energy = 0;
  Tensor force_times_r;
};

/// Every particle against every copy in a block of copies that is wider than any bond or contact reaches.
Plain by_copies(const Model& model, const State& s) {
  const std::size_t n = model.particles();
  Plain sum{std::vector<Vec3d>(n), std::vector<Vec3d>(n), 0.0, {}};
  const auto place = [&](std::size_t j, int a, int b, int c) {
    return s.r[ParticleId{j}] + double(a) * s.cell[0].along + double(b) * s.cell[1].along +
           double(c) * s.cell[2].along;
  };
  const auto add = [&](std::size_t i, std::size_t j, const Vec3d& F, const Vec3d& r_ij) {
    sum.F[i] += F, sum.F[j] -= F;
    sum.force_times_r += dyad(F, r_ij);
  };
  for (const Bond& b : s.bonds) {
    const Vec3d r_ij = place(b.j.value, image_of_j(b).a, image_of_j(b).b, image_of_j(b).c) - s.r[b.i];
    const BondPose<double> pose = bond_pose(b, r_ij, s.q[b.i], s.q[b.j]);
    const BondLoads<double> l = b.law->loads(b, pose, no_history);
    const BondEnergy<double> u = b.law->energy(b, pose, no_history);
    sum.energy += u.U_L + u.U_B + u.U_T;
    add(b.i.value, b.j.value, l.F, r_ij);
    sum.M[b.i.value] += l.M_ij, sum.M[b.j.value] += l.M_ji;
  }
  if (model.contact.law == ContactLaw::none) return sum;
  const double E_star = model.contact.E / (2.0 * (1.0 - model.contact.nu * model.contact.nu));
  const auto is_bonded = [&](std::size_t i, std::size_t j, int a, int b, int c) {
    const auto joins = [&](const Bond& bond) {
      const Image& to = image_of_j(bond);
      return (bond.i.value == i && bond.j.value == j && to.a == a && to.b == b && to.c == c) ||
             (bond.i.value == j && bond.j.value == i && to.a == -a && to.b == -b && to.c == -c);
    };
    return std::any_of(s.bonds.begin(), s.bonds.end(), joins);
  };
  // particles are up to three cells apart, and a contact, which is below 1.3 long, may be wider than a cell
  const Vec3d &A = s.cell[0].along, &B = s.cell[1].along, &C = s.cell[2].along;
  const double widest = std::max({norm(cross(A, B)), norm(cross(B, C)), norm(cross(C, A))});
  const int copies = 4 + static_cast<int>(1.3 * widest / std::abs(dot(A, cross(B, C))));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j)
      for (int a = -copies; a <= copies; ++a)
        for (int b = -copies; b <= copies; ++b)
          for (int c = -copies; c <= copies; ++c) {
            const bool first = a > 0 || (a == 0 && (b > 0 || (b == 0 && c > 0)));
            if (i == j && !first) continue;  // each pair of a particle and its own copy once
            const Vec3d r_ij = place(j, a, b, c) - s.r[ParticleId{i}];
            const double R_i = model.radius[ParticleId{i}], R_j = model.radius[ParticleId{j}];
            const double distance = norm(r_ij), overlap = R_i + R_j - distance;
            if (!(overlap > 0.0)) continue;
            if (model.contact.pairs == ContactPairs::unbonded && is_bonded(i, j, a, b, c)) continue;
            const double R = R_i * R_j / (R_i + R_j), k = 4.0 / 3.0 * E_star * std::sqrt(R);
            sum.energy += 0.4 * k * std::pow(overlap, 2.5);
            add(i, j, (-k * std::pow(overlap, 1.5) / distance) * r_ij, r_ij);
          }
  return sum;
}

/// The loads, energies and stress of a body as it stands in a run are those of copies.
Verdict compare(const Simulation& run, Tally& tally) {
  const State& s = run.state();
  const Plain plain = by_copies(run.model(), s);
  const Loads loads = run.loads();
  double off = 0.0, scale = 1.0;
  for (const ParticleId p : loads.F.ids()) {
    off = std::max({off, norm(loads.F[p] - plain.F[p.value]), norm(loads.M[p] - plain.M[p.value])});
    scale = std::max({scale, norm(plain.F[p.value]), norm(plain.M[p.value])});
  }
  // Sums of some hundred terms, of which contacts may be far larger than bonds: places are known to 1e-15,
  // and the stiffness of the hardest overlap is below 50 times the largest force.
  const double load_error = off / scale, energy_error = std::abs(run.energies().potential() - plain.energy) /
                                                        (1.0 + std::abs(plain.energy));
  Tensor kinetic;
  const Tensor L = cell_velocity_gradient(s.cell);
  Vec3d drift;
  double mass = 0.0;
  for (const ParticleId p : s.v.ids()) {
    drift += run.model().mass[p] * (s.v[p] - times(L, s.r[p]));
    mass += run.model().mass[p];
  }
  for (const ParticleId p : s.v.ids()) {
    const Vec3d c = s.v[p] - times(L, s.r[p]) - drift / mass;
    kinetic += dyad(-run.model().mass[p] * c, c);
  }
  const Tensor stress = cell_stress(run.model(), s);
  double stress_error = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d of_copies = plain.force_times_r.row[k] + kinetic.row[k];
    stress_error = std::max(stress_error, norm(volume(s.cell) * stress.row[k] - of_copies) / scale);
  }
  tally.most("error of loads", load_error);
  tally.most("error of energy", energy_error);
  tally.most("error of stress", stress_error);
  if (!(load_error < 1e-11)) return testing::wrong("loads off by " + std::to_string(load_error));
  if (!(energy_error < 1e-11)) return testing::wrong("energy off by " + std::to_string(energy_error));
  if (!(stress_error < 1e-10)) return testing::wrong("stress off by " + std::to_string(stress_error));
  return {};
}

/// As it begins, and after steps in which the cell moves.
Verdict judge(unsigned seed, Tally& tally) {
  Dice dice(seed);
  const Body b = any_body(dice);
  Stage stage;
  stage.name = "motion";
  stage.dt = 1e-3;
  stage.stops.duration = 1.0;
  for (std::size_t k = 0; k < 6; ++k)
    if (dice.chance(0.5)) stage.cell.component[k] = {CellComponent::By::strain, dice(-0.2, 0.2), {}};
  if (dice.chance(0.5)) {
    stage.cell.component[dice.below(6)] = {CellComponent::By::stress, dice(-0.1, 0.1), {}};
    stage.cell.servo = {50.0, 1.0, 0.1};
  }
  tally.add("bonds", static_cast<double>(b.state.bonds.size()));
  for (const Bond& bond : b.state.bonds) tally.add("to own images", bond.i == bond.j ? 1.0 : 0.0);
  Simulation motion(b.model, stage, b.state, dice.whole(1, 3));
  Verdict verdict = compare(motion, tally);
  for (int k = 0; k < 20; ++k) motion.step();
  if (verdict.word == "right") verdict = compare(motion, tally);
  return verdict;
}

TEST(PeriodicCampaign, LoadsEnergyAndStressAreThoseOfCopies) {
  const Tally tally = testing::campaign("periodic bodies", 200, judge);
  EXPECT_EQ(tally["right"], tally.cases);
}

}  // namespace
}  // namespace vbond::cell_campaign_test
