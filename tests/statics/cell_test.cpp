// Periodic bodies at rest: the cell goes to a strain, a stress, or both.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "campaigns/dice.hpp"
#include "decompositions.hpp"
#include "derivative.hpp"
#include "differences.hpp"
#include "periodic.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::cell_test {
namespace {

using namespace testing;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

BondRecipe soft_bond(const BondLaw* law = &bond_law<VModel>) {
  BondRecipe recipe;
  recipe.law = law;
  recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
  return recipe;
}

StaticStage without_stress() {
  return cell_stage({stressed(0), stressed(0), stressed(0), stressed(0), stressed(0), stressed(0)});
}

/// C (Voigt, engineering shear) of a body in balance without stress: what is left of the tangent of a cell
/// that gives way everywhere, with particles condensed out; translations of all are held by the first.
Matrix6 constants_of(const Specimen& s) {
  StaticStage stage = without_stress();
  stage.supports = {fixed({ParticleId{0}}, {true, true, true, false, false, false})};
  const StaticBody body(s.model, stage, s.state);
  const DenseMatrix K = body.tangent();
  const Eigen::Index n = K.rows() - 6;
  const DenseMatrix E_u = K.bottomLeftCorner(6, n);
  const Matrix6 left =
      K.bottomRightCorner<6, 6>() - E_u * testing::solved(K.topLeftCorner(n, n), E_u.transpose());
  Matrix6 C = sq(body.unknowns().cell_length()) / volume(s.state.cell) * left;
  if (!s.model.cell.triangular)  // a symmetric F has the shear twice
    for (int k : {3, 4, 5}) C.row(k) *= 0.5, C.col(k) *= 0.5;
  return C;
}

/// The same by stresses of small strains.
Matrix6 constants_by_strains(const Specimen& s, double strain = 1e-5) {
  Matrix6 C;
  for (std::size_t k = 0; k < 6; ++k) {
    const double part = k < 3 ? 1.0 : 0.5;  // of engineering shear in each entry
    std::array<SymmetricParts, 2> stress;
    for (const double sign : {1.0, -1.0}) {
      std::array<CellComponent, 6> component{};
      component[k] = strained(sign * part * strain);
      stress[sign > 0.0 ? 0 : 1] =
          stress_of(s, run_static_stage(s.model, cell_stage(component), s.state, {}).state);
    }
    for (std::size_t l = 0; l < 6; ++l)
      C(static_cast<Eigen::Index>(l), static_cast<Eigen::Index>(k)) =
          (stress[0][l] - stress[1][l]) / (2 * strain);
  }
  return C;
}

/// Of a cell of n^3 cells of a lattice.
Specimen lattice(const Edges& edges, const std::vector<Vec3d>& basis, int n) {
  std::vector<Vec3d> r;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c)
        for (const Vec3d& at : basis)
          r.push_back(at + double(a) * edges[0] + double(b) * edges[1] + double(c) * edges[2]);
  Specimen s = periodic_body({double(n) * edges[0], double(n) * edges[1], double(n) * edges[2]}, r);
  bond_within(s, 1.01, soft_bond());
  return s;
}

struct Lattice {
  const char* name;
  Edges edges;
  std::vector<Vec3d> basis;
  double C11, C12, C13, C33, C44,
      C66;  // another program's (docs/validation.md): by second differences of energy
};

std::vector<Lattice> lattices() {
  const double h = std::sqrt(0.5), b = std::sqrt(1.0 / 3.0), c = std::sqrt(8.0 / 3.0), w = std::sqrt(0.75);
  return {{"SC", cube(1), {{0, 0, 0}}, 1, 0, 0, 1, 0.175, 0.175},
          {"FCC",
           {Vec3d{0, h, h}, Vec3d{h, 0, h}, Vec3d{h, h, 0}},
           {{0, 0, 0}},
           1.9091883092036785,
           0.4596194077712561,
           0.4596194077712561,
           1.9091883092036785,
           0.9545941546018395,
           0.9545941546018393},
          {"BCC",
           {Vec3d{-b, b, b}, Vec3d{b, -b, b}, Vec3d{b, b, -b}},
           {{0, 0, 0}},
           0.9814954576223636,
           0.375277674973257,
           0.37527767497325687,
           0.9814954576223638,
           0.6783865662978102,
           0.6783865662978102},
          {"HCP",
           {Vec3d{1, 0, 0}, Vec3d{-0.5, w, 0}, Vec3d{0, 0, c}},
           {{0, 0, 0}, {0.5, w / 3.0, 0.5 * c}},
           2.129944903542297,
           0.3920692826897231,
           0.3064129385141706,
           2.2156012477178493,
           0.8013876853447539,
           0.8689378104262874}};
}

TEST(PeriodicCell, LatticesHaveTheirElasticConstants) {
  for (const Lattice& l : lattices())
    for (const int n : {1, 2, 3}) {
      const Specimen s = lattice(l.edges, l.basis, n);
      Matrix6 exact = Matrix6::Zero();
      exact.topLeftCorner<3, 3>() << l.C11, l.C12, l.C13, l.C12, l.C11, l.C13, l.C13, l.C13, l.C33;
      exact.diagonal().tail<3>() << l.C44, l.C44, l.C66;
      const Matrix6 C = constants_of(s);
      // of the largest; of the tangent, whose sums over n^3 particles are rounded
      EXPECT_LT((C - exact).cwiseAbs().maxCoeff(), 1e-13 * n * l.C33) << l.name << " " << n << "\n" << C;
      if (n > 1) continue;
      // differences of stress, linear but for the square of the strain
      EXPECT_LT((constants_by_strains(s) - exact).cwiseAbs().maxCoeff(), 1e-8 * l.C33) << l.name;
    }
}

/// Simple-cubic layers along z, the first ones of one material, the others of another; where they meet bonds
/// have the harmonic mean of each stiffness.
Specimen laminate(int first, int second) {
  const BondStiffness<double> soft{1.0, 0.3, 0.025, 0.02}, stiff{4.0, 1.2, 0.1, 0.08};
  const auto mean = [](double x, double y) { return 2.0 * x * y / (x + y); };
  const BondStiffness<double> between{mean(soft.c_A, stiff.c_A), mean(soft.c_D, stiff.c_D),
                                      mean(soft.c_B, stiff.c_B), mean(soft.c_T, stiff.c_T)};
  const int n = first + second;
  std::vector<Vec3d> r;
  for (int k = 0; k < n; ++k) r.push_back({0, 0, static_cast<double>(k)});
  Specimen s = periodic_body({Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, static_cast<double>(n)}}, r);
  const auto join = [&](int i, int j, const Image& image, const BondStiffness<double>& c) {
    BondRecipe recipe;
    recipe.parameters = c;
    bond_image(s, static_cast<std::size_t>(i), static_cast<std::size_t>(j), image, recipe);
  };
  for (int k = 0; k < n; ++k) {
    const bool is_soft = k < first, above_is_soft = (k + 1) % n < first;
    for (const Image& image : {Image{1, 0, 0}, Image{0, 1, 0}}) join(k, k, image, is_soft ? soft : stiff);
    join(k, (k + 1) % n, {0, 0, k + 1 == n ? 1 : 0},
         is_soft != above_is_soft ? between
         : is_soft                ? soft
                                  : stiff);
  }
  return s;
}

// Another program's numbers, of the same layers.
TEST(PeriodicCell, LaminatesHaveTheirElasticConstants) {
  struct Row {
    int layers;
    double C11, C33, C44, C66;
  };
  for (const Row& row :
       {Row{2, 2.5, 1.5999999999999999, 0.24633431085044005, 0.375},
        Row{4, 2.5000000000000004, 1.6000000000000005, 0.2431585544182161, 0.37500000000000006},
        Row{10, 2.5000000000000004, 1.5999999999999996, 0.24125359042838226, 0.3749999999999999}}) {
    const Matrix6 C = constants_of(laminate(row.layers, row.layers));
    EXPECT_NEAR(C(0, 0), row.C11, 1e-9);
    EXPECT_NEAR(C(0, 1), 0.0, 1e-9);
    EXPECT_NEAR(C(0, 2), 0.0, 1e-9);
    EXPECT_NEAR(C(2, 2), row.C33, 1e-9);
    EXPECT_NEAR(C(3, 3), row.C44, 1e-9);
    EXPECT_NEAR(C(5, 5), row.C66, 1e-9);
  }
}

/// Two to six particles anywhere in a tilted cell, each bonded to all that are near, and one to its own
/// image; one bond with a prestrain, so that the body is not in balance.
Specimen random_body(unsigned seed, bool triangular = false) {
  Dice dice(seed);
  Edges edges = cube(1.6);
  for (Vec3d& e : edges) e += dice.vector(0.3);
  std::vector<Vec3d> r(dice.count(2, 6));
  for (Vec3d& x : r) x = dice.vector(2.0);
  Specimen s = periodic_body(edges, r);
  s.model.cell.triangular = triangular;
  for (Quatd& q : s.state.q) q = dice.rotation(1.0);
  BondRecipe recipe = soft_bond(dice.chance(0.5) ? &bond_law<VModel> : &bond_law<Evm>);
  std::vector<bool> near;
  for_near_images(s.state.cell, s.model.cell.periodic, s.state.r.values(), 1.7,
                  [&](std::size_t i, std::size_t j, const Image& n, double d2) {
                    if (d2 > sq(0.3)) bond_image(s, i, j, n, recipe);
                  });
  bond_image(s, 0, 0, {0, 1, -1}, recipe);
  recipe.prestrain = 0.02;
  bond_image(s, 0, 1, {1, 0, 0}, recipe);
  return s;
}

std::array<CellComponent, 6> random_drive(Dice& dice, double strain, double stress) {
  std::array<CellComponent, 6> component{};
  for (CellComponent& c : component) {
    const double x = dice(0.0, 1.0);
    if (x < 0.3)
      c = strained(dice(-strain, strain));
    else if (x < 0.8)
      c = stressed(dice(-stress, stress));
  }
  return component;
}

// Out of balance, strained and turned, with what the stage wants half way: differences of central kind are
// exact to the square of their step.
TEST(PeriodicCell, TangentAndLoadDirectionAreDerivatives) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Dice dice(seed + 100);
    const Specimen s = random_body(seed, seed % 2 == 0);
    const StaticStage stage = cell_stage(random_drive(dice, 0.1, 0.1));
    StaticBody body(s.model, stage, s.state);
    Vector x(body.unknowns().size());
    for (double& c : x) c = dice(-0.03, 0.03);
    body.move(x, 0.6);
    const ByDifferences exact = by_differences(body);
    DenseMatrix full = body.full_tangent();
    // turns do not commute: their block of each particle has the symmetric part only, where it is out of
    // balance
    for (int k = 0; k < body.unknowns().size(); ++k)
      for (int l = 0; l < body.unknowns().size(); ++l)
        if (body.unknowns().is_turn(k) && body.unknowns().is_turn(l) &&
            body.unknowns().place(k).particle == body.unknowns().place(l).particle)
          full(k, l) += 0.5 * (exact.tangent(k, l) - exact.tangent(l, k));
    const double size = full.cwiseAbs().maxCoeff();
    EXPECT_LT((full - exact.tangent).cwiseAbs().maxCoeff(), 3e-8 * size) << "seed " << seed;
    EXPECT_LT((body.load_direction() - exact.load_direction).cwiseAbs().maxCoeff(), 3e-8 * size)
        << "seed " << seed;
  }
}

// Where no stress is wanted, and no component is held, what is out of balance is minus the derivative of the
// energy.
TEST(PeriodicCell, WhatIsOutOfBalanceIsTheDerivativeOfTheEnergy) {
  constexpr double h = 2e-3;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Specimen s = random_body(seed, seed % 2 == 0);
    const StaticStage stage = without_stress();
    StaticBody body(s.model, stage, s.state, 1.0);
    const Placement here = body.placement();
    const Vector unbalanced = body.unbalanced();
    for (int k = 0; k < body.unknowns().size(); ++k) {
      const auto energy = [&](double step) {
        body.restore(here);
        body.move(step * Vector::Unit(body.unknowns().size(), k), 1.0);
        return body.energies().potential();
      };
      EXPECT_NEAR(unbalanced[k], -testing::derivative(energy, h), 1e-10 * (1.0 + std::abs(unbalanced[k])))
          << "seed " << seed << ", " << body.unknowns().name(k);
    }
  }
}

// Far from small strains, components of strain and of Cauchy's stress in any mixture, from bodies that are
// not in balance at the start. Some of those with two or three particles carry no stress of this size.
TEST(PeriodicCell, EachComponentIsWhatTheStageWants) {
  constexpr unsigned cases = 100;
  unsigned right = 0, given_up = 0;
  for (unsigned seed = 1; seed <= cases; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed + 200);
    const Specimen s = random_body(seed, seed % 2 == 0);
    const StaticStage stage = cell_stage(random_drive(dice, 0.05, 0.03), 3);
    std::optional<State> end;
    try {
      end = run_static_stage(s.model, stage, s.state, {}).state;
    } catch (const NoEquilibrium&) {
      ++given_up;
      continue;
    }
    ++right;
    const std::array<double, 6> F = cell_strain(s, *end);
    const SymmetricParts stress = stress_of(s, *end);
    for (std::size_t k = 0; k < 6; ++k) {
      const CellComponent& c = stage.cell.component[k];
      if (c.by == CellComponent::By::stress)
        EXPECT_NEAR(stress[k], c.value, 1e-12) << cell_component_names[k];
      else
        EXPECT_NEAR(F[k], (k < 3 ? 1.0 : 0.0) + c.value, 1e-15) << cell_component_names[k];
    }
  }
  std::printf("%u right, %u given up\n", right, given_up);
  EXPECT_LE(given_up, cases / 20);
}

// The program holds a particle, as nothing else does. What is out of balance at the start fades on it as on
// the others: no support bears it.
TEST(PeriodicCell, HasNoReactionsWithoutSupports) {
  unsigned points = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Specimen s = random_body(seed);
    StaticHooks hooks;
    hooks.point = [&](const StaticPoint& point) {
      for (const ParticleId p : s.state.r.ids()) EXPECT_EQ(point.reaction({p}).force, (Vec3d{}));
      ++points;
    };
    std::array<CellComponent, 6> drive{};
    drive[0] = strained(0.01);
    try {
      run_static_stage(s.model, cell_stage(drive, 3), s.state, hooks);
    } catch (const NoEquilibrium&) {
    }
  }
  EXPECT_GT(points, 40u);
}

// A stage goes on from where the one before it has left the cell.
TEST(PeriodicCell, GoesAndComesBack) {
  const Specimen s = lattice(lattices()[3].edges, lattices()[3].basis, 1);
  std::array<CellComponent, 6> there{}, back{};
  there[0] = strained(0.02), there[4] = strained(0.01), there[2] = stressed(0.03);
  back[0] = strained(-0.02), back[4] = strained(-0.01), back[2] = stressed(0.0);
  const State away = run_static_stage(s.model, cell_stage(there), s.state, {}).state;
  const State end = run_static_stage(s.model, cell_stage(back), away, {}).state;
  const std::array<double, 6> F = cell_strain(s, end), identity{1, 1, 1, 0, 0, 0};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(F[k], identity[k], 1e-12);
  for (const double x : stress_of(s, end)) EXPECT_NEAR(x, 0.0, 1e-12);
  EXPECT_GT(std::abs(stress_of(s, away)[0]), 0.01);
}

/// The same body with all particles moved, another cell of the same lattice, and every second particle of
/// each pair of images chosen anew.
Specimen seen_otherwise(const Specimen& s) {
  Specimen t = s;
  auto& [a, b, c] = t.model.cell.edges;
  b += a;  // n_a a + n_b b = (n_a - n_b) a + n_b (a + b)
  t.state.cell = cell_at_start(t.model);
  const Image moved{1, -2, 0};  // of particle 0
  for (Bond& k : t.state.bonds) {
    Image n = image_of_j(k);
    n.a -= n.b;
    if (k.i.value == 0) n = n + moved;
    if (k.j.value == 0) n = n - moved;
    set_image_of_j(k, n);
  }
  t.state.r[ParticleId{0}] += to_image(t.state.cell, moved);
  for (Vec3d& r : t.state.r) r += Vec3d{0.3, -0.2, 0.7};
  for (std::size_t p = 0; p < t.model.particles(); ++p) t.model.r_0[ParticleId{p}] = t.state.r[ParticleId{p}];
  return t;
}

/// Two cells side by side along c.
Specimen doubled(const Specimen& s) {
  const std::size_t n = s.model.particles();
  std::vector<Vec3d> r = s.state.r.values();
  for (std::size_t p = 0; p < n; ++p) r.push_back(r[p] + s.model.cell.edges[2]);
  Edges edges = s.model.cell.edges;
  edges[2] = 2.0 * edges[2];
  Specimen t = periodic_body(edges, r);
  t.model.cell.triangular = s.model.cell.triangular;
  for (std::size_t p = 0; p < 2 * n; ++p) t.state.q[ParticleId{p}] = s.state.q[ParticleId{p % n}];
  for (const int cell : {0, 1})
    for (Bond b : s.state.bonds) {
      Image image = image_of_j(b);
      const int to = cell + image.c, whole = to >= 0 ? to / 2 : -((1 - to) / 2);
      b.i = ParticleId{b.i.value + static_cast<std::size_t>(cell) * n};
      b.j = ParticleId{b.j.value + static_cast<std::size_t>(to - 2 * whole) * n};
      image.c = whole;
      set_image_of_j(b, image);
      t.state.bonds.push_back(b);
    }
  return t;
}

TEST(PeriodicCell, IsTheSameSeenOtherwise) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Dice dice(seed + 300);
    const Specimen s = random_body(seed, seed % 2 == 0);
    const StaticStage stage = cell_stage(random_drive(dice, 0.05, 0.03), 2);
    const State one = run_static_stage(s.model, stage, s.state, {}).state;
    const double energy = energy_of(s, one);
    for (const bool twice : {false, true}) {
      const Specimen t = twice ? doubled(s) : seen_otherwise(s);
      const State other = run_static_stage(t.model, stage, t.state, {}).state;
      const SymmetricParts a = stress_of(s, one), b = stress_of(t, other);
      for (std::size_t k = 0; k < 6; ++k)
        EXPECT_NEAR(a[k], b[k], 1e-12) << "seed " << seed << (twice ? " doubled" : "");
      EXPECT_NEAR(energy_of(t, other), (twice ? 2.0 : 1.0) * energy, 1e-11) << "seed " << seed;
    }
  }
}

// Two lattices one in the other, which nothing joins: each is strained like one alone, and both are told of.
TEST(PeriodicCell, PartsThatFloatAreHeldAndTold) {
  Specimen s = periodic_body(cube(1), {{0, 0, 0}, {0.5, 0.5, 0.5}});
  for (const std::size_t p : {0u, 1u})
    for (const Image& n : {Image{1, 0, 0}, Image{0, 1, 0}, Image{0, 0, 1}})
      bond_image(s, p, p, n, soft_bond());
  std::string told;
  StaticHooks hooks;
  hooks.tell = [&](const std::string& text) { told += text; };
  std::array<CellComponent, 6> drive{};
  drive[0] = strained(0.01), drive[1] = stressed(0.0);
  const State end = run_static_stage(s.model, cell_stage(drive), s.state, hooks).state;
  EXPECT_NEAR(stress_of(s, end)[0], 0.02, 2e-4);
  EXPECT_NE(told.find("parts float"), std::string::npos) << told;
  EXPECT_NE(told.find("translation along x of particle 1"), std::string::npos) << told;
}

// A rod that goes on along x, in a wide cell: it can turn about x, and nothing but the rod holds the cell.
TEST(PeriodicCell, ARodThatGoesOnMayTurnAboutItself) {
  Specimen s =
      periodic_body({Vec3d{3, 0, 0}, Vec3d{0, 9, 0}, Vec3d{0, 0, 9}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  for (const std::size_t p : {0u, 1u}) bond_image(s, p, p + 1, {}, soft_bond());
  bond_image(s, 2, 0, {1, 0, 0}, soft_bond());
  std::string told;
  StaticHooks hooks;
  hooks.tell = [&](const std::string& text) { told += text; };
  std::array<CellComponent, 6> drive{};
  drive[0] = stressed(0.01 / 81);
  const State end = run_static_stage(s.model, cell_stage(drive), s.state, hooks).state;
  EXPECT_NEAR(cell_strain(s, end)[0], 1.01, 1e-12);
  EXPECT_NE(told.find("rotation about x"), std::string::npos) << told;
}

// A cube of one sphere that touches its own images, and is bonded to them.
TEST(PeriodicCell, ContactsOfImagesPress) {
  for (const ContactPairs pairs : {ContactPairs::all, ContactPairs::unbonded}) {
    Specimen s = periodic_body(cube(1), {{0, 0, 0}}, 0.5);
    for (const Image& n : {Image{1, 0, 0}, Image{0, 1, 0}, Image{0, 0, 1}})
      bond_image(s, 0, 0, n, soft_bond());
    s.model.contact = {.law = ContactLaw::linear, .pairs = pairs};
    s.model.contact.k = 2.0;
    std::array<CellComponent, 6> drive{};
    drive[0] = strained(-0.01), drive[1] = stressed(-0.03), drive[2] = stressed(0.002);
    const State end = run_static_stage(s.model, cell_stage(drive, 2), s.state, {}).state;
    const double pressed = pairs == ContactPairs::all ? 3.0 : 1.0;  // c_A = 1, and k = 2
    const std::array<double, 6> F = cell_strain(s, end);
    EXPECT_NEAR(stress_of(s, end)[0] * F[1] * F[2], -0.01 * pressed, 1e-14);
    EXPECT_NEAR(F[1], 1.0 - 0.03 * F[0] * F[2] / pressed, 1e-14);
    EXPECT_NEAR(F[2], 1.0 + 0.002 * F[0] * F[1], 1e-14);
  }
}

TEST(PeriodicCell, RefusesWhatMakesNoSense) {
  const Specimen s = lattice(cube(1), {{0, 0, 0}}, 1);
  const auto says = [&](StaticStage stage, const char* what) {
    std::string all;
    for (const std::string& m : mistakes_in(s.model, stage)) all += m + "\n";
    EXPECT_NE(all.find(what), std::string::npos) << all;
  };
  std::array<CellComponent, 6> drive{};
  drive[0] = stressed(0.1);
  StaticStage stage = cell_stage(drive);
  EXPECT_TRUE(mistakes_in(s.model, stage).empty());
  for (const StageKind kind : {StageKind::path, StageKind::fracture}) {
    stage.kind = kind;
    EXPECT_TRUE(mistakes_in(s.model, stage).empty());
  }
  stage.kind = StageKind::modes;
  says(stage, "the cell moves: modes are about a balance at rest");
  stage.kind = StageKind::buckling;
  says(stage, "give way to a stress, which has no potential");
  stage = cell_stage(drive);
  stage.gravity = {0, 0, -1};
  says(stage, "loads and gravity do not act on a body whose cell moves");
  stage = cell_stage(drive);
  stage.supports = {fixed({ParticleId{0}}, {true, true, true})};
  says(stage, "supports would stand still");
}

// What no stiffness holds goes nowhere: it is said which component it is.
TEST(PeriodicCell, SaysWhichComponentHasNoStiffness) {
  Specimen s = periodic_body({Vec3d{1, 0, 0}, Vec3d{0, 3, 0}, Vec3d{0, 0, 3}}, {{0, 0, 0}});
  bond_image(s, 0, 0, {1, 0, 0}, soft_bond());
  std::array<CellComponent, 6> drive{};
  drive[1] = stressed(0.01);
  try {
    run_static_stage(s.model, cell_stage(drive), s.state, {});
    FAIL() << "a stress that nothing carries was accepted";
  } catch (const NoEquilibrium& e) {
    EXPECT_NE(std::string(e.what()).find("component yy of the cell"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace vbond::cell_test
