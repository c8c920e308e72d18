#pragma once
#include <array>
#include <span>
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/partition.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// The images of particles in a periodic body that one process steps whole: its ghosts. Threads work on those
/// of the particles of their own blocks.
class CellImages final : public Exchange {
 public:
  explicit CellImages(const Order& order);

  void begin_halo(const HaloColumns& columns) override;
  void end_halo(const HaloColumns&) override {}
  void reverse_sum(std::span<LoadRow> load) override;
  /// Rows of the images of the particles of blocks [first, last).
  RowRange rows_of(std::size_t first_block, std::size_t last_block) const {
    return {begin_ + first_of(first_block), begin_ + first_of(last_block)};
  }
  /// The same as halo() and reverse_sum(), of the images of the particles of one block.
  void halo_of_block(std::size_t block, const HaloColumns& columns) const;
  void reverse_sum_of_block(std::size_t block, std::span<LoadRow> load) const;
  /// The sum over images of how many of each edge they are away times the force on them.  [force]
  std::array<Vec3d, 3> edges_times_force(std::span<const LoadRow> load) const;

 private:
  struct Ghost {
    std::size_t of;  // the row of the particle
    Image image;
  };
  std::size_t first_of(std::size_t block) const {
    return block < first_.size() ? first_[block] : ghosts_.size();
  }
  std::size_t begin_;
  std::vector<Ghost> ghosts_;       // from this row on, in the order of their particles' rows
  std::vector<std::size_t> first_;  // of each block of particles
};

/// A body that one process steps whole: all particles, and the images that its bonds join, or that may touch
/// or be bonded in this stage until a particle has gone farther than Share::farthest.
Share whole_body(const Model& model, const Stage& stage, const State& state);

}  // namespace vbond
