// What of a body is not finite.
#include <fmt/format.h>

#include <cmath>

#include "vbond/model/energies.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond {
namespace {

bool has_finite_place(const State& s, ParticleId p) {
  const Quatd& q = s.q[p];
  return is_finite(s.r[p]) && std::isfinite(q.w + q.x + q.y + q.z);
}

}  // namespace

bool StaticBody::places_are_finite() const {
  for (const ParticleId p : state_.r.ids())
    if (!has_finite_place(state_, p)) return false;
  return true;
}

std::string StaticBody::first_not_finite() const {
  if (has_collapsed()) return "the cell collapses or turns over";
  for (const ParticleId p : state_.r.ids())
    if (!has_finite_place(state_, p))
      return fmt::format("particle {}: its place, ({}, {}, {}), or its orientation is not finite", p.value,
                         state_.r[p].x, state_.r[p].y, state_.r[p].z);
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    const BondPose<double> pose = bond_pose(b, state_);
    const BondLoads<double> f = bond_loads(state_, k);
    const BondEnergy<double> U = bond_energy(state_, k);
    const bool finite_loads = is_finite(f.F) && is_finite(f.M_ij) && is_finite(f.M_ji);
    if (finite_loads && std::isfinite(U.U_L + U.U_B + U.U_T)) continue;
    if (has_lost_its_flow(history_of_bond(state_, k)))
      return fmt::format(
          "bond {} (particles {}, {}): its flow does not bring its loads to their limits, which they are far "
          "beyond",
          k.value, b.i.value, b.j.value);
    return fmt::format("bond {} (particles {}, {}): its {} not finite, its bonded points are {:.3g} apart",
                       k.value, b.i.value, b.j.value, finite_loads ? "energy is" : "loads are",
                       norm(bonded_points(b, pose)));
  }
  std::string found;
  for_touching([&](ParticleId i, ParticleId j, const Image& n, double overlap) {
    if (found.empty() && !is_finite(touch(model_, state_, i, j, n).loads.F))
      found = fmt::format("contact of particles {} and {}: its force is not finite, at an overlap of {:.3g}",
                          i.value, j.value, overlap);
  });
  if (!found.empty()) return found;
  if (const auto fault = fault_of_terms()) return *fault;
  const Loads& loads = loads_at_hand().loads;
  for (const ParticleId p : loads.F.ids())
    if (!is_finite(loads.F[p]) || !is_finite(loads.M[p]))
      return fmt::format("particle {}: the sum of its loads is not finite", p.value);
  if (!std::isfinite(energies().total())) return "all particles: the sum of their energies is not finite";
  return {};
}

}  // namespace vbond
