#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "vbond/core/large_array.hpp"
#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/dynamics/neighbours.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/model/contact_masses.hpp"
#include "vbond/model/model.hpp"

namespace vbond {

/// Near particles, what those that touch do to each other by physics/touch.hpp, and what they remember. Each
/// pair is worked out once, in the block of its lower row; then both rows add its loads, in increasing order
/// of the other row: the bits do not depend on how rows are shared out. Loads have slots only until both rows
/// have added them, so that they stay in the cache.
class TouchPairs {
 public:
  /// Keeps references to order and kernel.
  TouchPairs(const Model& model, const ContactMasses& masses, const Order& order, const StepKernel& kernel);
  TouchPairs(const Model&, const ContactMasses&, const Order&&, const StepKernel&) = delete;

  /// The bond of two that overlap has broken, and contacts keep such overlaps.
  void keep_overlap(Row i, Row j, double overlap);
  /// The two have touched before this step: surfaces that meet gain energy by adhesion, which these have not
  /// lost.
  void note_touching(Row i, Row j, const Bodies& bodies);
  /// The farthest that particles hold on to each other beyond touching.  [length]
  double reach() const { return reach_; }
  /// Takes over what is near what. Pairs that stay keep what they remember.
  void list(const NeighbourList& near, const Team& team);
  /// Whether pairs of this block reach into another part: all parts work out such blocks before any adds
  /// loads, and then each its others in increasing order, one just before it adds that block's loads.
  bool goes_first(std::size_t block) const { return of_block_[block].goes_first; }
  /// The loads of the pairs of these rows of one block, as TouchLoop.
  TouchSums work_out(RowRange rows, const Bodies& bodies, double dt);
  /// Adds to these rows of one block the loads of their pairs.
  void add_loads(RowRange rows, LoadRow* load);

  /// What contacts store as the particles stand: all, or these two.  [energy]
  double energy(const Bodies& bodies) const;
  double energy(Row i, Row j, const Bodies& bodies) const;
  /// The force on i of two that begin to touch.  [force]
  Vec3d first_force(Row i, Row j, const Bodies& bodies) const;

  /// What pairs remember, in order of particles; and takes it up again.
  std::vector<PairMemory> collect() const;
  void restore(const std::vector<PairMemory>& memories);

 private:
  /// Pairs of a block, and where their loads are.
  struct OfBlock {
    std::size_t first_pair = 0, pairs = 0, first_slot = 0;
    bool goes_first = false;
    std::size_t slot(std::size_t pair) const { return pair - first_pair + first_slot; }
  };
  void give_slots(const Team& team);
  std::size_t give_slots(const Part& part);
  const OfBlock& of_block_with(std::size_t row) const { return of_block_[row / block_rows]; }
  TouchRule rule() const;
  TouchTable table(const OfBlock& block);
  const TouchNumbers<double>& numbers(Row i, Row j) const;
  Touching<double> touching(Row i, Row j, const Bodies& bodies) const;
  /// The place of a pair in the table, i the lower row; or none: pairs().
  std::size_t place(Row i, Row j) const;
  std::size_t pairs() const { return second_.size(); }
  bool rolls() const { return forms_.rolling != RollingForm::none; }
  bool remembers(std::size_t pair) const;
  TouchHistory<double> history(std::size_t pair) const;

  const Order& order_;
  const StepKernel& kernel_;
  TouchForms forms_;
  LargeArray<TouchRow> row_;
  std::vector<std::uint32_t> material_;  // of each row; empty: there is one
  std::uint32_t materials_ = 1;
  std::vector<TouchNumbers<double>> numbers_;  // of each pair of materials
  double reach_ = 0;
  bool keeps_overlap_;

  std::vector<std::size_t> start_;  // of each row, in the pairs that it is first of
  LargeArray<Row> second_;
  LargeArray<SlipRow> slip_;
  LargeArray<MomentRow> rolling_;  // as moment_ empty without a form of rolling
  LargeArray<double> kept_;        // overlap that is not felt; empty: contacts feel all
  std::vector<OfBlock> of_block_;
  LargeArray<PairLoadRow> load_;  // of each slot, as moment_ and touching_
  LargeArray<MomentRow> moment_;
  std::vector<std::uint8_t> touching_;
  std::vector<std::size_t> as_second_start_;  // of each row, in the pairs that it is second of
  std::vector<std::size_t> as_second_;        // slots of those, in order of their first rows
  // Before the last listing, kept for their memory.
  std::vector<std::size_t> old_start_;
  LargeArray<Row> old_second_;
  LargeArray<SlipRow> old_slip_;
  LargeArray<MomentRow> old_rolling_;
  LargeArray<double> old_kept_;
};

}  // namespace vbond
