#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include "vbond/dynamics/rows.hpp"

namespace vbond {

/// Columns of rows whose ghosts get what their particles have. Empty columns are not sent.
struct HaloColumns {
  std::span<PoseRow> pose;
  std::span<MotionRow> motion;
  const CellEdges* cell = nullptr;  ///< of a periodic body

  /// Turns the copy of a particle in this row into its image n, which edges of the cell move on.
  void carry(std::size_t row, const Image& n) const {
    if (n.is_itself()) return;
    pose[row].r += to_image(*cell, n);
    if (!motion.empty()) motion[row].v += image_velocity(*cell, n);
  }
};

/// What the processes that step the parts of a body need of each other. All call these functions in the same
/// order, and all wait for each other in most of them. In the form for a body that one process steps whole,
/// one_rank(), there is nobody to wait for.
class Exchange {
 public:
  virtual ~Exchange() = default;

  /// Halo exchange: ghosts get what their particles have on the ranks that move them.
  virtual void halo(const HaloColumns& columns) = 0;
  /// Reverse sum: particles get, in addition, the loads on their ghosts, which have none afterwards.
  virtual void reverse_sum(std::span<LoadRow> load) = 0;

  /// Numbers become the sum, or the largest, of those of all processes.
  virtual void sum(std::span<double> numbers) const = 0;
  virtual void max(std::span<double> numbers) const = 0;
  /// How many processes there are, and which of them this is, from 0.
  virtual int ranks() const = 0;
  virtual int rank() const = 0;
  /// Whether this process does what one of them must do for all.
  bool leads() const { return rank() == 0; }
  /// What all processes have, in their order. room(n) is where n bytes of it go.
  using Room = std::function<std::byte*(std::size_t)>;
  virtual void gather_bytes(std::span<const std::byte> mine, const Room& room) const = 0;

  template <class T>
  std::vector<T> gather(const std::vector<T>& mine) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> all;
    gather_bytes(std::as_bytes(std::span(mine)), [&all](std::size_t bytes) {
      all.resize(bytes / sizeof(T));
      return std::as_writable_bytes(std::span(all)).data();
    });
    return all;
  }
  bool any(bool here) const {
    double number = here ? 1.0 : 0.0;
    max({&number, 1});
    return number != 0.0;
  }
  /// What the process that leads says, on all of them.
  bool leader_says(bool here) const { return any(leads() && here); }

  /// Does work that some processes may fail at alone, such as writing: if it throws std::runtime_error on
  /// some, the others throw IoError with what the first of these says. Any other exception ends the program.
  virtual void together(const std::function<void()>& work) const = 0;
};

/// The exchange of a body that one process steps whole: sums and gathers give what this process has.
Exchange& one_rank();

}  // namespace vbond
