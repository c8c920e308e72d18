#pragma once
#include <gtest/gtest.h>

#include "vbond/physics/flow_tangent.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond::flowing_test {

inline constexpr BondStiffness<double> slender{1.0, 0.03, 0.0025, 1.0 / 480};
inline const Vec3d unit_x{1, 0, 0}, unit_y{0, 1, 0}, unit_z{0, 0, 1};

inline BondPose<double> pose_of(double D, const Quatd& q_i, const Quatd& q_j) {
  return {D * unit_x,
          {rotate(q_i, unit_x), rotate(q_i, unit_y), rotate(q_i, unit_z)},
          {rotate(q_j, -unit_x), rotate(q_j, unit_y), rotate(q_j, unit_z)}};
}

/// One bond between particles that are put anywhere, and what it remembers.
template <class Law>
struct Driven {
  BondRules rules;
  Law law = Law::from(slender, 1.0, 0.0, 0.0);
  LawHistory<Law> h{};

  explicit Driven(const BondRules& r) : rules(r) { law.rules = &rules; }
  Driven(const Driven&) = delete;
  void move_to(const BondPose<double>& b, double dt = 1.0, const BondRates<double>& rates = {}) {
    h = advance(law, b, bond_axis(b, law.R_i, law.R_j), rates, dt, h);
  }
  BondLoads<double> loads(const BondPose<double>& b) const {
    return bond_loads(law, b, bond_axis(b, law.R_i, law.R_j), h);
  }
  SectionMoments<double> moments(const BondPose<double>& b) const {
    return section_moments(b, law.R_i, law.R_j, loads(b));
  }
  double energy(const BondPose<double>& b) const {
    const BondEnergy<double> U = bond_energy(law, b, h);
    return U.U_L + U.U_B + U.U_T;
  }
  double operator[](std::size_t k) const { return h.value[k]; }
};

template <class Law>
class FlowingBond : public ::testing::Test {};
using FlowingLaws = ::testing::Types<WithFlow<VModel>::Law<double>, WithFlow<Evm>::Law<double>>;
TYPED_TEST_SUITE(FlowingBond, FlowingLaws);

inline Quatd about(const Vec3d& axis, double angle) {
  return rotation_of(angle * axis);
}

}  // namespace vbond::flowing_test
