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
  /// ghosts: particles of other ranks, and images of any; owners: the ranks that have their particles.
  Halo(const std::vector<ImageOf>& ghosts, const std::vector<int>& owners, const Communicator& ranks);

  /// Which of its own are ghosts somewhere.
  std::vector<ParticleId> sent() const;
  /// Where particles and ghosts stand.
  void take_rows(const Order& order);

  /// Ghosts get what their particles have.
  void update_ghosts(const HaloColumns& columns);
  /// Particles get the loads on their ghosts in addition, in the order of ranks: the bits do not depend on
  /// when messages come.
  void reverse_sum(std::span<LoadRow> load);

 private:
  /// A rank that has ghosts of this one's particles, or particles that are ghosts here; or this one itself,
  /// of whose particles images are ghosts here.
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
