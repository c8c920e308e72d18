#pragma once
#include <vector>

#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/bond_pack.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// F.d of a bond, tension positive: both laws' other terms are normal to d.  [force]
double axial_force(const Bond& b, const State& s);

/// Adds every bond's loads to its two particles, bond by bond: the reference for BondLoadsEvaluator.
void add_bond_loads(const State& state, Loads& loads);

/// The same in two phases that any number of threads can share: loads bond by bond, eight at a time, then
/// sums particle by particle in the order of the bonds. Results are bitwise those of add_bond_loads.
class BondLoadsEvaluator {
 public:
  /// Reads the bonds' constants: to be called whenever they have changed.
  void prepare(const PerBond<Bond>& bonds);
  void add(const State& state, const BondIndex& index, int threads, Loads& loads);

 private:
  std::vector<BondPack> packs_;
  std::vector<BondLoads<double>> of_bond_;  // rewritten at every call of add
};

}  // namespace vbond
