#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vbond/core/communicator.hpp"
#include "vbond/core/large_array.hpp"
#include "vbond/dynamics/bond_pack.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/dynamics/rows.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// A bond is worked on with the block of its lower row, or with that of a ghost.
inline std::size_t lower_row(const Bond& b, const Order& order) {
  return std::min(order.row_i(b), order.row_j(b)).value;
}

/// A bond that breaks.
struct BreakingBond {
  BondId bond;
  BondRates<double> rates;  ///< that its loads were worked out with, where any bond reads rates; else zero
  friend bool operator<(const BreakingBond& a, const BreakingBond& b) { return a.bond < b.bond; }
};

/// The constants of all bonds in the order in which the step loop works through them: by the block of the
/// lower of their two rows (with ghosts by that of the ghost, if the order says so), in a block by kind,
/// those of compact packs by how far apart their rows are to a factor of two, the farthest first, unless all
/// bonds join rows less than a block apart, then by that row and in order of creation. So bonds that follow
/// each other seldom share a particle, and rows are read in streams. This order fixes the order in which
/// loads are summed for each particle, whatever the number of threads. Once the bonds of a block and all
/// before it are done, the loads of that block's particles are complete, but for bonds with ghosts.
class BondPacks {
 public:
  /// To be called whenever bonds were made, by all parts together. Broken bonds are left out; of a body in
  /// parts, bonds are the concern of the part of their first particle.
  void arrange(const State& state, const Order& order, const Team& team, const Communicator& all = alone());

  /// Adds what the bonds of lower parts do to the particles of this part, and to its images: first of all.
  void add_loads_from_below(const Part& part, BondSweep& sweep) { add_loads(from_below_[part.index], sweep); }
  /// Adds what the bonds of higher parts do to the images of this part: last of all in it.
  void add_loads_from_above(const Part& part, BondSweep& sweep) { add_loads(from_above_[part.index], sweep); }
  /// Adds the loads of the bonds of a block to the particles of its part. Bonds that break are added to
  /// `broken`, in no order.
  void add_loads(const Block& block, BondSweep& sweep, const RowsAhead& ahead,
                 std::vector<BreakingBond>* broken);

  /// The bond, which expands, has other lengths now.
  void take_lengths(BondId bond, const Bond& as_it_is);
  /// This bond does nothing any more. Its lane stays empty until the next arrange().
  void remove(BondId bond);
  /// A bond of another part does nothing any more.
  void remove_elsewhere() { ++removed_; }
  /// Whether so many lanes are empty that arranging anew pays.
  bool is_sparse() const { return removed_ > bonds_ / 8; }
  /// These four are of the bonds of all parts.
  bool reads_rates() const { return reads_rates_; }
  bool damp() const { return damp_; }
  bool remembers() const { return remembers_; }
  /// What a bond that may break or expands remembers now.
  BondHistory history(BondId bond) const;
  bool all_elastic() const { return all_elastic_; }
  /// The bond, which may break, remembers this from now on.
  void put_history(BondId bond, const BondHistory& history);
  /// What each bond remembers now; those that are broken are left as they are.
  void collect(PerBond<BondHistory>& history) const;

  /// The bonds of this block join only rows of blocks before the one returned, besides blocks that
  /// move early, and ghosts.
  std::size_t reach(std::size_t block) const { return reach_[block]; }
  /// Whether particles of this block have bonds that are worked on with the blocks of ghosts.
  bool waits_for_ghosts(std::size_t block) const { return waits_for_ghosts_[block] != 0; }
  /// Whether a bond joins this block to another part.
  bool at_border(std::size_t block) const { return at_border_[block] != 0; }

  /// Energy of all bonds, and those that need a closer look, in increasing order. The team of arrange().
  Energies survey(const Team& team, const PoseRow* pose, std::vector<BondId>& deformed) const;

 private:
  struct Kind {
    bool compact = false;
    std::uint32_t type = 0;  // compact: index into types_, else into full_types_
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
    const BondLaw* law;
    std::size_t first, count;
    std::size_t first_history;
  };
  template <class P>
  struct Store {
    LargeArray<P> packs;
    std::vector<PackLanes> lanes;
    std::vector<BondId> bond;            // of each lane
    mutable LargeArray<double> history;  // run by run, of those whose law remembers; moved on by a sweep
    void reserve(std::size_t n) { packs.reserve(n), lanes.reserve(n), bond.reserve(n * pack_bonds); }
    PackRun<P> run(const Run& r, const BondType* type) const {
      return {&packs[r.first], &lanes[r.first], r.count, type, history.data() + r.first_history, {}};
    }
  };
  /// Where a bond is worked on: once, or in a second place for the other part.
  struct Lane {
    BondId bond;
    bool compact = false;
    std::size_t lane = 0;
    std::size_t history = 0;  // where its first number stands
    const BondLaw* law = nullptr;
    friend bool operator<(const Lane& a, const Lane& b) { return a.bond < b.bond; }
  };

  Kind kind_of(const Bond& bond, bool expands);
  std::uint32_t number_of(const Bond& bond);
  Run add_run(const Sorted* sorted, std::size_t count, const State& state, const Order& order,
              const Part& own);
  void note(const Bond& bond);
  void tell_each_other(const Communicator& all);
  void add_loads(const std::vector<Run>& runs, BondSweep& sweep);
  template <class F>
  void visit(const Run& run, F f) const;

  std::vector<BondType> types_, full_types_;  // of compact and of full packs
  Store<CompactPack> compact_;
  Store<FullPack> full_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_run_;                     // of each block, and the end
  std::vector<std::size_t> reach_;                         // of each block
  std::vector<std::uint8_t> at_border_;                    // of each block
  std::vector<std::uint8_t> waits_for_ghosts_;             // of each block
  std::vector<std::vector<Run>> from_below_, from_above_;  // of each part
  std::vector<Lane> known_;  // those that may break or expand, in order of bonds, a bond at most twice
  bool reads_rates_ = false, damp_ = false, remembers_ = false, all_elastic_ = true;
  std::size_t bonds_ = 0, removed_ = 0;  // of all parts, so that they arrange them together
};

}  // namespace vbond
