#pragma once
#include <cstddef>
#include <memory>
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
  /// ghosts: particles of other ranks, and images of any, in the order of their messages; owners: the ranks
  /// that have their particles.
  Halo(const std::vector<ImageOf>& ghosts, const std::vector<int>& owners, const Communicator& ranks);

  /// Which of its own are ghosts somewhere.
  std::vector<ParticleId> sent() const;
  /// Where particles and ghosts stand.
  void take_rows(const Order& order);

  /// Ghosts get what their particles have, by the end of the second call.
  void begin_update(const HaloColumns& columns);
  void end_update(const HaloColumns& columns);
  /// Particles get the loads on their ghosts in addition, in the order of ranks: the bits do not depend on
  /// when messages come.
  void reverse_sum(std::span<LoadRow> load);
  /// Before another one takes its place: all messages have arrived.
  void finish();

 private:
  /// A rank that has ghosts of this one's particles, or particles that are ghosts here; or this one itself,
  /// of whose particles images are ghosts here.
  struct Neighbour {
    int rank;
    std::vector<ParticleId> sent;  // of this rank, ghosts there
    std::vector<ImageOf> ghosts;   // of that rank, ghosts here
    std::vector<std::size_t> sent_rows, ghost_rows;
  };

  int rank_ = 0;
  std::vector<Neighbour> neighbours_;  // in the order of ranks
  class Mail;
  std::shared_ptr<Mail> poses_, loads_;  // null: nobody has asked for any
};

}  // namespace vbond
