// What rounding leaves out of balance.
#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/model/touching.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond {

double StaticBody::residual_of_rounding() const {
  const Loaded& l = loads_at_hand();
  return l.largest > 0.0 ? std::max(rounding_of_force_, l.rounding_of_force) / l.largest : 0.0;
}

// Places are rounded to eps |r|, axes of bonds to eps, so that the loads of a bond are known to its stiffness
// times that; of a contact, whose force has no slope of its own where it begins, by what its force grows. All
// of a particle may add up.
PerParticle<double> StaticBody::rounding_at_particles() const {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const double L = unknowns_.length();
  PerParticle<double> sum(model_.particles(), 0.0);
  const auto place = [&](ParticleId i, ParticleId j, const Image& n) {
    return eps * (std::max(norm(state_.r[i]), norm(state_.r[j])) + norm(between(state_, i, j, n)));
  };
  for (const Bond& b : state_.bonds) {
    if (b.broken) continue;
    const BondStiffness<double> c = b.law->stiffness(b);
    const double lever = std::max(1.0, b.a / L);
    const double e = (c.c_A + c.c_D) * (place(b.i, b.j, image_of_j(b)) + eps * b.a) * lever +
                     eps * angular_scale(b) / std::min(b.a, L);
    sum[b.i] += e, sum[b.j] += e;
  }
  for_touching([&](ParticleId i, ParticleId j, const Image& n, double) {
    const Vec3d r_ij = between(state_, i, j, n);
    const auto force = [&](const Vec3d& at) {
      return norm(contact_tangent(touch_forms(model_.contact), touch_numbers(model_, i, j), at,
                                  model_.radius[i], model_.radius[j])
                      .loads.F);
    };
    const double e = force((1.0 - place(i, j, n) / norm(r_ij)) * r_ij) - force(r_ij);
    sum[i] += e, sum[j] += e;
  });
  PerParticle<double> at_unknowns(model_.particles(), 0.0);
  for (const ParticleId p : sum.ids()) {
    const Vec3d* arm = unknowns_.arm(p);
    at_unknowns[unknowns_.carrier(p)] += (arm == nullptr ? 1.0 : 1.0 + norm(*arm) / L) * sum[p];
  }
  return at_unknowns;
}

bool StaticBody::rests_to_rounding() const {
  const Vector& g = unbalanced();
  const PerParticle<double> rounding = rounding_at_particles();
  const double at_walls = loads_at_hand().rounding_of_force;
  for (int k = 0; k < unknowns_.size(); ++k)
    if (!(std::abs(g[k]) <= rounding[unknowns_.place(k).particle] + at_walls)) return false;
  return true;
}

}  // namespace vbond
