#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "vbond/model/loads.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// F.d of a bond between particles that stand like this, tension positive, damping left out: the other terms
/// of a law are normal to d.  [force]
inline double axial_force(const Bond& b, const BondHistory& history, const Vec3d& r_i, const Quatd& q_i,
                          const Vec3d& r_j, const Quatd& q_j) {
  const bool at_centres = b.R_i == 0.0 && b.R_j == 0.0;  // no need of the axes
  const double D =
      at_centres ? norm(r_j - r_i) : norm(bonded_points(bond_pose(b, r_i, q_i, r_j, q_j), b.R_i, b.R_j));
  return b.law->tension(b, D, history);
}

/// Mean of F.d over these bonds of a state, tension positive; 0 without any. pose(p): something with the
/// position r and the orientation q of particle p, in place of the state's.  [force]
template <class PoseOf>
double mean_axial_force(const State& state, const std::vector<BondId>& of, PoseOf pose) {
  double sum = 0.0;
  for (const BondId k : of) {
    const Bond& b = state.bonds[k];
    const auto &i = pose(b.i), &j = pose(b.j);
    sum += axial_force(b, history_of_bond(state, k), i.r, i.q, j.r, j.q);
  }
  return of.empty() ? 0.0 : sum / static_cast<double>(of.size());
}

/// The same over the bonds with both ends among these particles, which are in increasing order.
double mean_axial_force(const State& state, const std::vector<ParticleId>& particles);

/// Adds every bond's loads to its two particles, bond by bond: the reference for the loops of the step.
void add_bond_loads(const State& state, Loads& loads);

/// Energy of all bonds by channel, bond by bond, relative to rest; other members are left at zero.  [energy]
Energies bond_energies(const State& state);
/// Whether a bond could not flow so that its loads are at their limits: physics/flow.hpp.
inline bool has_lost_its_flow(const BondHistory& h) {
  return !std::all_of(h.begin(), h.end(), [](double x) { return std::isfinite(x); });
}
/// What bonds that yield, creep or soften have dissipated since they were made, broken ones too.  [energy]
double dissipated_by_flow(const State& state);
/// The same by cause.
Losses losses_by_flow(const State& state);
/// Books that begin with this state, which holds so much energy.
EnergyBooks opened_books(const State& state, double energy);
/// What the books count as dissipated, by cause; the sum differs from it by rounding.
Losses losses_of(const State& state);

}  // namespace vbond
