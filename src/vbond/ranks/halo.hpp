#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/order.hpp"

namespace vbond {

/// The messages by which the ranks' ghosts get what their particles have, and give back the loads on them.
/// All functions are to be called by all ranks.
class Halo {
 public:
  Halo() = default;
  /// own: the particles of this rank; ghosts: particles of other ranks, and images of any. Together the ranks
  /// have all particles but those that are dropped.
  Halo(const std::vector<ParticleId>& own, const std::vector<ImageOf>& ghosts, std::size_t particles,
       const Exchange& ranks);

  /// Which of its own are ghosts somewhere.
  std::vector<ParticleId> sent() const;
  /// Where particles and ghosts stand.
  void take_rows(const Order& order);

  void halo(const HaloColumns& columns);
  /// Loads are added in the order of ranks: the bits do not depend on when messages come.
  void reverse_sum(std::span<LoadRow> load);

 private:
  /// What this rank and another one, or itself, are ghosts of each other.
  struct Neighbour {
    int rank;
    std::vector<ParticleId> sent;  // of this rank, ghosts there
    std::vector<ImageOf> ghosts;   // of that rank, ghosts here
    std::vector<std::size_t> sent_rows, ghost_rows;
    std::vector<double> out, in;  // the messages under way
  };
  void send_and_receive();

  int rank_ = 0;
  std::vector<Neighbour> neighbours_;  // in the order of ranks
};

}  // namespace vbond
