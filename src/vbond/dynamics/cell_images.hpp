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

/// The images of particles in a periodic body that one process steps whole: its ghosts.
class CellImages final : public Exchange {
 public:
  explicit CellImages(const Order& order);

  void halo(const HaloColumns& columns) override;
  void reverse_sum(std::span<LoadRow> load) override;
  /// The sum over images of how many of each edge they are away times the force on them.  [force]
  std::array<Vec3d, 3> edges_times_force(std::span<const LoadRow> load) const;

  void sum(std::span<double>) const override {}
  void max(std::span<double>) const override {}
  int ranks() const override { return 1; }
  int rank() const override { return 0; }
  void gather_bytes(std::span<const std::byte> mine, const Room& room) const override {
    one_rank().gather_bytes(mine, room);
  }
  void together(const std::function<void()>& work) const override { work(); }

 private:
  struct Ghost {
    std::size_t row;  // of the particle
    Image image;
  };
  std::size_t own_;
  std::vector<Ghost> ghosts_;
};

/// A body that one process steps whole: all particles, and the images that its bonds join, or that may touch
/// or be bonded in this stage until a particle has gone farther than Share::farthest.
Share whole_body(const Model& model, const Stage& stage, const State& state);

}  // namespace vbond
