#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vbond/dynamics/bond_pack.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/dynamics/rows.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/loads.hpp"

namespace vbond {

/// A bond is worked on with the block of its lower row.
inline std::size_t lower_row(const Bond& b, const Order& order) {
  return std::min(order.row[b.i], order.row[b.j]).value;
}

/// The constants of all bonds in the order in which the step loop works through them: by the block of the
/// lower of their two rows, in a block by kind, then by that row and in order of creation. This order fixes
/// the order in which loads are summed for each particle, whatever the number of threads. Once the bonds of a
/// block and all before it are done, the loads of that block's particles are complete.
class BondPacks {
 public:
  /// To be called whenever bonds were made.
  void arrange(const PerBond<Bond>& bonds, const Order& order, const Team& team);

  /// Adds what the bonds of lower parts do to the particles of this part: first of all in a part.
  void add_loads_from_below(const Part& part, const PoseRow* pose, LoadRow* load) const;
  /// Adds the loads of the bonds of a block to the particles of its part.
  void add_loads(const Block& block, const Part& part, const PoseRow* pose, LoadRow* load,
                 const RowsAhead& ahead) const;

  /// The bonds of this block join only rows of blocks before the one returned.
  std::size_t reach(std::size_t block) const { return reach_[block]; }
  /// Whether a bond joins this block to another part.
  bool at_border(std::size_t block) const { return at_border_[block] != 0; }

  /// Energy of all bonds, and those that need a closer look, in increasing order.
  Energies survey(const Team& team, const PoseRow* pose, std::vector<BondId>& deformed) const;

 private:
  struct Kind {
    bool compact = false;
    std::uint32_t type = 0;  // compact: index into types_, else into laws_
    double scale = 1.0;
    friend bool operator==(const Kind& a, const Kind& b) {
      return a.compact == b.compact && a.type == b.type;
    }
  };
  struct Sorted;
  struct Run {
    bool compact;
    std::uint32_t type;
    const BondLoops* loops;
    std::size_t first, count;
  };
  template <class P>
  struct Store {
    std::vector<P> packs;
    std::vector<PackLanes> lanes;
    std::vector<BondId> bond;  // of each lane
    void reserve(std::size_t n) { packs.reserve(n), lanes.reserve(n), bond.reserve(n * pack_bonds); }
    PackRun<P> run(const Run& r, const BondType& type) const {
      return {&packs[r.first], &lanes[r.first], r.count, type};
    }
  };

  Kind kind_of(const Bond& bond);
  std::uint32_t number_of(const BondLaw& law);
  Run add_run(const Sorted* sorted, std::size_t count, const PerBond<Bond>& bonds, const Order& order,
              RowRange own);
  template <class F>
  void visit(const Run& run, F f) const;

  std::vector<const BondLaw*> laws_;
  std::vector<BondType> types_;
  Store<CompactPack> compact_;
  Store<FullPack> full_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_run_;        // of each block, and the end
  std::vector<std::size_t> reach_;            // of each block
  std::vector<std::uint8_t> at_border_;       // of each block
  std::vector<std::vector<Run>> from_below_;  // of each part
};

}  // namespace vbond
