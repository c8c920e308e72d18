#include "vbond/model/heat.hpp"

#include <vector>

namespace vbond {

Bond with_growth(const State& s, const WarmBond& w, double growth) {
  Bond b = s.bonds[w.bond];
  const double factor = 1.0 + growth;
  b.a = factor * w.a, b.R_i = factor * w.R_i, b.R_j = factor * w.R_j;
  return b;
}

void take_lengths(State& s) {
  for (const WarmBond& w : s.warm_bonds)
    if (Bond& b = s.bonds[w.bond]; !b.broken) b = with_growth(s, w, growth_of(s, w));
}

double power_of_growth(const Bond& b, const WarmBond& w, const BondPose<double>& pose,
                       const BondHistory& history) {
  const BondAxis<double> axis = bond_axis(pose, b.R_i, b.R_j);
  const Vec3d F = b.law->loads(b, pose, history).F;
  return -w.a * dot(F, axis.d) - dot(F, w.R_i * pose.n_i[0] - w.R_j * pose.n_j[0]);
}

void keep_bonds(State& s, std::size_t n) {
  s.bonds.resize(n);
  std::erase_if(s.warm_bonds, [n](const WarmBond& w) { return w.bond.value >= n; });
}

}  // namespace vbond
