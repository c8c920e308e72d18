#pragma once
#include "vbond/physics/with_rubbing.hpp"

// What tests of cracked faces share: one joint, and what it remembers.
namespace vbond::cracked {

inline constexpr double mu = 0.6;
inline constexpr BondStiffness<double> c{2.0, 0.7, 0.3, 0.4};

inline const BondRules rules = [] {
  BondRules of_joint;
  of_joint.rubbing = {mu, 1.0};
  return of_joint;
}();

template <class Law>
LawHistory<Law> slipped(double s_2, double s_3) {
  LawHistory<Law> h;
  h.value[rubbed::cracked] = 1.0;
  h.value[rubbed::slip] = s_2, h.value[rubbed::slip + 1] = s_3;
  return h;
}
template <class Law>
LawHistory<Law> after(const Law& law, const BondPose<double>& pose, const LawHistory<Law>& before) {
  return advance(law, pose, bond_axis(law, pose), BondRates<double>{}, 0.0, before);
}
template <class Law>
BondLoads<double> loads(const Law& law, const BondPose<double>& pose, const LawHistory<Law>& h) {
  return bond_loads(law, pose, bond_axis(law, pose), h);
}

}  // namespace vbond::cracked
