#pragma once
#include <cstdint>
#include <vector>

#include "vbond/dynamics/bond_pack.hpp"
#include "vbond/dynamics/contact_kernel.hpp"
#include "vbond/dynamics/rows.hpp"
#include "vbond/dynamics/touch_kernel.hpp"

namespace vbond {

/// How viscous drag slows a particle down over half a step, and what energy that takes out.
struct Decay {
  double v = 1, omega = 1;        ///< factors of the rates, exp(-b dt / 2m)
  double of_v = 0, of_omega = 0;  ///< m/2 (1 - factor^2): energy lost per squared rate
};

/// Energies of bonds by channel.  [energy]
struct BondEnergies {
  double U_L = 0, U_B = 0, U_T = 0;
};

/// The loops over bonds, for packs of one kind.
template <class P>
struct PackLoops {
  /// Adds the loads of these bonds to their particles; of a pack that crosses, only to rows of `own`.
  void (*add_loads)(const PackRun<P>&, BondSweep&);
  /// Adds the energies of these bonds, and tells of each pack the lanes that needs_look(), a bit each.
  void (*survey)(const PackRun<P>&, const PoseRow*, BondEnergies&, std::uint8_t* look);
};

/// The loops over bonds of one law.
struct BondLoops {
  PackLoops<CompactPack> compact;  ///< null for laws with offsets
  PackLoops<FullPack> full;
};

/// The loops of a step that must be fast, compiled once per instruction set. All sets give the same bits.
/// Rows after the last one may be taken with it, up to a multiple of rows_at_once.
struct StepKernel {
  const char* name;        ///< of the instruction set
  const BondLoops* bonds;  ///< of each law in BondLaws, in that order
  /// v += h F/m, omega += h M/Theta. Returns 0, or NaN if a load is not finite or their sum is too large for
  /// a double.
  double (*kick)(RowRange, double h, const InverseInertia*, const LoadRow*, MotionRow*);
  /// The same. damping: a part of these loads. twice_power: set to the sum of F . v + M . omega of that part
  /// before the kick and after it, added.
  double (*kick_damped)(RowRange, double h, const InverseInertia*, const LoadRow*, MotionRow*,
                        const LoadRow* damping, double& twice_power);
  /// r += h v; q is turned exactly by the angle vector h omega. Returns a bound of the largest |h v|^2 that
  /// is at most three times too large.
  double (*drift)(RowRange, double h, const MotionRow*, PoseRow*);
  /// Slows down by the factors and returns the kinetic energy that this takes away.
  double (*slow_down)(RowRange, const Decay*, MotionRow*);
  ContactLoop* add_contact_loads;
  TouchLoop* touch_pairs;
  AddTouches* add_touches;
  /// The sum of F . v + M . omega.
  double (*power)(RowRange, const LoadRow*, const MotionRow*);
  /// to += from.
  void (*add_rows)(RowRange, const LoadRow* from, LoadRow* to);
};

/// The kernels that this machine can execute, the best one last. AVX-512 has two: with pairs of packs for
/// Intel's processors, pack by pack for others.
std::vector<const StepKernel*> available_kernels();

/// The kernel that runs use: the best one, or the one that the environment variable VBOND_SIMD names. Chosen
/// once. Throws std::invalid_argument if VBOND_SIMD names none that this machine can execute.
const StepKernel& step_kernel();

/// Its instruction set: "baseline", "avx2" or "avx512".
const char* instruction_set();

/// The loops of a law in this kernel. Throws std::invalid_argument for a law that was compiled without them.
const BondLoops& bond_loops(const BondLaw& law, const StepKernel& kernel);

/// StepKernel::drift for particles that may turn by any angle: plain code for every machine, since no kernel
/// may contain a copy of the library's sine.
void drift_by_any_angle(RowRange, double h, const MotionRow*, PoseRow*);

}  // namespace vbond
