#pragma once
#include <string_view>

#include "vbond/dynamics/bond_loops.hpp"
#include "vbond/model/define_law.hpp"

namespace vbond {

/// A law of a program's own, compiled for the instruction set of the file that includes this, two bonds at a
/// time: what links vbond::vbond is compiled with VBOND_KERNEL=portable, VBOND_LANES=2,
/// VBOND_PACKS_TOGETHER=1. To be kept as one constant that its bonds point to:
///     const BondLaw my_law = law_with_loops<MyLaw>();
/// Its loops give the same bits beside the kernel of any instruction set: do not compile with
/// -ffp-contract=fast (the default of g++ where the processor has fma) or -ffast-math.
template <template <class> class Law>
BondLaw law_with_loops() {
  BondLaw law = bond_law<Law>;
  law.loops = [](std::string_view) { return &VBOND_KERNEL::loops_of_law<Law>; };
  if constexpr (TakesRules<Law<double>>) {
    static const BondLaw with_rules = law_with_loops<WithRules<Law>::template Law>(),
                         with_flow = law_with_loops<WithFlow<Law>::template Law>();
    law.with_rules = &with_rules;
    law.with_flow = &with_flow;
    law.with_rubbing = nullptr;  // flat joints are of the library's laws
  }
  return law;
}

}  // namespace vbond
