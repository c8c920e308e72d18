#include "vbond/statics/detail/bond_lanes.hpp"

#include <functional>

#include "vbond/model/bond_law.hpp"
#include "vbond/physics/bond_rules.hpp"

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
#endif

const BondLaneKernel* bond_lane_kernel(int number) {
  if (number == 0) return &bond_lanes_baseline::kernel;
#if defined(VBOND_VECTOR_KERNELS)  // each set asks for what CMakeLists.txt compiles it with
  if (number == 1 && __builtin_cpu_supports("avx2")) return &bond_lanes_avx2::kernel;
  if (number == 2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return &bond_lanes_avx512::kernel;
#endif
  return nullptr;
}

const BondLaneKernel& bond_lane_kernel() {
  static const BondLaneKernel& best = [] {
    int number = 0;
    while (bond_lane_kernel(number + 1) != nullptr) ++number;
    return std::cref(*bond_lane_kernel(number));
  }();
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
