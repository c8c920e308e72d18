// Elastic constants of finite bodies, by displacement and by traction of their surface.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "packed.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/homogenise.hpp"
#include "vbond/statics/homogenise_body.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::homogenise_body_test {
namespace {

using namespace testing;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Matrix6 matrix(const Constants& C) {
  Matrix6 M;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) M(i, j) = C[std::size_t(i)][std::size_t(j)];
  return M;
}
double difference(const Matrix6& A, const Matrix6& B) {
  return (A - B).cwiseAbs().maxCoeff();
}
double least_eigenvalue(const Matrix6& M) {
  return dense_eigenvalues(0.5 * (M + M.transpose())).values[0];
}

/// n x n x n particles one apart, each bonded to its neighbours along the axes.
Specimen lattice(int n, const BondStiffness<double>& c) {
  std::vector<Vec3d> r;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) r.push_back({double(i), double(j), double(k)});
  Specimen s = particles_at(r, 0.5);
  BondRecipe recipe;
  recipe.parameters = c;
  for (std::size_t p = 0; p < r.size(); ++p)
    for (std::size_t q = p + 1; q < r.size(); ++q)
      if (norm(r[q] - r[p]) < 1.01) bond(s, p, q, recipe);
  return s;
}

// n^2 chains of n - 1 bonds along each axis. Strained by its surface: each bond by as much, n^2 (n - 1) of
// each direction in V = n^3. Loaded along an axis: each chain alike, with the same result.
TEST(HomogeniseBody, OfALatticeIsItsChains) {
  const BondStiffness<double> c{1.0, 0.35, 0.05, 0.02};
  for (const int n : {2, 3, 5}) {
    const Specimen s = lattice(n, c);
    const BodySurface surface = surface_of_box(s.model, s.state);
    EXPECT_NEAR(surface.volume, n * n * n, 1e-12);
    EXPECT_EQ(surface.particles.size(), std::size_t(n * n * n - std::max(0, n - 2) * (n - 2) * (n - 2)));
    const HomogenisedBody found = homogenise_body(s.model, s.state, surface);
    const double part = double(n - 1) / n;
    Matrix6 exact = Matrix6::Zero();
    for (int k = 0; k < 6; ++k) exact(k, k) = part * (k < 3 ? c.c_A : 0.5 * c.c_D);
    EXPECT_LT((matrix(found.by_displacement) - exact).cwiseAbs().maxCoeff(), 1e-13) << n;
    const Matrix6 loaded = matrix(found.by_traction);
    const double of_stretches = (loaded - exact).topRows(3).cwiseAbs().maxCoeff();
    EXPECT_LT(of_stretches, 1e-12) << n;
    for (int k = 3; k < 6; ++k)
      if (n == 2)  // one cell: all its bonds are alike
        EXPECT_NEAR(loaded(k, k), exact(k, k), 1e-13);
      else  // the frames' corners bend
        EXPECT_LT(loaded(k, k), exact(k, k) - 1e-6);
    EXPECT_GT(least_eigenvalue(exact - loaded), -1e-13);
    EXPECT_EQ(found.floating, 0u);
    EXPECT_FALSE(found.moved);
  }
}

TEST(HomogeniseBody, CountsTheVolumeThatIsGiven) {
  const Specimen s = lattice(3, {1.0, 0.35, 0.05, 0.02});
  const HomogenisedBody box = homogenise_body(s.model, s.state, surface_of_box(s.model, s.state)),
                        given = homogenise_body(s.model, s.state, surface_of_box(s.model, s.state, 8.0));
  EXPECT_EQ(box.volume, 27.0);
  EXPECT_EQ(given.volume, 8.0);
  EXPECT_NEAR(given.density, 27.0 / 8.0, 1e-15);
  const double more = 27.0 / 8.0;
  EXPECT_LT(difference(more * matrix(box.by_displacement), matrix(given.by_displacement)), 1e-13);
  EXPECT_LT(difference(more * matrix(box.by_traction), matrix(given.by_traction)), 1e-13);
}

/// Random particles in a cell, bonds of any stiffness to all that are near.
Specimen random_cell(Dice& dice) {
  const std::size_t n = dice.count(12, 40);
  const double side = std::cbrt(double(n)) * dice(0.9, 1.05);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) {
    for (int tries = 0; tries < 200; ++tries) {  // no two of them close to each other
      const Vec3d x{dice(0, side), dice(0, side), dice(0, side)};
      double nearest = INFINITY;
      for (const Vec3d& y : r)
        for (int a = -1; a <= 1; ++a)
          for (int b = -1; b <= 1; ++b)
            for (int c = -1; c <= 1; ++c)
              nearest = std::min(nearest, norm(y + side * Vec3d{double(a), double(b), double(c)} - x));
      if (nearest < 0.6 && tries < 199) continue;
      r.push_back(x);
      break;
    }
  }
  Specimen s = periodic_body(cube(side), r, 0.3);
  BondRecipe recipe;
  recipe.law = dice.chance(0.5) ? &bond_law<VModel> : &bond_law<Evm>;
  recipe.parameters = BondStiffness<double>{1.0, 1.0, 1.0, 1.0};
  bond_within(s, dice(1.35, 1.6), recipe);
  for (Bond& b : s.state.bonds)
    b.coefficients = b.law->from_stiffness(
        {dice.ratio(0.3, 3), dice.ratio(0.1, 3), dice.ratio(0.03, 1), dice.ratio(0.03, 1)}, b.a,
        b.coefficients);
  return s;
}

/// The particles of a cell in open space, with one more for each image that bonds lead to, and all bonds. Its
/// surface: those images, and the particles that they are images of. If w moves all images alike, the sum of
/// w (x) A over both is that of w over edges n_k times what belongs to each pair: chosen so that it is V 1.
std::optional<std::pair<Specimen, BodySurface>> with_ends(const Specimen& cell) {
  std::map<std::pair<std::size_t, Image>, std::size_t> number;
  std::vector<Vec3d> r = cell.state.r.values();
  for (const Bond& b : cell.state.bonds)
    if (!image_of_j(b).is_itself() && number.try_emplace({b.j.value, image_of_j(b)}, r.size()).second)
      r.push_back(cell.state.r[b.j] + to_image(cell.state.cell, image_of_j(b)));
  Specimen s = particles_at(r, 0.3);
  for (const Bond& b : cell.state.bonds) {
    Bond copy = b;
    if (!image_of_j(b).is_itself())
      copy.j = ParticleId{number.at({b.j.value, image_of_j(b)})}, set_image_of_j(copy, {});
    s.state.bonds.push_back(copy);
  }
  Eigen::Matrix3d pairs = Eigen::Matrix3d::Zero(), edges;
  for (const auto& [of, p] : number) {
    const Eigen::Vector3d n(of.second.a, of.second.b, of.second.c);
    pairs += n * n.transpose();
  }
  if (std::abs(pairs.determinant()) < 0.5)
    return std::nullopt;  // it hangs together in two directions at most
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) edges(i, k) = component(cell.state.cell[std::size_t(k)].along, i);
  const double volume = std::abs(edges.determinant());
  const Eigen::Matrix3d weights = volume * edges.inverse().transpose() * pairs.inverse();
  std::map<std::size_t, Vec3d> areas;
  for (const auto& [of, p] : number) {
    const Eigen::Vector3d A = weights * Eigen::Vector3d(of.second.a, of.second.b, of.second.c);
    areas[p] += Vec3d{A[0], A[1], A[2]};
    areas[of.first] -= Vec3d{A[0], A[1], A[2]};
  }
  BodySurface surface;
  surface.volume = volume;
  for (const auto& [p, A] : areas) surface.particles.emplace_back(p), surface.areas.push_back(A);
  return std::pair(std::move(s), std::move(surface));
}

// A cell under three conditions: its surface moves by the strain, images move alike, its surface bears
// uniform stress. Each allows all motions that the one before it allows, so the order holds in the sense of
// energies: no difference has a negative eigenvalue. It holds for a cell with the ends of all its bonds. A
// body from which bonds are cut has no such order against its cell; between its own two it always holds.
testing::Verdict judge_order(unsigned seed, testing::Tally& tally) {
  Dice dice(seed);
  const Specimen cell = random_cell(dice);
  constexpr double rounding = 1e-9;
  Matrix6 C, upper, lower;
  double volume = 0.0;
  try {
    C = matrix(homogenise(cell.model, cell.state).C);
    const auto ends = with_ends(cell);
    if (!ends) return {"refused", {}};
    const HomogenisedBody found = homogenise_body(ends->first.model, ends->first.state, ends->second);
    upper = matrix(found.by_displacement), lower = matrix(found.by_traction), volume = found.volume;
  } catch (const NoEquilibrium&) {  // something can move at no cost
    return {"refused", {}};
  } catch (const std::invalid_argument&) {  // it falls into parts
    return {"refused", {}};
  }
  const double scale = upper.cwiseAbs().maxCoeff();
  if (least_eigenvalue(upper - C) < -rounding * scale) return testing::wrong("periodic above displacement");
  if (least_eigenvalue(C - lower) < -rounding * scale) return testing::wrong("traction above periodic");
  tally.most("part of displacement over periodic", (upper - C).trace() / C.trace());
  tally.most("part of periodic over traction", (C - lower).trace() / C.trace());
  // the body that is left of the cell without bonds to images
  Specimen cut = cell;
  cut.model.cell = {}, cut.state.cell.clear();
  PerBond<Bond> inside;
  for (const Bond& b : cut.state.bonds)
    if (image_of_j(b).is_itself()) inside.push_back(b);
  cut.state.bonds = inside;
  try {
    const HomogenisedBody alone =
        homogenise_body(cut.model, cut.state, surface_of_box(cut.model, cut.state, volume));
    if (least_eigenvalue(matrix(alone.by_displacement) - matrix(alone.by_traction)) < -rounding * scale)
      return testing::wrong("traction above displacement of a cut body");
    tally.add("cut bodies");
    if (least_eigenvalue(matrix(alone.by_displacement) - C) < 0.0)
      tally.add("cut bodies not above their cell");
  } catch (const NoEquilibrium&) {
    tally.add("cut bodies refused");
  } catch (const std::invalid_argument&) {  // it does not fill its box
    tally.add("cut bodies refused");
  }
  return {};
}

TEST(HomogeniseBody, ConditionsOfTheSurfaceAreInOrder) {
  const testing::Tally all = testing::campaign("conditions of the surface", 50, judge_order);
  EXPECT_EQ(all["wrong"] + all["aborted"], 0u);
  EXPECT_GE(all["right"], all.cases * 4 / 5);
  if (all.full) {
    EXPECT_GT(all.sum("cut bodies"), 10.0);
  }
}

Vec3d on(const Vector6& tensor, bool strain, const Vec3d& x) {
  const double f = strain ? 0.5 : 1.0, yz = f * tensor[3], xz = f * tensor[4], xy = f * tensor[5];
  return {tensor[0] * x.x + xy * x.y + xz * x.z, xy * x.x + tensor[1] * x.y + yz * x.z,
          xz * x.x + yz * x.y + tensor[2] * x.z};
}

// Against equilibria that Newton's method finds: the energy of a body whose surface is moved, and how far the
// forces of a stress move it.
testing::Verdict judge_by_equilibria(unsigned seed, testing::Tally& tally) {
  Dice dice(seed);
  const Specimen cell = random_cell(dice);
  const auto ends = with_ends(cell);
  if (!ends) return {"refused", {}};
  const auto& [s, surface] = *ends;
  std::optional<HomogenisedBody> found;
  try {
    found = homogenise_body(s.model, s.state, surface);
  } catch (const NoEquilibrium&) {
    return {"refused", {}};
  } catch (const std::invalid_argument&) {  // it falls into parts
    return {"refused", {}};
  }
  const double V = surface.volume, h = 1e-4;
  const Vector6 e = Vector6::NullaryExpr([&dice] { return dice(-1, 1); });
  const double S = e.dot(solve_dense(matrix(found->by_traction), e));
  const double load = h / std::max(1.0, S);  // soft bodies strain by as much as stiff ones
  double U = 0.0, work = 0.0;
  for (const double side : {1.0, -1.0}) {
    StaticStage moved = static_stage(StageKind::equilibrium, {});
    for (const ParticleId p : surface.particles)
      moved.supports.push_back(fixed({p}, all_held, side * h * on(e, true, s.state.r[p])));
    moved.newton.tolerance = 1e-13;
    const State strained = run_static_stage(s.model, moved, s.state, {}).state;
    U += bond_energies(strained).potential();
    StaticStage loaded = static_stage(StageKind::equilibrium, {fixed({ParticleId{0}}, all_held)});
    for (std::size_t k = 0; k < surface.particles.size(); ++k)
      loaded.loads.push_back(
          pushed(surface.particles[k].value, side * load * on(e, false, surface.areas[k])));
    loaded.newton.tolerance = 1e-13;
    const State pulled = run_static_stage(s.model, loaded, s.state, {}).state;
    for (std::size_t k = 0; k < surface.particles.size(); ++k)
      work += dot(side * load * on(e, false, surface.areas[k]),
                  pulled.r[surface.particles[k]] - s.state.r[surface.particles[k]]);
  }
  const double by_energy = U / (h * h * V), exact = e.dot(matrix(found->by_displacement) * e);
  if (std::abs(by_energy / exact - 1.0) > 1e-5)
    return testing::wrong("displacement: " + std::to_string(by_energy / exact - 1.0));
  const double by_work = work / (2 * load * load * V);
  if (std::abs(by_work / S - 1.0) > 1e-4)
    return testing::wrong("traction: " + std::to_string(by_work / S - 1.0));
  tally.most("error of displacement", std::abs(by_energy / exact - 1.0));
  tally.most("error of traction", std::abs(by_work / S - 1.0));
  return {};
}

TEST(HomogeniseBody, CampaignAgainstEquilibria) {
  const testing::Tally all = testing::campaign("finite bodies", 12, judge_by_equilibria);
  EXPECT_EQ(all["wrong"] + all["aborted"], 0u);
  EXPECT_GE(all["right"], all.cases * 3 / 4);
}

void expect_refused(const Specimen& s, const std::string& because) {
  try {
    homogenise_body(s.model, s.state, surface_of_box(s.model, s.state));
    FAIL() << "not refused: " << because;
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find(because), std::string::npos) << e.what();
  }
}

TEST(HomogeniseBody, RefusesWhatHasNoConstants) {
  const BondStiffness<double> c{1.0, 0.35, 0.05, 0.02};
  Specimen ball = lattice(13, c);  // what is left within a sphere
  Specimen round;
  std::vector<Vec3d> r;
  for (const Vec3d& x : ball.state.r)
    if (norm(x - Vec3d{6, 6, 6}) < 6.2) r.push_back(x);
  round = particles_at(r, 0.5);
  BondRecipe recipe;
  recipe.parameters = c;
  for (std::size_t p = 0; p < r.size(); ++p)
    for (std::size_t q = p + 1; q < r.size(); ++q)
      if (norm(r[q] - r[p]) < 1.01) bond(round, p, q, recipe);
  expect_refused(round, "does not fill the box around it");
  // by its outer particles it has constants
  std::vector<ParticleId> outer;
  for (const ParticleId p : round.state.r.ids())
    if (norm(round.state.r[p] - Vec3d{6, 6, 6}) > 5.0) outer.push_back(p);
  const HomogenisedBody found =
      homogenise_body(round.model, round.state,
                      surface_of(round.model, round.state, outer, 4.0 / 3.0 * M_PI * 6.5 * 6.5 * 6.5));
  const Matrix6 upper = matrix(found.by_displacement), lower = matrix(found.by_traction);
  EXPECT_GT(least_eigenvalue(upper - lower), -1e-12);
  EXPECT_GT(lower(0, 0), 0.5);
  EXPECT_LT(upper(0, 0), 1.0);

  std::vector<Vec3d> plane;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) plane.push_back({double(i), double(j), 0.0});
  Specimen flat = particles_at(plane, 0.5);
  for (std::size_t p = 0; p < 16; ++p)
    for (std::size_t q = p + 1; q < 16; ++q)
      if (norm(plane[q] - plane[p]) < 1.01) bond(flat, p, q, recipe);
  expect_refused(flat, "in one plane");

  expect_refused(lattice(3, {1.0, 0.0, 0.0, 0.0}), "no stiffness");
  BodySurface open = surface_of_box(lattice(3, c).model, lattice(3, c).state);
  open.areas[0].x += 0.1;
  EXPECT_THROW(homogenise_body(lattice(3, c).model, lattice(3, c).state, open), std::invalid_argument);
}

// A particle apart, and one more body: they count nowhere.
// One particle below a block of 4^3 would have a face of 16 to itself.
TEST(HomogeniseBody, RefusesWhatSticksOut) {
  std::vector<Vec3d> r;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) r.push_back({double(i), double(j), double(k)});
  r.push_back({1, 1, -1});
  Specimen s = particles_at(r, 0.5);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.05, 0.02};
  for (std::size_t p = 0; p < r.size(); ++p)
    for (std::size_t q = p + 1; q < r.size(); ++q)
      if (norm(r[q] - r[p]) < 1.01) bond(s, p, q, recipe);
  try {
    surface_of_box(s.model, s.state);
    ADD_FAILURE() << "taken";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("side of -z has 1 particles that stick out, particle 64 among them"),
              std::string::npos)
        << e.what();
  }
}

TEST(HomogeniseBody, LeavesOutWhatDoesNotHangTogetherWithIt) {
  const BondStiffness<double> c{1.0, 0.35, 0.05, 0.02};
  const Specimen s = lattice(3, c);
  std::vector<Vec3d> r = s.state.r.values();
  r.push_back({0.5, 0.5, 0.5});
  Specimen more = particles_at(r, 0.5);
  more.model.radius[ParticleId{27}] = 0.1;
  more.state.bonds = s.state.bonds;
  const HomogenisedBody a = homogenise_body(s.model, s.state, surface_of_box(s.model, s.state)),
                        b = homogenise_body(more.model, more.state, surface_of_box(more.model, more.state));
  EXPECT_EQ(b.floating, 1u);
  EXPECT_EQ(b.density, a.density);
  EXPECT_LT((matrix(a.by_displacement) - matrix(b.by_displacement)).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((matrix(a.by_traction) - matrix(b.by_traction)).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace vbond::homogenise_body_test
