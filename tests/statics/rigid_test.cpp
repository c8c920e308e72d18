#include "vbond/statics/detail/rigid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace vbond {
namespace {

// Coordinates of order 1 to 10, sums of tens of terms.
constexpr double rounding = 1e-13;
constexpr double turn_length = 0.7;

struct Body {
  Model model;
  State state;
  std::vector<Support> supports;

  explicit Body(const std::vector<Vec3d>& r)
      : model(equal_particles(r, 1.0, 0.1, 0.5)), state(at_rest(model)) {}
  void bond(std::size_t i, std::size_t j) {
    Bond b;
    b.i = ParticleId{i};
    b.j = ParticleId{j};
    state.bonds.push_back(b);
  }
  void hold(std::size_t p, HeldDofs dofs) { supports.push_back({"", {ParticleId{p}}, dofs, {}, {}}); }
  Unknowns unknowns() const { return {model.particles(), supports, turn_length}; }
  RigidMotions motions() const { return free_rigid_motions(model, state, unknowns()); }
};

constexpr HeldDofs pin = {true, true, true, false, false, false};
constexpr HeldDofs clamp = {true, true, true, true, true, true};

/// Particles 0..n-1, a chain along a direction, not at the origin.
Body chain(std::size_t n, const Vec3d& along) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < n; ++k) r.push_back(Vec3d{3.0, -2.0, 1.0} + static_cast<double>(k) * along);
  Body b(r);
  for (std::size_t k = 1; k < n; ++k) b.bond(k - 1, k);
  return b;
}

double component_of(const Body& b, const Vector& x, ParticleId p, int dof) {
  const int unknown = b.unknowns().of(p, dof);
  return unknown == Unknowns::held ? 0.0 : x[unknown] / (dof < 3 ? 1.0 : turn_length);
}

/// Orthonormal, and each column moves bonded particles as one body: the same turn w, u_j - u_i = w x r_ij.
void expect_rigid(const Body& b, const RigidMotions& m) {
  const DenseMatrix B(m.basis);
  ASSERT_EQ(static_cast<std::size_t>(B.cols()), m.names.size());
  EXPECT_LT((B.transpose() * B - DenseMatrix::Identity(B.cols(), B.cols())).norm(), rounding);
  for (Eigen::Index k = 0; k < B.cols(); ++k)
    for (const Bond& bond : b.state.bonds) {
      Vec3d u_i, u_j, w_i, w_j;
      for (int c = 0; c < 3; ++c) {
        component(u_i, c) = component_of(b, B.col(k), bond.i, c);
        component(u_j, c) = component_of(b, B.col(k), bond.j, c);
        component(w_i, c) = component_of(b, B.col(k), bond.i, 3 + c);
        component(w_j, c) = component_of(b, B.col(k), bond.j, 3 + c);
      }
      EXPECT_LT(norm(w_j - w_i), rounding);
      EXPECT_LT(norm(u_j - u_i - cross(w_i, b.state.r[bond.j] - b.state.r[bond.i])), rounding);
    }
}

using Names = std::vector<std::string>;

TEST(RigidMotions, OfAFreeChainAreSixThoughItIsStraight) {
  const Body b = chain(10, {0.6, 0.8, 0.0});
  const RigidMotions m = b.motions();
  expect_rigid(b, m);
  const Names expected = {
      "translation along x of particles 0 to 9", "translation along y of particles 0 to 9",
      "translation along z of particles 0 to 9", "rotation about x of particles 0 to 9",
      "rotation about y of particles 0 to 9",    "rotation about z of particles 0 to 9"};
  EXPECT_EQ(m.names, expected);
}

TEST(RigidMotions, AreThoseThatSupportsLeave) {
  Body pinned = chain(10, {0.6, 0.8, 0.0});
  pinned.hold(0, pin);
  expect_rigid(pinned, pinned.motions());
  EXPECT_EQ(pinned.motions().names.size(), 3u);
  pinned.hold(9, pin);
  expect_rigid(pinned, pinned.motions());
  EXPECT_EQ(pinned.motions().names, Names{"rotation about (0.6, 0.8, 0) of particles 0 to 9"});
  pinned.hold(4, {false, false, true, false, false, false});  // on the axis: holds nothing more
  expect_rigid(pinned, pinned.motions());
  EXPECT_EQ(pinned.motions().names, Names{"rotation about (0.6, 0.8, 0) of particles 0 to 9"});
  pinned.hold(4, {false, false, false, true, false, false});
  EXPECT_EQ(pinned.motions().names, Names{});

  Body clamped = chain(10, {1.0, 0.0, 0.0});
  clamped.hold(3, clamp);
  EXPECT_EQ(clamped.motions().basis.cols(), 0);
}

TEST(RigidMotions, OfABodyOnAPlaneStayInIt) {
  Body b = chain(5, {1.0, 0.0, 0.0});
  b.hold(2, {false, false, true, true, true, false});
  const RigidMotions m = b.motions();
  expect_rigid(b, m);
  const Names expected = {"translation along x of particles 0 to 4",
                          "translation along y of particles 0 to 4", "rotation about z of particles 0 to 4"};
  EXPECT_EQ(m.names, expected);
}

// Held components: x at (0,0,2), y at (0,0,1), z at (1,0,0) and (0,1,0), and the turn about z. With the turn
// w = (1,-1,0) that asks for the translation u = (2,1,-1), u.w = 1: no axis stays in place.
TEST(RigidMotions, MayBeAScrew) {
  Body b({{0, 0, 2}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, -3}});
  for (std::size_t k = 1; k < 5; ++k) b.bond(0, k);
  b.hold(0, {true, false, false, false, false, false});
  b.hold(1, {false, true, false, false, false, false});
  for (const std::size_t k : {2u, 3u}) b.hold(k, {false, false, true, false, false, false});
  b.hold(4, {false, false, false, false, false, true});
  const RigidMotions m = b.motions();
  expect_rigid(b, m);
  EXPECT_EQ(m.names, Names{"screw motion about (0.707, -0.707, 0) of particles 0 to 4"});
}

TEST(RigidMotions, AreThoseOfEachPart) {
  Body b({{0, 0, 0}, {5, 0, 0}, {1, 0, 0}, {6, 0, 0}, {2, 0, 0}, {5, 1.5, 0}});
  b.bond(0, 2);
  b.bond(2, 4);
  b.bond(3, 1);
  b.hold(0, clamp);
  b.hold(5, pin);
  RigidMotions m = b.motions();
  expect_rigid(b, m);
  ASSERT_EQ(m.names.size(), 9u);
  EXPECT_EQ(m.names[0], "translation along x of particles 1 and 3");
  EXPECT_EQ(m.names[8], "rotation about z of particle 5");

  b.model.contact.law = ContactLaw::paper_hertz;
  b.model.contact.c_H = 1.0;
  b.state.r[ParticleId{5}] = {5.0, 0.9, 0.0};  // touches particle 1
  m = b.motions();
  ASSERT_EQ(m.names.size(), 6u);
  EXPECT_EQ(m.names[0], "rotation about x of the 3 particles from 1 to 5 that hang together");
  EXPECT_EQ(m.names[3], "rotation about x of particle 5");  // no bond turns it along
}

/// Balls that touch in a row, all of whose turns nothing drives or resists.
Names motions_of_balls(std::size_t number, const std::vector<Support>& supports) {
  Body b(chain(number, {0.0, 0.0, 0.9}));
  b.state.bonds = PerBond<Bond>();
  b.model.contact.law = ContactLaw::paper_hertz;
  b.model.contact.c_H = 1.0;
  std::vector<Unknowns::Place> idle;
  for (const ParticleId p : b.model.mass.ids())
    for (const int dof : {3, 4, 5}) idle.push_back({p, dof});
  const Unknowns unknowns(number, supports, turn_length, {}, idle);
  const RigidMotions m = free_rigid_motions(b.model, b.state, unknowns);
  EXPECT_EQ(static_cast<std::size_t>(m.basis.cols()), m.names.size());
  return m.names;
}

// No turn about the line through their centres moves these. What holds all of one is taken to hold the row.
TEST(RigidMotions, OfBallsThatTouchAreThoseOfTheirCentres) {
  EXPECT_EQ(motions_of_balls(1, {}),
            (Names{"translation along x of particle 0", "translation along y of particle 0",
                   "translation along z of particle 0"}));
  EXPECT_EQ(motions_of_balls(3, {}),
            (Names{"translation along x of particles 0 to 2", "translation along y of particles 0 to 2",
                   "translation along z of particles 0 to 2", "rotation about x of particles 0 to 2",
                   "rotation about y of particles 0 to 2"}));
  EXPECT_EQ(motions_of_balls(3, {{"", {ParticleId{0}}, pin, {}, {}}}),
            (Names{"rotation about x of particles 0 to 2", "rotation about y of particles 0 to 2"}));
  EXPECT_EQ(motions_of_balls(3, {{"", {ParticleId{0}}, clamp, {}, {}}}), Names{});
}

// By their numbers: one, a run, two with others between, and more of them.
TEST(RigidMotions, AreNamedByTheParticlesThatMove) {
  Body b({{0, 0, 0},
          {5, 0, 0},
          {6, 0, 0},
          {7, 0, 0},
          {20, 0, 0},
          {30, 0, 0},
          {21, 0, 0},
          {31, 0, 0},
          {32, 0, 0}});
  b.bond(1, 2), b.bond(2, 3), b.bond(4, 6), b.bond(5, 7), b.bond(7, 8);
  const Names names = b.motions().names;
  ASSERT_EQ(names.size(), 24u);
  EXPECT_EQ(names[0], "translation along x of particle 0");
  EXPECT_EQ(names[6], "translation along x of particles 1 to 3");
  EXPECT_EQ(names[12], "translation along x of particles 4 and 6");
  EXPECT_EQ(names[18], "translation along x of the 3 particles from 5 to 8 that hang together");
}

// Three pins off a line by 1e-6 of the length hold a body, by 1e-9 they do not: then its stiffness, 1e-18 of
// that of bonds, is lost in rounding.
TEST(RigidMotions, AreHeldByALeverThatTheTangentCanTell) {
  for (const double lever : {1e-6, 1e-9}) {
    Body b({{0, 0, 0}, {1, lever, 0}, {2, 0, 0}});
    b.bond(0, 1);
    b.bond(1, 2);
    for (const std::size_t k : {0u, 1u, 2u}) b.hold(k, pin);
    EXPECT_EQ(b.motions().names.size(), lever > 1e-8 ? 0u : 1u) << lever;
  }
}

// A dense basis of 20000 loose particles would have 1.4e10 entries.
TEST(RigidMotions, OfManyLoosePartsAreSparse) {
  std::vector<Vec3d> r;
  for (int k = 0; k < 20000; ++k) r.push_back({2.0 * k, 0.0, 0.0});
  const Body b(r);
  const RigidMotions m = b.motions();
  EXPECT_EQ(m.basis.cols(), 120000);
  EXPECT_EQ(m.basis.nonZeros(), 120000);
}

TEST(Orthonormalised, SpansTheSame) {
  Body b = chain(6, {0.6, 0.0, 0.8});
  SparseMatrix scaled = b.motions().basis;
  const auto scale = [](Eigen::Index row) { return 1.0 + 0.1 * static_cast<double>(row); };
  for (int j = 0; j < scaled.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(scaled, j); it; ++it) it.valueRef() *= scale(it.row());
  const DenseMatrix Q(orthonormalised(scaled)), S(scaled);
  EXPECT_LT((Q.transpose() * Q - DenseMatrix::Identity(6, 6)).norm(), rounding);
  EXPECT_LT((S - Q * (Q.transpose() * S)).norm(), rounding * S.norm());
  scaled.col(3) = 2.0 * scaled.col(1);
  EXPECT_THROW(orthonormalised(scaled), std::invalid_argument);
}

}  // namespace
}  // namespace vbond
