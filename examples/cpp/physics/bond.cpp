// One bond, without the library: energy and loads of the V-model in a program with a step loop of its own.
// Units: a = m = c_A = 1.
#include <cstdio>

#include "vbond/physics/laws.hpp"

int main() {
  using namespace vbond;
  const auto law = VModel<double>::from({1.0, 0.03, 0.0025, 1.0 / 480}, 1.0, 0.0, 0.0);
  const BondFrames<double> frames;  // of particles whose axes were the bond's when it was made
  const BondPose<double> pose = bond_pose(frames, Vec3d{1.01, 0, 0}, Quatd{}, Quatd{});
  const BondEnergy<double> U = bond_energy(law, pose);
  std::printf("energy %.6g, force %.6g\n", U.U_L + U.U_B + U.U_T, bond_loads(law, pose).F.x);
}
