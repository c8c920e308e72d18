// Bonds that yield, one at a time, driven by hand: against closed forms of materials.json.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "driven_bond.hpp"
#include "material_cases.hpp"
#include "random_pose.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond::flowing_test {
namespace {

// ---- PL1: axial cycles, any size of step -------------------------------------------------------------

TYPED_TEST(FlowingBond, FollowsAxialCyclesExactlyInAnyNumberOfSteps) {
  for (const std::string id : {"PL1a", "PL1b", "PL1c"})
    for (const int steps : {1, 7, 100}) {
      const nlohmann::json c = testing::material_case(id);
      const auto& setup = c["setup"];
      BondRules rules;
      rules.yield.limit.axial = rules.yield.compression = setup["N_y"];
      rules.yield.isotropic.axial = setup["H_iso"];
      rules.yield.kinematic.axial = setup["H_kin"];
      Driven<TypeParam> bond(rules);
      double u = 0.0;
      for (const auto& row : c["expected"]["rows"]) {
        const double from = u, to = row["u"];
        for (int k = 1; k <= steps; ++k) {
          u = from + (to - from) * k / steps;
          bond.move_to(pose_of(1.0 + u, {}, {}));
        }
        u = to;
        const double stored = row["back_stress_energy"], work = row["plastic_work"];
        EXPECT_NEAR(tension(bond.law, 1.0 + u, bond.h), row["N"], 1e-12) << id << ", u = " << u;
        EXPECT_NEAR(bond[memory::stretch], row["u_p"], 1e-12);
        EXPECT_NEAR(bond[memory::axial], row["alpha"], 1e-12);
        EXPECT_NEAR(bond[memory::dissipated], work - stored, 1e-12);
        EXPECT_NEAR(bond.energy(pose_of(1.0 + u, {}, {})), 0.5 * std::pow(row["N"].get<double>(), 2) + stored,
                    1e-12);
      }
    }
}

TYPED_TEST(FlowingBond, MayYieldEarlierInCompression) {
  BondRules rules;
  rules.yield.limit.axial = 0.02, rules.yield.compression = 0.01;
  Driven<TypeParam> bond(rules);
  bond.move_to(pose_of(0.95, {}, {}));
  EXPECT_NEAR(tension(bond.law, 0.95, bond.h), -0.01, 1e-15);
  bond.move_to(pose_of(1.05, {}, {}));
  EXPECT_NEAR(tension(bond.law, 1.05, bond.h), 0.02, 1e-15);
}

// ---- PL2, PL2t: bending and twist --------------------------------------------------------------------

/// Turns the ends by -t/2 and t/2 about an axis through the turning points, and gives what `see` sees there.
template <class Law, class See>
void turn_to_and_fro(Driven<Law>& bond, const Vec3d& axis, const std::vector<double>& points, int steps,
                     See see) {
  double t = 0.0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const double from = t;
    for (int k = 1; k <= steps; ++k) {
      t = from + (points[n] - from) * k / steps;
      bond.move_to(pose_of(1.0, about(axis, -0.5 * t), about(axis, 0.5 * t)));
    }
    see(n, pose_of(1.0, about(axis, -0.5 * t), about(axis, 0.5 * t)));
  }
}
/// The relative turn of the frames about an axis.
template <class Law>
double flowed_angle(const Driven<Law>& bond, const Vec3d& axis) {
  const FlowTurns<double> q = turns_of<Law>(bond.h);
  return dot(axis, rotation_vector(q.i)) - dot(axis, rotation_vector(q.j));
}

TYPED_TEST(FlowingBond, BendsToAndFroAtItsYieldMoment) {
  const nlohmann::json c = testing::material_case("PL2");
  const auto& expected =
      c["expected"][std::is_same_v<TypeParam, WithFlow<Evm>::Law<double>> ? "evm" : "vmodel"];
  BondRules rules;
  rules.yield.limit.bending = 8e-4;
  for (const double sign : {1.0, -1.0})
    for (const Vec3d& axis : {unit_z, unit_y}) {
      Driven<TypeParam> bond(rules);
      turn_to_and_fro(bond, sign * axis, c["expected"]["turning_points"], 250,
                      [&](std::size_t n, const auto& b) {
                        const auto& row = expected["rows"][n];
                        EXPECT_NEAR(dot(bond.moments(b).middle, sign * axis), row["moment"], 1e-9 * 8e-4);
                        EXPECT_NEAR(flowed_angle(bond, sign * axis), row["plastic_angle"], 1e-7);
                        EXPECT_NEAR(bond[memory::dissipated], row["dissipated"], 1e-6);
                      });
    }
}

TYPED_TEST(FlowingBond, TwistsFarPastARightAngleWithoutSnapping) {
  if constexpr (std::is_same_v<TypeParam, WithFlow<VModel>::Law<double>>) {
    const nlohmann::json c = testing::material_case("PL2t");
    BondRules rules;
    rules.yield.limit.torsion = 4e-4;
    Driven<TypeParam> bond(rules);
    turn_to_and_fro(bond, unit_x, {2.5, -2.5, 0.0}, 500, [&](std::size_t n, const auto& b) {
      const auto& row = c["expected"]["rows"][n];
      EXPECT_NEAR(dot(bond.moments(b).middle, unit_x), row["torque"], 1e-9 * 4e-4);
      EXPECT_NEAR(flowed_angle(bond, unit_x), row["plastic_angle"], 1e-6);
      EXPECT_NEAR(bond[memory::dissipated], row["dissipated"], 1e-6);
      EXPECT_EQ(bond_range(bond.law, bond_shape(elastic_pose(bond.law, b, bond.h), 0, 0)), BondRange::good);
    });
  }
}

// ---- shear, hardening ---------------------------------------------------------------------------------

/// End i turned by t about z, j held back so that only shear is left: both ends turned alike by t.
BondPose<double> sheared(double t) {
  return pose_of(1.0, about(unit_z, t), about(unit_z, t));
}

TYPED_TEST(FlowingBond, SlidesAtItsYieldForce) {
  BondRules rules;
  rules.yield.limit.shear = 2e-3;
  Driven<TypeParam> bond(rules);
  double plastic_work = 0.0, V = 0.0;
  for (int k = 1; k <= 200; ++k) {
    bond.move_to(sheared(1e-3 * k));
    const double before = V;
    V = -bond.loads(sheared(1e-3 * k)).F.y;
    plastic_work += 0.5 * (before + V) * 1e-3;
  }
  EXPECT_NEAR(std::abs(V), 2e-3, 1e-14);
  EXPECT_NEAR(bond[memory::shear], 0.2 - 2e-3 / slender.c_D, 2e-3);  // the V-model's sine: 1e-3
  EXPECT_NEAR(bond[memory::dissipated] + bond.energy(sheared(0.2)), std::abs(plastic_work), 1e-7);
}

// One material, hardening in bending and torsion: the moment grows from the limit on by c H/(c + H), and what
// is stored can be had back.
TYPED_TEST(FlowingBond, HardensInBendingAndTorsion) {
  for (const bool kinematic : {false, true})
    for (const Vec3d& axis : {unit_x, unit_z}) {
      const bool twists = axis == unit_x;
      const double H = 2e-4, small = 1e-5, c = twists ? slender.c_T : slender.c_B;
      BondRules rules;
      rules.yield.limit.bending = rules.yield.limit.torsion = c * small;
      (kinematic ? rules.yield.kinematic : rules.yield.isotropic).bending = H;
      (kinematic ? rules.yield.kinematic : rules.yield.isotropic).torsion = H;
      Driven<TypeParam> bond(rules);
      turn_to_and_fro(bond, axis, {3.0 * small, -3.0 * small}, 10, [&](std::size_t n, const auto& b) {
        // small turns: linear, to 1e-10 of it
        const double x = 2.0 * small * c / (c + H), M = dot(bond.moments(b).middle, axis);
        const double limit = c * small + H * x;
        const double back = 6.0 * small - 2.0 * (kinematic ? c * small : limit) / c;
        const double second = back * c / (c + H);
        const double expected = n == 0 ? limit : kinematic ? -limit : -(limit + H * second);
        EXPECT_NEAR(M, expected, 1e-7 * limit) << kinematic << ", twisted: " << twists << ", " << n;
        const double elastic = 0.5 * M * M / c, shift = twists ? bond[memory::twisted] : 0.0;
        const double bent = twists ? 0.0 : std::hypot(bond[memory::bent], bond[memory::bent + 1]);
        EXPECT_NEAR(bond.energy(b), elastic + (kinematic ? 0.5 * H * (shift * shift + bent * bent) : 0.0),
                    1e-7 * elastic + 2e-18);
      });
    }
}

// ---- PL5: loads of a section ----------------------------------------------------------------------------

TEST(PlasticSection, HasTheLoadsOfASolidCircle) {
  const nlohmann::json e = testing::material_case("PL5")["expected"];
  const FlowLimits first = first_yield_loads(circle(0.2), 1.0, 1.0),
                   all = plastic_loads_of_circle(0.2, 1.0, 1.0);
  EXPECT_NEAR(all.axial, e["N_y"], 1e-12);
  EXPECT_NEAR(first.axial, e["N_y"], 1e-12);
  EXPECT_NEAR(first.bending, e["M_first_yield"], 1e-12);
  EXPECT_NEAR(all.bending, e["M_plastic"], 1e-12);
  EXPECT_NEAR(first.torsion, e["T_first_yield"], 1e-12);
  EXPECT_NEAR(all.torsion, e["T_plastic"], 1e-12);
}

// Any rotation, also by more than half a turn, comes back the same.
TEST(RotationByQuarter, HoldsAnyRotation) {
  testing::PoseSource random(20);
  for (int trial = 0; trial < 300; ++trial) {
    const Quatd q = random.rotation(6.2), p = rotation_by_quarter(quarter_of_rotation(q));
    const double sign = q.w * p.w + q.x * p.x + q.y * p.y + q.z * p.z;
    EXPECT_NEAR(std::abs(sign), 1.0, 1e-15);
    EXPECT_LE(norm(quarter_of_rotation(q)), 1.0 + 1e-15);
  }
  EXPECT_EQ(rotation_by_quarter(Vec3d{}), Quatd{});
}

}  // namespace
}  // namespace vbond::flowing_test
