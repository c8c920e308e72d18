// Plates that sheets are: closed forms of lattices, and random sheets that are curved.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "periodic.hpp"
#include "vbond/core/error.hpp"
#include "vbond/statics/detail/dense.hpp"
#include "vbond/statics/homogenise_sheet.hpp"

namespace vbond::homogenise_sheet_test {
namespace {

using namespace testing;

double difference(const SheetConstants& a, const SheetConstants& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) most = std::max(most, std::abs(a[i][j] - b[i][j]));
  return most;
}
SheetConstants orthotropic(double c11, double c12, double c22, double c66) {
  return {{{c11, c12, 0}, {c12, c22, 0}, {0, 0, c66}}};
}

/// Particles in a cell that repeats along a and b, not along c.
Specimen sheet(const Vec3d& a, const Vec3d& b, const std::vector<Vec3d>& r, double distance,
               const BondStiffness<double>& c) {
  Specimen s{equal_particles(r, 1.0, 0.064, 0.4), {}};
  s.model.cell = {{a, b, 50.0 * normalised(cross(a, b))}, {true, true, false}, {}, false};
  s.state = at_rest(s.model);
  BondRecipe recipe;
  recipe.parameters = c;
  bond_within(s, distance, recipe);
  return s;
}

constexpr BondStiffness<double> c{1.0, 0.35, 0.05, 0.02};

// One particle of a square lattice of side a, and two bonds: each takes part of the strain and the curvature
// along it, its shear c_D, its twist c_T.
TEST(HomogeniseSheet, OfASquareLatticeIsItsClosedForm) {
  for (const double a : {1.0, 0.4}) {
    const Specimen s = sheet({a, 0, 0}, {0, a, 0}, {{0.3, 0.1, 7.0}}, 1.01 * a, c);
    ASSERT_EQ(s.state.bonds.size(), 2u);
    const HomogenisedSheet found = homogenise_sheet(s.model, s.state);
    EXPECT_LT(difference(found.A, orthotropic(c.c_A, 0, c.c_A, 0.5 * c.c_D)), 1e-14);
    EXPECT_LT(difference(found.D, orthotropic(c.c_B, 0, c.c_B, 0.5 * c.c_T)), 1e-14);
    EXPECT_LT(difference(found.B, {}), 1e-14);
    EXPECT_EQ(found.plane, 7.0);
    EXPECT_NEAR(found.density, 1.0 / (a * a), 1e-12);
    EXPECT_EQ(found.floating, 0u);
  }
}

// Three bonds for each particle of a triangular lattice, 2/sqrt(3) particles per a^2: the mean over their
// directions of e e e e is 1/8 (of three pairings), so 3/8 stands before each term.
TEST(HomogeniseSheet, OfATriangularLatticeIsItsClosedForm) {
  const double h = std::sqrt(3.0) / 2, f = 2.0 / std::sqrt(3.0) * 3.0 / 8.0;
  const SheetConstants A = orthotropic(f * (3 * c.c_A + c.c_D), f * (c.c_A - c.c_D), f * (3 * c.c_A + c.c_D),
                                       f * (c.c_A + c.c_D)),
                       D = orthotropic(f * (3 * c.c_B + c.c_T), f * (c.c_B - c.c_T), f * (3 * c.c_B + c.c_T),
                                       f * (c.c_B + c.c_T));
  for (const Specimen& s :
       {sheet({1, 0, 0}, {0.5, h, 0}, {{0, 0, 0}}, 1.01, c),
        sheet({1, 0, 0}, {0, 2 * h, 0}, {{0, 0, 0}, {0.5, h, 0}}, 1.01, c),
        sheet({1.5, h, 0}, {-1.5, h, 0}, {{0, 0, 0}, {-0.5, h, 0}, {0.5, h, 0}}, 1.01, c)}) {
    const HomogenisedSheet found = homogenise_sheet(s.model, s.state);
    EXPECT_EQ(found.bonds, 3 * found.particles);
    EXPECT_LT(difference(found.A, A), 1e-13);
    EXPECT_LT(difference(found.D, D), 1e-13);
    EXPECT_LT(difference(found.B, {}), 1e-13);
  }
}

// Layers of square lattices above each other: bonds in the plane at height z stretch by z k, and bend by k;
// those across do nothing.
TEST(HomogeniseSheet, OfASlabIsTheSumOfItsLayers) {
  for (const int layers : {2, 3, 5}) {
    std::vector<Vec3d> r;
    double z2 = 0.0;
    for (int k = 0; k < layers; ++k) {
      const double z = k - 0.5 * (layers - 1);
      r.push_back({0, 0, z}), z2 += z * z;
    }
    const Specimen s = sheet({1, 0, 0}, {0, 1, 0}, r, 1.01, c);
    const HomogenisedSheet found = homogenise_sheet(s.model, s.state);
    const double n = layers, D11 = c.c_A * z2 + n * c.c_B, D66 = 0.5 * (c.c_D * z2 + n * c.c_T);
    EXPECT_LT(difference(found.A, orthotropic(n * c.c_A, 0, n * c.c_A, 0.5 * n * c.c_D)), 1e-13);
    EXPECT_LT(difference(found.D, orthotropic(D11, 0, D11, D66)), 1e-13) << layers;
    EXPECT_LT(difference(found.B, {}), 1e-13);
  }
}

// With heavier particles on one side the plane is d farther off: B = -d A of the plane in the middle, and D
// grows by d^2 A.
TEST(HomogeniseSheet, CountsFromTheCentreOfMass) {
  Specimen s = sheet({1, 0, 0}, {0, 1, 0}, {{0, 0, 0}, {0, 0, 1}}, 1.01, c);
  const HomogenisedSheet middle = homogenise_sheet(s.model, s.state);
  s.model.mass[ParticleId{1}] = 3.0;
  const HomogenisedSheet above = homogenise_sheet(s.model, s.state);
  EXPECT_EQ(middle.plane, 0.5);
  EXPECT_EQ(above.plane, 0.75);
  SheetConstants B{}, D = middle.D;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) B[i][j] = -0.25 * middle.A[i][j], D[i][j] += 0.0625 * middle.A[i][j];
  EXPECT_LT(difference(above.A, middle.A), 1e-14);
  EXPECT_LT(difference(above.B, B), 1e-14);
  EXPECT_LT(difference(above.D, D), 1e-14);
}

// What hangs together with no image of it neither carries nor says where the plane is.
TEST(HomogeniseSheet, LeavesLooseParticlesOut) {
  const Specimen s = sheet({1, 0, 0}, {0, 1, 0}, {{0, 0, 0}, {0.2, 0.3, 6.0}}, 1.01, c);
  Specimen loose = s;
  for (Bond& b : loose.state.bonds) b.broken = b.i == ParticleId{1};
  const HomogenisedSheet found = homogenise_sheet(loose.model, loose.state);
  EXPECT_EQ(found.bonds, 2u);
  EXPECT_EQ(found.floating, 1u);
  EXPECT_EQ(found.parts, 1u);
  EXPECT_EQ(found.plane, 0.0);
  EXPECT_LT(difference(found.B, {}), 1e-14);
  EXPECT_LT(difference(found.D, orthotropic(c.c_B, 0, c.c_B, 0.5 * c.c_T)), 1e-14);
  EXPECT_NEAR(found.density, 2.0, 1e-15);
}

// Two layers 4 apart that nothing joins: strained by 2 k on either side.
TEST(HomogeniseSheet, CountsLayersThatDoNotHangTogether) {
  const Specimen s = sheet({1, 0, 0}, {0, 1, 0}, {{0, 0, 0}, {0, 0, 4}}, 1.01, c);
  const HomogenisedSheet found = homogenise_sheet(s.model, s.state);
  EXPECT_EQ(found.parts, 2u);
  EXPECT_EQ(found.floating, 0u);
  EXPECT_NEAR(found.D[0][0], 2.0 * (c.c_B + 4.0 * c.c_A), 1e-13);
}

// A strain of 1e-7 is nothing to c_A, but adds 1e-7 c_A a^2/4 to D: 0.25 % where c_B is 1e-5.
TEST(HomogeniseSheet, TakesNoForcesThatBendingFeels) {
  Specimen s = sheet({1, 0, 0}, {0, 1, 0}, {{0, 0, 0}}, 1.01, {1.0, 0.35, 1e-5, 1e-5});
  EXPECT_NO_THROW(homogenise_sheet(s.model, s.state));
  for (Bond& b : s.state.bonds) b.a *= 1.0 + 1e-7;
  EXPECT_THROW(homogenise_sheet(s.model, s.state), std::invalid_argument);
}

// The same sheet in another plane of the world: 1 and 2 are y and z, or z and x, wherever edges lead.
TEST(HomogeniseSheet, MayLieInAnyPlaneOfTwoAxes) {
  const std::vector<Vec3d> r{{0.1, 0.2, 0.0}, {0.8, 0.7, 0.4}, {0.3, 0.9, 1.1}};
  const Specimen s = sheet({1.3, 0.2, 0}, {-0.1, 1.2, 0}, r, 1.45, c);
  const HomogenisedSheet found = homogenise_sheet(s.model, s.state);
  for (const int turns : {1, 2}) {
    const auto turned = [turns](const Vec3d& x) {
      return turns == 1 ? Vec3d{x.z, x.x, x.y} : Vec3d{x.y, x.z, x.x};
    };
    Specimen t = s;
    std::vector<Vec3d> there;
    for (const Vec3d& x : r) there.push_back(turned(x));
    t.model = equal_particles(there, 1.0, 0.064, 0.4);
    t.model.cell = {{turned(50.0 * Vec3d{0, 0, 1}), turned({1.3, 0.2, 0}), turned({-0.1, 1.2, 0})},
                    {false, true, true},
                    {},
                    false};
    t.state = at_rest(t.model);
    BondRecipe recipe;
    recipe.parameters = c;
    bond_within(t, 1.45, recipe);
    ASSERT_EQ(t.state.bonds.size(), s.state.bonds.size());
    const HomogenisedSheet other = homogenise_sheet(t.model, t.state);
    EXPECT_LT(norm(other.axes[2] - turned({0, 0, 1})), 1e-15);
    EXPECT_LT(norm(other.axes[0] - turned({1, 0, 0})), 1e-15);
    EXPECT_LT(difference(other.A, found.A), 1e-12);
    EXPECT_LT(difference(other.B, found.B), 1e-12);
    EXPECT_LT(difference(other.D, found.D), 1e-12);
  }
}

void expect_refused(const Specimen& s, const std::string& because) {
  try {
    homogenise_sheet(s.model, s.state);
    FAIL() << "not refused: " << because;
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find(because), std::string::npos) << e.what();
  }
}

TEST(HomogeniseSheet, RefusesWhatIsNoPlate) {
  const std::vector<Vec3d> r{{0, 0, 0}};
  const Specimen good = sheet({1, 0, 0}, {0, 1, 0}, r, 1.01, c);
  Specimen chain = good;
  chain.model.cell.periodic[1] = false;
  expect_refused(chain, "periodic in two directions");
  expect_refused(sheet({1, 0, 0}, {0, 1, 0.5}, r, 1.2, c), "turn the sheet");
  expect_refused(sheet({1, 0, 0}, {0, 2, 0}, {{0, 0, 0}, {0, 1, 0}}, 1.01, {1, 0, 0, 0}), "no stiffness");
  Specimen strained = good;
  strained.state.cell[0].along = {1.01, 0, 0};
  expect_refused(strained, "is strained");
  Specimen touching = sheet({1, 0, 0}, {0, 1, 0}, {{0, 0, 0}, {0.3, 0.2, 1.2}}, 1.01, c);
  touching.model.radius[ParticleId{1}] = 0.95;
  touching.model.contact.law = ContactLaw::linear, touching.model.contact.k = 1.0;
  expect_refused(touching, "touch and press");
}

// ---- curved --------------------------------------------------------------------------------

/// A sheet whose plane is strained by s e and then curved by s times a curvature: images are where finite
/// rigid motions take them. Energy of its bonds in a cell, with particles moved.
class Curved {
 public:
  /// Rolled onto a cylinder, with k along a direction.
  Curved(const Specimen& s, const std::array<double, 3>& e, double k, double angle, double plane)
      : s_(s), e_(e), k_(k), along_{std::cos(angle), std::sin(angle), 0}, plane_(plane) {}
  /// With any curvature K. No surface is so by more than first order, and a body at rest needs no more: half
  /// of the way to an image, the turn, and the other half; backwards it is the motion of the opposite image.
  Curved(const Specimen& s, const std::array<double, 3>& e, const std::array<double, 3>& K, double plane)
      : s_(s), e_(e), K_(K), plane_(plane) {}

  std::size_t size() const { return 6 * s_.model.particles() + 1; }
  double energy(const Eigen::VectorXd& x) const {
    const double by = x[Eigen::Index(size()) - 1];
    PerParticle<Vec3d> r = s_.state.r;
    PerParticle<Quatd> q = s_.state.q;
    for (const ParticleId p : r.ids()) {
      const auto at = Eigen::Index(6 * p.value);
      r[p] += Vec3d{x[at], x[at + 1], x[at + 2]};
      q[p] = rotation_of({x[at + 3], x[at + 4], x[at + 5]}) * q[p];
    }
    double U = 0.0;
    for (const Bond& b : s_.state.bonds) {
      const Vec3d flat = to_image(s_.state.cell, image_of_j(b)),
                  L = flat + by * Vec3d{e_[0] * flat.x + 0.5 * e_[2] * flat.y,
                                        0.5 * e_[2] * flat.x + e_[1] * flat.y, 0};
      const auto [there, turn] = K_ ? curved(L, r[b.j], by) : rolled(L, r[b.j], by);
      const BondEnergy<double> of =
          b.law->energy(b, bond_pose(b, there - r[b.i], q[b.i], turn * q[b.j]), no_history);
      U += of.U_L + of.U_B + of.U_T;
    }
    return U;
  }

  /// The second derivative with s, particles in balance; nothing if it cannot be told what costs nothing.
  std::optional<double> stiffness() const {
    const auto n = Eigen::Index(size());
    constexpr double h = 3e-4;
    Eigen::MatrixXd H(n, n);
    const auto at = [&](Eigen::Index i, double a, Eigen::Index j, double b) {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
      x[i] += a, x[j] += b;
      return energy(x);
    };
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j <= i; ++j)
        H(i, j) = H(j, i) =
            (at(i, h, j, h) - at(i, h, j, -h) - at(i, -h, j, h) + at(i, -h, j, -h)) / (4 * h * h);
    const DenseEigen e = dense_eigenpairs(H.topLeftCorner(n - 1, n - 1));
    double S = H(n - 1, n - 1);
    for (Eigen::Index k = 0; k < n - 1; ++k) {
      const double part = e.vectors.col(k).dot(H.col(n - 1).head(n - 1)), value = e.values[k];
      if (value > 1e-4) S -= part * part / value;
      if (value > 1e-6 && value < 1e-4) return std::nullopt;
    }
    return S;
  }

 private:
  using Placed = std::pair<Vec3d, Quatd>;
  Placed rolled(const Vec3d& L, const Vec3d& r, double by) const {
    const Vec3d axis = cross(Vec3d{0, 0, 1}, along_);
    const double k = by * k_, round = dot(L, along_);
    const Quatd turn = rotation_of(k * round * axis);
    if (k == 0.0) return {r + L, turn};
    const Vec3d pivot{0, 0, plane_ - 1.0 / k};
    return {pivot + rotate(turn, r - pivot) + dot(L, axis) * axis, turn};
  }
  Placed curved(const Vec3d& L, const Vec3d& r, double by) const {
    const auto& [k11, k22, k12_twice] = *K_;
    const Vec3d kL{k11 * L.x + 0.5 * k12_twice * L.y, 0.5 * k12_twice * L.x + k22 * L.y, 0},
        pivot{0, 0, plane_}, half = 0.5 * L;
    const Quatd turn = rotation_of(by * cross(Vec3d{0, 0, 1}, kL));
    return {pivot + rotate(turn, r + half - pivot) + half, turn};
  }

  const Specimen& s_;
  std::array<double, 3> e_;
  std::optional<std::array<double, 3>> K_;
  double k_ = 0.0;
  Vec3d along_;
  double plane_;
};

// Independent of all that statics knows: images of finite motions, energies alone, their differences. Of
// curvatures a cylinder has those along one direction, and does not tell D_12 from D_66; the other way does.
testing::Verdict judge(unsigned seed, testing::Tally& tally) {
  Dice dice(seed);
  const std::size_t n = dice.count(1, 5);
  const double side = std::sqrt(double(n)) * dice(0.8, 1.1);
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) r.push_back({dice(0, side), dice(0, side), dice(0.0, 1.2)});
  Specimen s = sheet({side, 0, 0}, {dice(-0.4, 0.4) * side, side * dice(0.8, 1.2), 0}, r,
                     side * dice(1.0, 1.2) + 0.3, {1, 1, 1, 1});
  for (std::size_t k = 0; k < n; ++k) s.model.mass[ParticleId{k}] = dice(0.5, 2);
  const bool evm = dice.chance(0.5);
  for (Bond& b : s.state.bonds) {
    if (evm) b.law = &bond_law<Evm>;
    b.coefficients = b.law->from_stiffness(
        {dice.ratio(0.3, 3), dice.ratio(0.1, 3), dice.ratio(0.03, 1), dice.ratio(0.03, 1)}, b.a, {});
  }
  std::optional<HomogenisedSheet> found;
  try {
    found = homogenise_sheet(s.model, s.state);
  } catch (const NoEquilibrium&) {
    return {"refused", {}};
  }
  for (int way = 0; way < 4; ++way) {
    const std::array<double, 3> e{dice(-1, 1), dice(-1, 1), dice(-1, 1)};
    const double k = dice(-1, 1), angle = dice(0, M_PI);
    std::array<double, 3> K{k * sq(std::cos(angle)), k * sq(std::sin(angle)), k * std::sin(2 * angle)};
    if (way > 1) K = {dice(-1, 1), dice(-1, 1), dice(-1, 1)};
    double U = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        U += e[i] * found->A[i][j] * e[j] + 2 * e[i] * found->B[i][j] * K[j] + K[i] * found->D[i][j] * K[j];
    const Curved curved = way > 1 ? Curved(s, e, K, found->plane) : Curved(s, e, k, angle, found->plane);
    const auto stiffness = curved.stiffness();
    if (!stiffness) return {"given up", {}};
    const double off = std::abs(*stiffness / found->area - U) / std::max(U, 1e-2);
    if (!(off < 1e-4)) return testing::wrong("off by " + std::to_string(off));
    tally.most("difference", off);
  }
  return {};
}

TEST(HomogeniseSheet, CampaignOfRandomSheetsThatAreCurved) {
  const testing::Tally all = testing::campaign("sheets", 20, judge);
  EXPECT_EQ(all["wrong"] + all["aborted"], 0u);
  EXPECT_GE(all["right"], all.cases / 2);
}

}  // namespace
}  // namespace vbond::homogenise_sheet_test
