#include "vbond/statics/detail/bond_lanes.hpp"

#include "vbond/model/bond_law.hpp"
#include "vbond/physics/bond_rules.hpp"
#include "vbond/statics/detail/kernel_of_sets.hpp"

namespace vbond {

namespace bond_lanes_baseline {
extern const BondLaneKernel kernel;
}
#if defined(VBOND_VECTOR_KERNELS)
namespace bond_lanes_avx2 {
extern const BondLaneKernel kernel;
}
namespace bond_lanes_avx512 {
extern const BondLaneKernel kernel;
}
constexpr KernelOfSets<BondLaneKernel> bond_lanes_kernels{
    &bond_lanes_baseline::kernel, &bond_lanes_avx2::kernel, &bond_lanes_avx512::kernel};
#else
constexpr KernelOfSets<BondLaneKernel> bond_lanes_kernels{&bond_lanes_baseline::kernel};
#endif

const BondLaneKernel* bond_lane_kernel(int number) {
  return bond_lanes_kernels.of(number);
}

const BondLaneKernel& bond_lane_kernel() {
  static const BondLaneKernel& best = bond_lanes_kernels.best();
  return best;
}

const BondLaneLoops* lane_loops(const BondLaneKernel& kernel, const BondLaw& law, const BondRules& rules) {
  const auto is = [&law](const BondLaw& elastic) { return &law == &elastic || &law == elastic.with_rules; };
  if (law.has_rules && rules.stretch.form != StretchForm::harmonic) return nullptr;
  if (is(bond_law<VModel>)) return &kernel.of_law[0];
  if (is(bond_law<Evm>)) return &kernel.of_law[1];
  return nullptr;
}

}  // namespace vbond
