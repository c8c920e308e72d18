#include "vbond/statics/detail/bond_turns.hpp"

#include <algorithm>
#include <cmath>

namespace vbond {
namespace {

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

}  // namespace

double largest_bond_turn(const State& now, const Placement& before) {
  double largest = 0.0;
  for (const Bond& b : now.bonds) {
    if (b.broken) continue;
    const Quatd seen_now = conjugate(now.q[b.i]) * now.q[b.j];
    const Quatd seen_before = conjugate(before.q[b.i]) * before.q[b.j];
    const BondPose<double> pose_now = bond_pose(b, now);
    const BondPose<double> pose_before = bond_pose(b, before);
    const Vec3d D_now = bonded_points(b, pose_now);
    const Vec3d D_before = bonded_points(b, pose_before);
    const auto of_line = [&](ParticleId p) {
      return angle_between(rotate(conjugate(now.q[p]), D_now), rotate(conjugate(before.q[p]), D_before));
    };
    largest = std::max(
        {largest, norm(rotation_vector(seen_now * conjugate(seen_before))), of_line(b.i), of_line(b.j)});
  }
  return largest;
}

std::optional<BondId> newly_snapped(const State& now, const Placement& before) {
  const auto snapped = [](const Bond& b, const BondPose<double>& pose) {
    return bond_range(b, bond_shape(b, pose)) == BondRange::snapped;
  };
  for (const BondId k : now.bonds.ids()) {
    const Bond& b = now.bonds[k];
    if (snapped(b, bond_pose(b, now)) && !snapped(b, bond_pose(b, before))) return k;
  }
  return {};
}

}  // namespace vbond
