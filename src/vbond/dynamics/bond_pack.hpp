#pragma once
#include <cstddef>
#include <cstdint>

#include "vbond/core/quat.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/physics/pose.hpp"

namespace vbond {

/// Bonds handled together, one per lane of the vector unit.
inline constexpr std::size_t pack_width = 8;

/// Eight bonds of one law with their constants lane by lane: scratch made from State::bonds. Lanes past
/// `count` repeat the last bond; their results are not stored.
struct BondPack {
  using Lanes = double[pack_width];
  BondLaw law;
  std::uint32_t count;
  std::uint32_t bond[pack_width];              ///< where the loads go
  std::uint32_t i[pack_width], j[pack_width];  ///< particles
  Lanes a, R_i, R_j, B1, B2, B3, B4;
  Lanes frame[2][4];  ///< frame_i, frame_j
};

/// Puts a bond into this lane of a pack and into all behind it.
void fill_lane(BondPack& pack, std::uint32_t lane, BondId id, const Bond& bond);

/// Writes the loads of these packs' bonds to of_bond[bond].
using PackKernel = void (*)(const BondPack* packs, std::size_t count, const Vec3d* r, const Quatd* q,
                            BondLoads<double>* of_bond);

/// The kernel for the best instruction set of this machine, chosen once. All give the same bits.
PackKernel pack_kernel();

/// Every kernel that this machine can execute, with its name, the baseline first: for tests and reports.
struct NamedKernel {
  const char* name;
  PackKernel kernel;
};
std::size_t available_kernels(NamedKernel (&kernels)[3]);

}  // namespace vbond
