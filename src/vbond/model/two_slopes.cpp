#include "vbond/model/two_slopes.hpp"

#include <cmath>
#include <limits>

#include "vbond/model/bond_sums.hpp"
#include "vbond/model/rules.hpp"

namespace vbond {

double rounding_of_place(const State& s, ParticleId p) {
  double far = norm(s.r[p]);
  for (const CellEdge& e : s.cell) far += norm(e.along);
  return 16.0 * std::numeric_limits<double>::epsilon() * far;
}

bool has_two_slopes(const Bond& b) {
  const Stretch& stretch = b.rules->stretch;
  return !b.broken && stretch.form == StretchForm::two_slopes && stretch.compression != 1.0;
}

bool is_unstrained(const State& s, BondId k) {
  const Bond& b = s.bonds[k];
  const double N = axial_force(s, k), c_A = b.law->stiffness(b).c_A;
  const double slope = has_two_slopes(b) && N < 0.0 ? b.rules->stretch.compression * c_A : c_A;
  const double rounding = rounding_of_balance * b.a + rounding_of_place(s, b.i) + rounding_of_place(s, b.j);
  return slope > 0.0 && std::abs(N) <= slope * rounding;
}

}  // namespace vbond
