// Bodies that stand at a kink: bonds at rest with two slopes, contacts of finite stiffness that just touch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "periodic.hpp"
#include "validation/cases.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/statics/homogenise.hpp"

namespace vbond::kinks_test {
namespace {

using testing::Specimen;

constexpr double c_A = 1.0, c_D = 0.3, k = 3.0;  // of bonds, and of contacts

BondRecipe recipe() {
  BondRecipe r;
  r.parameters = BondStiffness<double>{c_A, c_D, 0.05, 0.05};
  return r;
}

ContactModel all_touch(ContactLaw law = ContactLaw::linear) {
  ContactModel contact{.law = law, .pairs = ContactPairs::all};
  contact.k = k, contact.c_H = k;
  return contact;
}

Specimen with_two_slopes(Specimen s, double compression) {
  BondRules rules;
  rules.stretch.form = StretchForm::two_slopes, rules.stretch.compression = compression;
  for (Bond& b : s.state.bonds) b.law = with_rules(*b.law, rules), b.rules = &kept(rules);
  return s;
}

/// Six bonded particles in a row, turned and shifted, that overlap by this.
Specimen touching_rod(const Vec3d& along, const Vec3d& origin, double overlap,
                      ContactLaw law = ContactLaw::linear) {
  std::vector<Vec3d> r;
  for (int p = 0; p < 6; ++p) r.push_back(origin + double(p) * along);
  Specimen s = testing::particles_at(r, 0.5 + 0.5 * overlap, 0.1);
  for (std::size_t p = 0; p + 1 < 6; ++p) testing::bond(s, p, p + 1, recipe());
  s.model.contact = all_touch(law);
  return s;
}

double highest_frequency(const Specimen& s, std::vector<PointLoad> loads = {}) {
  StaticStage stage = testing::static_stage(
      StageKind::modes, {testing::fixed({ParticleId{0}}, testing::clamped)}, std::move(loads));
  stage.count = 30;
  return run_static_stage(s.model, stage, s.state, {}).result.modes.back().omega;
}

/// Of a chain that is clamped at one end.
double axial_frequency(double stiffness) {
  return 2.0 * std::sqrt(stiffness) * std::sin(9.0 * M_PI / 22.0);
}

template <class Look>
void expect_refused(const Look& look, const std::string& because) {
  try {
    look();
    ADD_FAILURE() << "not refused: " << because;
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find(because), std::string::npos) << e.what();
  }
}

TEST(Kinks, OfContactsThatJustTouchAreRefusedByModesWhateverRoundingMakesOfThem) {
  testing::Dice dice(5);
  for (int n = 0; n < 40; ++n) {
    const Vec3d along = n == 0 ? Vec3d{1, 0, 0} : dice.direction(),
                origin = dice.vector(n % 2 == 0 ? 0 : 100);
    expect_refused([&] { highest_frequency(touching_rod(along, origin, 0.0)); }, "just touch, to rounding");
    // to either side there is one stiffness: rounding of places, 1e-14, over the overlap is left
    EXPECT_NEAR(highest_frequency(touching_rod(along, origin, -1e-8)), axial_frequency(c_A), 1e-5);
    EXPECT_NEAR(highest_frequency(touching_rod(along, origin, 1e-8)), axial_frequency(c_A + k), 1e-5);
  }
  const Specimen hertz = touching_rod({1, 0, 0}, {}, 0.0, ContactLaw::paper_hertz);
  EXPECT_NEAR(highest_frequency(hertz), axial_frequency(c_A), 1e-5);
  Specimen apart = touching_rod({1, 0, 0}, {}, 0.0);
  apart.model.contact.pairs = ContactPairs::unbonded;
  EXPECT_NEAR(highest_frequency(apart), axial_frequency(c_A), 1e-5);
}

// Nothing that stands still matters.
TEST(Kinks, BetweenParticlesThatAreHeldAreNone) {
  Specimen s = touching_rod({1, 0, 0}, {}, 0.0);
  for (std::size_t p = 2; p < 6; ++p) s.model.radius[ParticleId{p}] = 0.4;
  EXPECT_THROW(highest_frequency(s), NoEquilibrium);
  StaticStage stage = testing::static_stage(
      StageKind::modes, {testing::fixed({ParticleId{0}, ParticleId{1}}, testing::clamped)});
  EXPECT_EQ(run_static_stage(s.model, stage, s.state, {}).result.ended, "converged");
}

/// A cubic lattice of 27, turned and shifted. Its constants are those of springs between neighbours, one in
/// each direction: C_xx = c_A, C_xy = 0, C_44 = c_D/2.
Specimen lattice(const Quatd& turn, const Vec3d& shift, double overlap) {
  std::vector<Vec3d> r;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z) r.push_back(shift + rotate(turn, Vec3d{1.0 * x, 1.0 * y, 1.0 * z}));
  const auto edge = [&](const Vec3d& e) { return rotate(turn, 3.0 * e); };
  Specimen s =
      testing::periodic_body({edge({1, 0, 0}), edge({0, 1, 0}), edge({0, 0, 1})}, r, 0.5 + 0.5 * overlap);
  testing::bond_within(s, 1.01, recipe());
  s.model.contact = all_touch();
  return s;
}

TEST(Kinks, OfLatticesAreRefusedByHomogeniseHoweverTheyAreTurned) {
  testing::Dice dice(6);
  for (int n = 0; n < 25; ++n) {
    const Quatd turn = n == 0 ? Quatd{} : rotation_of(dice.vector(3.0));
    const Vec3d shift = dice.vector(n % 2 == 0 ? 0 : 100);
    expect_refused(
        [&] {
          const Specimen s = lattice(turn, shift, 0.0);
          homogenise(s.model, s.state);
        },
        "just touch, to rounding");
    for (const double overlap : {-1e-8, 1e-8}) {
      const Specimen s = lattice(turn, shift, overlap);
      const Constants C = homogenise(s.model, s.state).C;
      double sum = 0.0, squares = 0.0;  // C_iijj and C_ijij do not change by turns
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) sum += C[i][j];
        squares += C[i][i] + 2.0 * C[3 + i][3 + i];
      }
      const double axial = overlap > 0.0 ? c_A + k : c_A;
      EXPECT_NEAR(sum, 3.0 * axial, 1e-6) << n;
      EXPECT_NEAR(squares, 3.0 * axial + 3.0 * c_D, 1e-6) << n;
    }
  }
}

TEST(Kinks, OfBondsWithTwoSlopesAreRefusedByModes) {
  Specimen rod = touching_rod({1, 0, 0}, {}, 0.0);
  rod.model.contact = {};
  EXPECT_NEAR(highest_frequency(rod), axial_frequency(c_A), 1e-9);
  for (const double compression : {0.25, 25.0}) {
    const Specimen s = with_two_slopes(rod, compression);
    expect_refused([&] { highest_frequency(s); }, "slopes in tension and compression");
    // bent across they are at rest along their axes
    expect_refused(
        [&] {
          highest_frequency(with_two_slopes(rod, compression), {testing::pushed(5, {}, {1e-4, 0, 0})});
        },
        "slopes in tension and compression");
  }
  // to either side of rest there is one slope, and strains of 1e-6
  const Specimen s = with_two_slopes(rod, 25.0);
  EXPECT_NEAR(highest_frequency(s, {testing::pushed(5, {1e-6, 0, 0})}), axial_frequency(c_A), 1e-5);
  EXPECT_NEAR(highest_frequency(s, {testing::pushed(5, {-1e-6, 0, 0})}), axial_frequency(25.0 * c_A), 1e-5);
  EXPECT_NEAR(highest_frequency(with_two_slopes(rod, 1.0)), axial_frequency(c_A), 1e-9);
}

// The fastest motion of a free chain of six is 2 sqrt(c) sin(75 degrees).
TEST(Kinks, TakeTheStifferSideInTheExactStep) {
  const auto step_of = [](double stiffness) {
    return 1.0 / (std::sqrt(stiffness) * std::sin(5.0 * M_PI / 12));
  };
  testing::Dice dice(7);
  for (int n = 0; n < 40; ++n) {
    const Vec3d along = n == 0 ? Vec3d{1, 0, 0} : dice.direction(),
                origin = dice.vector(n % 2 == 0 ? 0 : 100);
    const Specimen s = touching_rod(along, origin, 0.0);
    EXPECT_NEAR(exact_critical_step(s.model, s.state, {}) / step_of(c_A + k), 1.0, 1e-9);
  }
  const Specimen rod = testing::straight_rod(6, recipe());
  for (const double compression : {4.0, 25.0}) {
    const Specimen s = with_two_slopes(rod, compression);
    EXPECT_NEAR(exact_critical_step(s.model, s.state, {}) / step_of(compression), 1.0, 1e-9);
  }
  const Specimen soft = with_two_slopes(rod, 0.25);
  EXPECT_EQ(exact_critical_step(soft.model, soft.state, {}), exact_critical_step(rod.model, rod.state, {}));
}

}  // namespace
}  // namespace vbond::kinks_test
