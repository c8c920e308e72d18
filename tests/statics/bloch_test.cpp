// Modes of periodic bodies for given waves: K(q) u = omega^2 M u.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "decompositions.hpp"
#include "dynamics/tops.hpp"
#include "packings.hpp"
#include "periodic.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::bloch_test {
namespace {

using namespace testing;
using Complex = std::complex<double>;

StaticStage wave_stage(std::vector<Vec3d> q, bool of_edges, int count) {
  StaticStage stage = static_stage(StageKind::modes, {});
  stage.waves = {std::move(q), of_edges};
  stage.count = count;
  return stage;
}

StaticResult modes_of(const Specimen& s, const StaticStage& stage) {
  return run_static_stage(s.model, stage, s.state, {}).result;
}

/// omega^2 of one wave, from 1, rigid motions among them.
std::vector<double> squares(const StaticResult& r, int wave) {
  std::vector<double> all;
  for (const NaturalMode& m : r.modes)
    if (m.wave == wave) all.push_back(m.omega2);
  return all;
}

double largest_difference(std::vector<double> a, std::vector<double> b) {
  EXPECT_EQ(a.size(), b.size());
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double largest = 0.0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

constexpr BondStiffness<double> papers{1.0, 0.03, 0.0025, 1.0 / 480};

/// A straight chain along x that repeats after `cells` particles of mass 1, one apart.
Specimen chain(int cells) {
  std::vector<Vec3d> r;
  for (int k = 0; k < cells; ++k) r.push_back({static_cast<double>(k), 0.0, 0.0});
  Specimen s = periodic_body({Vec3d{static_cast<double>(cells), 0, 0}, Vec3d{0, 5, 0}, Vec3d{0, 0, 5}}, r);
  s.model.cell.periodic = {true, false, false};
  BondRecipe recipe;
  recipe.parameters = papers;
  for (int k = 0; k < cells; ++k)
    bond_image(s, static_cast<std::size_t>(k), static_cast<std::size_t>((k + 1) % cells),
               {k + 1 == cells ? 1 : 0, 0, 0}, recipe);
  return s;
}

/// The six squares of D1 (docs/validation.md) for the phase k from one particle to the next.
std::vector<double> dispersion(double k) {
  const auto [c_A, c_D, c_B, c_T] = papers;
  const double Theta = 0.064, s = std::sin(0.5 * k), c = std::cos(0.5 * k);
  const double b = 4 * c_B * s * s + c_D * c * c + 4 * Theta * c_D * s * s,
               d = 16 * c_B * c_D * s * s * s * s;
  // Theta x^2 - b x + d = 0, without a difference of equal numbers
  const double high = (b + std::sqrt(b * b - 4 * Theta * d)) / (2 * Theta), low = d / (Theta * high);
  return {4 * c_A * s * s, 4 * c_T / Theta * s * s, high, high, low, low};
}

// D1: the waves of a cell of n particles are those of n phases of the chain. Twenty of them, no special ones,
// each eigenvalue to rounding of the largest, some 3.
TEST(BlochModes, OfAChainFollowTheDispersionRelations) {
  for (const int cells : {1, 2, 3}) {
    const Specimen s = chain(cells);
    std::vector<Vec3d> q;
    for (int k = 0; k < 20; ++k) q.push_back({(k + 0.3) / 20.0 * M_PI / cells, 0, 0});
    const StaticResult r = modes_of(s, wave_stage(q, false, 6 * cells));
    ASSERT_EQ(r.waves.size(), q.size());
    for (std::size_t w = 0; w < q.size(); ++w) {
      std::vector<double> exact;
      for (int branch = 0; branch < cells; ++branch)
        for (const double x : dispersion(q[w].x + 2 * M_PI * branch / cells)) exact.push_back(x);
      EXPECT_LT(largest_difference(squares(r, static_cast<int>(w) + 1), exact), 1e-13)
          << cells << " particles, q = " << q[w].x;
      for (const NaturalMode& m : r.modes) EXPECT_FALSE(m.rigid);
    }
  }
}

// The same waves by their phase; those at the end of the zone are real, and half of it needs no rounding.
TEST(BlochModes, MayBeGivenByTheirPhase) {
  const Specimen s = chain(2);
  const StaticResult by_phase = modes_of(s, wave_stage({{0.25, 0, 0}, {0.5, 0, 0}, {-0.25, 0, 0}}, true, 12));
  const StaticResult by_vector =
      modes_of(s, wave_stage({{0.25 * M_PI, 0, 0}, {0.5 * M_PI, 0, 0}, {-0.25 * M_PI, 0, 0}}, false, 12));
  for (const int w : {1, 2, 3}) {
    EXPECT_LT(largest_difference(squares(by_phase, w), squares(by_vector, w)), 1e-13);
    EXPECT_NEAR(by_phase.waves[static_cast<std::size_t>(w - 1)].q.x,
                by_vector.waves[static_cast<std::size_t>(w - 1)].q.x, 1e-15);
  }
  EXPECT_LT(largest_difference(squares(by_phase, 1), squares(by_phase, 3)), 1e-13);  // q and -q
  for (const NaturalMode& m : by_phase.modes)
    EXPECT_EQ(m.out_of_phase.translation.empty(), m.wave == 2) << "the shortest wave is real";
}

BondRecipe soft_bond() {
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
  return recipe;
}

// Translations are rigid motions of the wave that repeats with the cell, and no turns but those about the
// axis of a chain, which turns as a whole. Of other waves there are none.
TEST(BlochModes, OnlyTheCellsOwnWaveHasRigidMotions) {
  Specimen solid = periodic_body(cube(1), {{0, 0, 0}});
  for (const Image& n : {Image{1, 0, 0}, Image{0, 1, 0}, Image{0, 0, 1}})
    bond_image(solid, 0, 0, n, soft_bond());
  const auto rigid = [](const Specimen& s, const Vec3d& phase) {
    const StaticResult r = modes_of(s, wave_stage({phase}, true, 6));
    return std::count_if(r.modes.begin(), r.modes.end(), [](const NaturalMode& m) { return m.rigid; });
  };
  EXPECT_EQ(rigid(solid, {0, 0, 0}), 3);
  EXPECT_EQ(rigid(solid, {1, -2, 0}), 3);  // nothing but another name
  EXPECT_EQ(rigid(solid, {0.5, 0, 0}), 0);
  EXPECT_EQ(rigid(solid, {0.1, 0.2, -0.3}), 0);
  EXPECT_EQ(rigid(chain(2), {0, 0, 0}), 4);
  EXPECT_EQ(rigid(chain(2), {0.3, 0, 0}), 0);
  // without wave vectors: the same as a wave of no phase
  StaticStage plain = wave_stage({}, false, 3);
  const StaticResult of_cell = modes_of(solid, plain);
  EXPECT_EQ(of_cell.modes.size(), 6u);
  EXPECT_LT(
      largest_difference(squares(of_cell, 0), squares(modes_of(solid, wave_stage({{0, 0, 0}}, true, 3)), 1)),
      1e-14);
}

// A pair of grains that hangs together with no image moves as it likes in every wave; a chain as a whole in
// those that repeat with it.
TEST(BlochModes, WhatFloatsMovesFreelyInEveryWave) {
  Specimen s = periodic_body(cube(4), {{0, 0, 0}, {3.6, 0, 0}, {0, 2, 2}});
  bond_image(s, 0, 1, {-1, 0, 0}, soft_bond());  // through a face
  for (int k : {0}) bond_image(s, 2, 2, {0, 1, k}, soft_bond());
  for (const auto& [phase, rigid] :
       {std::pair{Vec3d{0, 0, 0}, 6 + 4}, {Vec3d{0.2, 0, 0.4}, 6 + 4}, {Vec3d{0.2, 0.1, 0.4}, 6}}) {
    const StaticResult r = modes_of(s, wave_stage({phase}, true, 18));
    EXPECT_EQ(std::count_if(r.modes.begin(), r.modes.end(), [](const NaturalMode& m) { return m.rigid; }),
              rigid);
    EXPECT_EQ(r.modes.size(), 18u);
    EXPECT_EQ(r.unstable, 0);
    for (const NaturalMode& m : r.modes)
      if (!m.rigid) {
        EXPECT_GT(m.omega2, 1e-4);
      }
  }
}

/// n cells of a body side by side along an edge.
Specimen repeated(const Specimen& s, int n, int edge) {
  const std::size_t N = s.model.particles();
  const Vec3d along = s.model.cell.edges[static_cast<std::size_t>(edge)];
  std::vector<Vec3d> r;
  for (int cell = 0; cell < n; ++cell)
    for (const Vec3d& x : s.state.r) r.push_back(x + double(cell) * along);
  Edges edges = s.model.cell.edges;
  edges[static_cast<std::size_t>(edge)] = double(n) * along;
  Specimen t = periodic_body(edges, r);
  t.model.cell.periodic = s.model.cell.periodic;
  for (std::size_t p = 0; p < t.model.particles(); ++p) {
    t.state.q[ParticleId{p}] = s.state.q[ParticleId{p % N}];
    t.model.radius[ParticleId{p}] = s.model.radius[ParticleId{p % N}];
  }
  for (int cell = 0; cell < n; ++cell)
    for (Bond b : s.state.bonds) {
      Image image = image_of_j(b);
      std::int32_t& along_edge = edge == 0 ? image.a : edge == 1 ? image.b : image.c;
      const int to = cell + along_edge, whole = to >= 0 ? to / n : -((n - 1 - to) / n);
      b.i = ParticleId{b.i.value + static_cast<std::size_t>(cell) * N};
      b.j = ParticleId{b.j.value + static_cast<std::size_t>(to - n * whole) * N};
      along_edge = whole;
      set_image_of_j(b, image);
      t.state.bonds.push_back(b);
    }
  return t;
}

Specimen packed(const Packing& p) {
  Specimen s = periodic_body(p.edges, p.r);
  for (std::size_t k = 0; k < p.radius.size(); ++k) s.model.radius[ParticleId{k}] = p.radius[k];
  for (const PackingBond& b : p.bonds) bond_image(s, b.i, b.j, {b.a, b.b, b.c}, soft_bond());
  return s;
}

// All modes of n cells as one, which images alone join, are those of the n waves of one cell. Each eigenvalue
// of a dense matrix is known to its size times eps times the largest.
TEST(BlochModes, OfAPackingAreThoseOfManyCellsAsOne) {
  for (const Packing& p : {packing_of_equals(), packing_of_sizes()})
    for (const auto& [n, edge] : {std::pair{2, 0}, {3, 2}}) {
      const Specimen one = packed(p);
      const int all = 6 * static_cast<int>(one.model.particles());
      std::vector<Vec3d> phases(static_cast<std::size_t>(n));
      for (int k = 0; k < n; ++k) component(phases[static_cast<std::size_t>(k)], edge) = double(k) / n;
      const StaticResult waves = modes_of(one, wave_stage(phases, true, all));
      const StaticResult whole = modes_of(repeated(one, n, edge), wave_stage({}, false, n * all));
      std::vector<double> of_waves;
      for (int k = 1; k <= n; ++k)
        for (const double x : squares(waves, k)) of_waves.push_back(x);
      const double largest = *std::max_element(of_waves.begin(), of_waves.end());
      EXPECT_LT(largest_difference(of_waves, squares(whole, 0)), n * all * 2.2e-16 * largest)
          << n << " cells";
    }
}

// A few modes of a large matrix are found by iteration, all of them densely.
TEST(BlochModes, FewAreTheFirstOfAll) {
  const Specimen s = packed(packing_of_equals());
  for (const Vec3d& phase : {Vec3d{0.11, -0.23, 0.31}, {0.5, 0, 0}, {0, 0, 0}, {0.25, 0.25, 0}}) {
    const StaticResult all = modes_of(s, wave_stage({phase}, true, 240)),
                       few = modes_of(s, wave_stage({phase}, true, 9));
    std::vector<double> first = squares(all, 1), found = squares(few, 1);
    first.resize(found.size());
    EXPECT_LT(largest_difference(found, first), 1e-12);
    EXPECT_EQ(std::count_if(few.modes.begin(), few.modes.end(), [](const auto& m) { return !m.rigid; }), 9);
  }
}

// Christoffel: long waves go as in a continuum with the packing's constants, which another program has
// computed, but for the square of q: twenty times the size of a particle's half turn over the wave.
TEST(BlochModes, LongWavesArePlaneWavesOfAContinuum) {
  const Packing p = packing_of_equals();
  const Specimen s = packed(p);
  const double rho = static_cast<double>(s.model.particles()) / volume(s.state.cell);
  constexpr int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  const auto C = [&](int i, int j, int k, int l) {
    return p.C[static_cast<std::size_t>(voigt[i][j])][static_cast<std::size_t>(voigt[k][l])];
  };
  for (const Vec3d& n : {Vec3d{1, 0, 0}, normalised(Vec3d{1, 2, -1}), normalised(Vec3d{-0.3, 0.2, 1})}) {
    Eigen::Matrix3d G = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
          for (int l = 0; l < 3; ++l) G(i, k) += C(i, j, k, l) * component(n, j) * component(n, l) / rho;
    const Eigen::Vector3d exact = dense_eigenvalues(G).values;
    const auto error = [&](double q) {
      const std::vector<double> found = squares(modes_of(s, wave_stage({q * n}, false, 3)), 1);
      double largest = 0.0;
      for (int k = 0; k < 3; ++k)
        largest = std::max(largest, std::abs(found[static_cast<std::size_t>(k)] / (q * q) / exact[k] - 1.0));
      return largest;
    };
    const double coarse = error(0.1), fine = error(0.05), finest = error(0.025);
    EXPECT_LT(finest, 1e-3);
    EXPECT_NEAR(coarse / fine, 4.0, 0.1);
    EXPECT_NEAR(fine / finest, 4.0, 0.03);
  }
}

/// One to six particles in a tilted cell that may be open along z, with bonds to all that are near and to
/// images, contacts, tops and parts that float; strained by a stage, so that bonds carry loads.
Specimen random_body(unsigned seed) {
  Dice dice(seed);
  const std::size_t n = dice.count(1, 6);
  const double side = 1.15 * std::cbrt(static_cast<double>(n));
  const bool open = dice.chance(0.3);
  Edges edges = cube(side);
  for (Vec3d& e : edges) e += dice.vector(0.15 * side);
  if (open) edges[0].z = edges[1].z = 0.0, edges[2] = {0, 0, 3 * side};
  std::vector<Vec3d> r;
  for (std::size_t tries = 0; r.size() < n && tries < 10000; ++tries) {
    Vec3d x = dice(0, 1) * edges[0] + dice(0, 1) * edges[1] + dice(0, open ? 0.3 : 1) * edges[2];
    r.push_back(x);
    bool apart = true;
    const Specimen so_far = periodic_body(edges, r);
    for_near_images(so_far.state.cell, {true, true, !open}, r, 0.6,
                    [&](std::size_t, std::size_t, const Image&, double) { apart = false; });
    if (!apart) r.pop_back();
  }
  Specimen s = periodic_body(edges, r, 0.5);
  s.model.cell.periodic = {true, true, !open};
  for (const ParticleId p : s.state.r.ids()) {
    s.state.q[p] = dice.rotation(3.0);
    s.model.mass[p] = dice(0.5, 2.0);
    if (dice.chance(0.4)) make_top(s.model, p, {0.064 * drawn_moments(dice), dice.rotation(2.0)});
  }
  BondRecipe recipe;
  recipe.law = dice.chance(0.5) ? &bond_law<VModel> : &bond_law<Evm>;
  recipe.parameters = BondStiffness<double>{1.0, dice(0.2, 0.6), dice(0.05, 0.1), dice(0.02, 0.1)};
  bond_within(s, dice(1.0, 1.6), recipe);
  if (dice.chance(0.5)) bond_image(s, 0, 0, {1, -1, 0}, recipe);
  if (dice.chance(0.5)) {
    recipe.prestrain = 0.03;
    bond_image(s, 0, r.size() - 1, {1, 0, 0}, recipe);
  }
  if (dice.chance(0.4))
    s.model.contact = {.law = ContactLaw::linear, .pairs = ContactPairs::all}, s.model.contact.k = 0.7;
  return s;
}

/// Loads of a particle from bonds and contacts where copies of the particles stand whole edges away, with
/// copies moved and turned by what `moved` says of the copy.
class Waving {
 public:
  using Moved = std::function<std::array<Vec3d, 2>(ParticleId p, const Image& n)>;
  Waving(const Model& model, const State& at) : model_(model), at_(at) {}
  /// Forces and moments of all particles of the cell without shift.
  std::vector<Vec3d> loads(const Moved& moved) const {
    std::vector<Vec3d> all(2 * model_.particles());
    for (const Bond& b : at_.bonds)
      for (const bool other_end : {false, true}) {
        const Image i = other_end ? -image_of_j(b) : Image{}, j = other_end ? Image{} : image_of_j(b);
        const auto u_i = moved(b.i, i), u_j = moved(b.j, j);
        const Vec3d way = place(b.j, j) + u_j[0] - place(b.i, i) - u_i[0];
        const BondLoads<double> f = b.law->loads(
            b, bond_pose(b, way, rotation_of(u_i[1]) * at_.q[b.i], rotation_of(u_j[1]) * at_.q[b.j]), {});
        const ParticleId p = other_end ? b.j : b.i;
        all[2 * p.value] += other_end ? -f.F : f.F;
        all[2 * p.value + 1] += other_end ? f.M_ji : f.M_ij;
      }
    if (model_.contact.law == ContactLaw::linear)
      for (const ParticleId p : at_.r.ids())
        for (const ParticleId o : at_.r.ids())
          for (int a = -4; a <= 4; ++a)
            for (int b = -4; b <= 4; ++b)
              for (int c = model_.cell.periodic[2] ? -4 : 0; c <= (model_.cell.periodic[2] ? 4 : 0); ++c) {
                const Image n{a, b, c};
                if (p == o && n.is_itself()) continue;
                const Vec3d way = place(o, n) + moved(o, n)[0] - at_.r[p] - moved(p, {})[0];
                const double overlap = model_.radius[p] + model_.radius[o] - norm(way);
                if (overlap > 0.0) all[2 * p.value] += -model_.contact.k * overlap * (way / norm(way));
              }
    return all;
  }

 private:
  Vec3d place(ParticleId p, const Image& n) const {
    return at_.r[p] + double(n.a) * at_.cell[0].along + double(n.b) * at_.cell[1].along +
           double(n.c) * at_.cell[2].along;
  }
  const Model& model_;
  const State& at_;
};

/// K(q) over 6 degrees of freedom of each particle, turns in rad, by central differences of such loads.
Eigen::MatrixXcd tangent_by_copies(const Specimen& s, const State& at, const Wave& wave) {
  constexpr double h = 1e-5;
  const Waving body(s.model, at);
  const Eigen::Index n = 6 * static_cast<Eigen::Index>(s.model.particles());
  Eigen::MatrixXcd K(n, n);
  for (Eigen::Index column = 0; column < n; ++column)
    for (const bool imaginary : {false, true}) {
      const auto loads = [&](double sign) {
        return body.loads([&](ParticleId p, const Image& im) -> std::array<Vec3d, 2> {
          std::array<Vec3d, 2> u{};
          if (static_cast<Eigen::Index>(p.value) != column / 6) return u;
          const Vec3d& x = wave.edges;
          const double phase = 2 * M_PI * (x.x * im.a + x.y * im.b + x.z * im.c);
          component(u[static_cast<std::size_t>(column % 6 / 3)], static_cast<int>(column % 3)) =
              sign * h * (imaginary ? std::sin(phase) : std::cos(phase));
          return u;
        });
      };
      const std::vector<Vec3d> up = loads(1.0), down = loads(-1.0);
      for (Eigen::Index row = 0; row < n; ++row) {
        const auto l = static_cast<std::size_t>(row / 3);
        const double d = -component(up[l] - down[l], static_cast<int>(row % 3)) / (2 * h);
        // a motion Re(u e^{iqw}) with u = 1 gives Re K; the part with sin is Re(-i e^{iqw}): Re(-i K) = Im K
        K(row, column) = imaginary ? Complex(K(row, column).real(), d) : Complex(d, 0.0);
      }
    }
  return 0.5 * (K + K.adjoint());  // in balance moments leave it Hermitian to rounding of differences
}

Eigen::MatrixXd mass_matrix(const Model& m, const State& at) {
  const Eigen::Index n = 6 * static_cast<Eigen::Index>(m.particles());
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
  for (const ParticleId p : m.mass.ids()) {
    const Eigen::Index k = 6 * static_cast<Eigen::Index>(p.value);
    for (Eigen::Index a = 0; a < 3; ++a) {
      M(k + a, k + a) = m.mass[p];
      M(k + 3 + a, k + 3 + a) = m.inertia[p];
    }
    if (!m.is_top(p)) continue;
    for (int b = 0; b < 3; ++b) {
      Vec3d e{};
      component(e, b) = 1.0;
      const Vec3d L = angular_momentum(m.principal[p].moments, at.q[p] * m.principal[p].axes, e);
      for (int a = 0; a < 3; ++a) M(k + 3 + a, k + 3 + b) = component(L, a);
    }
  }
  return M;
}

// Against differences of loads of bodies whose copies are moved one by one: squares of frequencies, and
// shapes. Differences are exact to the square of their step, 1e-10 times third derivatives of some ten.
TEST(BlochModesCampaign, RandomBodiesSwingAsTheirCopiesSay) {
  const Tally all = campaign("waves of periodic bodies", 150, [&](unsigned seed, Tally& tally) -> Verdict {
    Dice dice(seed + 5000);
    Specimen s = random_body(seed);
    std::array<CellComponent, 6> drive{};
    drive[0] = strained(dice(-0.03, 0.03)), drive[5] = strained(dice(-0.02, 0.02));
    drive[1] = strained(dice(-0.03, 0.03));
    s.state = run_static_stage(s.model, cell_stage(drive, 2), s.state, {}).state;
    std::vector<Vec3d> q{dice.vector(2.0), dice.vector(0.3), {0, 0, 0}};
    if (!s.model.cell.periodic[2])
      for (Vec3d& x : q) x.z = 0.0;
    StaticStage stage = wave_stage(q, false, 6 * static_cast<int>(s.model.particles()));
    stage.newton.tolerance = 1e-12;
    const StaticOutcome out = run_static_stage(s.model, stage, s.state, {});
    const Eigen::MatrixXd M = mass_matrix(s.model, out.state);
    for (std::size_t w = 0; w < q.size(); ++w) {
      const Eigen::MatrixXcd K = tangent_by_copies(s, out.state, out.result.waves[w]);
      const Vector values = testing::hermitian_eigenvalues(K, M.cast<Complex>());
      const double largest = values.cwiseAbs().maxCoeff();
      if (largest == 0.0) return {"nothing swings"};
      tally.below(
          "square of a frequency",
          largest_difference(squares(out.result, static_cast<int>(w) + 1), {values.begin(), values.end()}) /
              largest,
          1e-8);
      for (const NaturalMode& m : out.result.modes) {
        if (m.wave != static_cast<int>(w) + 1) continue;
        Eigen::VectorXcd u(K.rows());
        for (Eigen::Index k = 0; k < u.size(); ++k) {
          const ParticleId p{static_cast<std::size_t>(k / 6)};
          const auto part = [&](const Shape& shape) {
            if (shape.translation.empty()) return 0.0;
            return component(k % 6 < 3 ? shape.translation[p] : shape.rotation[p], static_cast<int>(k % 3));
          };
          u[k] = {part(m.shape), part(m.out_of_phase)};
        }
        const double off = (K * u - m.omega2 * M.cast<Complex>() * u).norm() / (largest * (M * u).norm());
        tally.below("shape", off, 1e-7);
      }
      tally.add("waves");
    }
    if (out.result.unstable.value_or(0) > 0) tally.add("unstable modes", *out.result.unstable);
    return {};
  });
  EXPECT_LE(10 * all["given up"], all.full ? all.cases : 10 * all.cases);
}

// Random bodies that a strain, or a stress, brings to where the first of their waves becomes unstable: there
// K(q) by copies, at an equilibrium of a stage of its own, has an eigenvalue that is zero, and a little
// before it has none below.
TEST(BlochModesCampaign, RandomBodiesLoseStabilityWhereTheirCopiesSay) {
  const Tally all = campaign("critical waves", 60, [&](unsigned seed, Tally& tally) -> Verdict {
    Dice dice(seed + 9000);
    Specimen s = random_body(seed + 1000);
    s.model.contact = {};
    s.state = run_static_stage(s.model, cell_stage({}), s.state, {}).state;
    const SymmetricParts start = stress_of(s, s.state);
    StaticStage stage = cell_stage({});
    stage.search_to = 1.2;
    const bool by_stress = dice.chance(0.4);
    stage.cell.component[0] = by_stress ? stressed(-0.3) : strained(-0.3);
    if (dice.chance(0.5)) stage.cell.component[1] = stressed(dice(-0.02, 0.02));
    const StaticStage to = stage;
    stage.kind = StageKind::buckling;
    stage.count = 1;
    stage.waves.of_edges = true;
    for (int k = 0; k < 3; ++k) {
      stage.waves.q.push_back(dice.vector(0.5));
      if (!s.model.cell.periodic[2]) stage.waves.q.back().z = 0.0;
    }
    bool unstable = false;
    StaticHooks hooks;
    hooks.tell = [&](const std::string& text) {
      unstable |= text.find("of an unstable balance") != std::string::npos;
    };
    const StaticResult r = run_static_stage(s.model, stage, s.state, hooks).result;
    if (unstable) return {"what repeats with the cell is unstable first"};
    if (r.critical_loads.empty()) return {"no wave becomes unstable: " + r.ended};
    const CriticalLoad& first = r.critical_loads[0];
    const Wave& wave = r.waves[static_cast<std::size_t>(first.wave - 1)];
    const auto lowest = [&](double part) {
      StaticStage there = to;
      there.at_saddle = AtSaddle::keep;
      there.steps = 6;
      for (std::size_t k = 0; k < 6; ++k) {  // a stress goes on from where it is
        CellComponent& c = there.cell.component[k];
        const double from = c.by == CellComponent::By::stress ? start[k] : 0.0;
        c.value = from + part * first.load_factor * (c.value - from);
      }
      const StaticOutcome out = run_static_stage(s.model, there, s.state, {});
      const Vector values = testing::hermitian_eigenvalues(tangent_by_copies(s, out.state, wave));
      return values[0] / values.cwiseAbs().maxCoeff();
    };
    tally.below("lowest eigenvalue at the critical load", std::abs(lowest(1.0)), 1e-7);
    if (!(lowest(0.98) > -1e-9)) return wrong("it is unstable before");
    tally.add("critical loads", static_cast<double>(r.critical_loads.size()));
    return {};
  });
  EXPECT_LE(4 * all["given up"], all.full ? all.cases : 4 * all.cases);
}

TEST(BlochModes, RefuseWhatMakesNoSense) {
  const auto says = [](const Specimen& s, const StaticStage& stage, const char* what) {
    std::string all;
    for (const std::string& m : mistakes_in(s.model, stage)) all += m + "\n";
    EXPECT_NE(all.find(what), std::string::npos) << all;
  };
  const Specimen s = chain(2);
  says(s, wave_stage({{0.1, 0.2, 0}}, false, 1), "along an open edge");
  says(s, wave_stage({{0.1, 0, 0.5}}, true, 1), "along an open edge");
  says(s, wave_stage({{1e9, 0, 0}}, true, 1), "rounding");
  says(straight_rod(3), wave_stage({{0.1, 0, 0}}, false, 1), "no wave vectors");
  StaticStage stage = wave_stage({{0.1, 0, 0}}, false, 1);
  stage.kind = StageKind::equilibrium;
  says(s, stage, "wave vectors are for modes and critical loads");
}

}  // namespace
}  // namespace vbond::bloch_test
