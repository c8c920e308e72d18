#pragma once
#include <cstddef>
#include <span>

#include "vbond/core/communicator.hpp"
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

/// What the processes that step the parts of a body need of each other in a step. In the form for a body that
/// one process steps whole, one_rank(), there is nobody to wait for.
class Exchange : public Communicator {
 public:
  /// Halo exchange: ghosts get what their particles have on the ranks that move them, by the end of
  /// end_halo(), with the same columns. In between, all may go on with what does not concern ghosts.
  virtual void begin_halo(const HaloColumns& columns) = 0;
  virtual void end_halo(const HaloColumns& columns) = 0;
  void halo(const HaloColumns& columns) { begin_halo(columns), end_halo(columns); }
  /// Reverse sum: particles get, in addition, the loads on their ghosts, which have none afterwards.
  virtual void reverse_sum(std::span<LoadRow> load) = 0;
};

/// The exchange of a body that one process steps whole.
Exchange& one_rank();

}  // namespace vbond
