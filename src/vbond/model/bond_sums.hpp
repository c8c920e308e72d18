#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "vbond/model/body_part.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// F.d of a bond between particles that stand like this, tension positive, damping left out: the other terms
/// of a law are normal to d.  [force]
inline double axial_force(const Bond& b, const BondHistory& history, const Vec3d& r_ij, const Quatd& q_i,
                          const Quatd& q_j) {
  if (b.law->crack != nullptr) {  // faces that have slipped or turned: by all of the pose
    const BondPose<double> pose = bond_pose(b, r_ij, q_i, q_j);
    return dot(b.law->loads(b, pose, history).F, bond_axis(b, pose).d);
  }
  const bool at_centres = b.R_i == 0.0 && b.R_j == 0.0 && !b.law->has_offsets;  // no need of the axes
  const double D = at_centres ? norm(r_ij) : norm(bonded_points(b, bond_pose(b, r_ij, q_i, q_j)));
  return b.law->tension(b, D, history);
}
/// The same as its particles stand now.
inline double axial_force(const State& s, BondId k) {
  const Bond& b = s.bonds[k];
  return axial_force(b, history_of_bond(s, k), between(s, b), s.q[b.i], s.q[b.j]);
}

/// The own bonds that hold with both ends among these particles, which are in increasing order.
std::vector<BondId> bonds_inside(const BodyPart& body, const IdList<ParticleId>& particles);

/// Mean of axial_force(bond) over these bonds of each process; 0 without any.  [force]
template <class AxialForce>
double mean_axial_force(const std::vector<BondId>& own, const Communicator& all, AxialForce axial_force) {
  double sum = 0.0;
  for (const BondId k : own) sum += axial_force(k);
  const auto here = static_cast<double>(own.size());
  double count = here;
  all.sum({&count, 1});
  double share = own.empty() ? 0.0 : sum / here * (here / count);
  all.sum({&share, 1});
  return share;
}

/// Mean of F.d over bonds_inside(), tension positive; 0 without any.  [force]
double mean_axial_force(const BodyPart& body, const IdList<ParticleId>& particles);

/// Adds every bond's loads to its two particles, bond by bond: the reference for the loops of the step.
void add_bond_loads(const State& state, Loads& loads);

/// Energy of all bonds by channel, bond by bond, relative to rest; other members are left at zero.  [energy]
Energies bond_energies(const State& state);
/// Whether a bond could not flow so that its loads are at their limits: physics/flow.hpp.
inline bool has_lost_its_flow(const BondHistory& h) {
  return !std::all_of(h.begin(), h.end(), [](double x) { return std::isfinite(x); });
}
/// What bonds that yield, creep, soften or rub have dissipated since they were made, broken ones too.
/// Of a part its own ones.  [energy]
double dissipated_by_flow(const BodyPart& body);
/// The same by cause, of all parts of a body.
Losses losses_by_flow(const BodyPart& body);
/// Books that begin with this state, which holds so much energy.
EnergyBooks opened_books(const BodyPart& body, double energy);
/// What the books count as dissipated, by cause; the sum differs from it by rounding.
Losses losses_of(const State& state);

}  // namespace vbond
