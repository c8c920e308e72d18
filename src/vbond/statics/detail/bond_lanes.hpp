#pragma once
#include <cstddef>

namespace vbond {

struct BondLaw;
struct BondRules;

/// So many bonds of one law are worked out together.
inline constexpr std::size_t bonds_together = 8;

/// The bonds side by side: number k of bond l at [k][l]. What is read, and what is found.
struct BondLanes {
  using Lane = double[bonds_together];
  // what they are made of, as in Bond; the coefficients of an elastic law are the first four
  Lane a, R_i, R_j, coefficients[4], frame_i[4], frame_j[4];
  // how they stand: from i to j, and how both are turned
  Lane r_ij[3], q_i[4], q_j[4];
  // found: force on i, moments on i and j
  Lane F[3], M_ij[3], M_ji[3];
  // found: energy of stretching, of bending and shear, of torsion
  Lane U[3];
  // found: the symmetric part of Assembly::Block, by columns
  Lane block[12][12];
};

/// Energy, loads, or the tangent for turns times this length, of all lanes by one law; every lane rounds as a
/// bond does by itself.
struct BondLaneLoops {
  void (*energy)(BondLanes& bonds);
  void (*loads)(BondLanes& bonds);
  void (*tangent)(BondLanes& bonds, double length);
};
struct BondLaneKernel {
  BondLaneLoops of_law[2];  ///< V-model, enhanced vector model
};

/// That of the best instruction set that this processor has; numbers do not depend on it.
const BondLaneKernel& bond_lane_kernel();
/// With number 0 that of any processor, then those of wider vectors; nullptr: there are no more here.
const BondLaneKernel* bond_lane_kernel(int number);

/// The loops for bonds of this law with these rules, which are those of its elastic part where rules say
/// nothing of stretching; nullptr: they are worked out one by one.
const BondLaneLoops* lane_loops(const BondLaneKernel& kernel, const BondLaw& law, const BondRules& rules);

}  // namespace vbond
