#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "vbond/dynamics/rows.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/ranks/holding.hpp"

namespace vbond {

/// The ranks' domains in space, kept by LAMMPS: which particles and bonds a rank has, and the messages
/// between neighbouring domains. All functions are to be called by all ranks.
class Domains {
 public:
  /// Spreads the particles and bonds of a body, which all ranks hold, over the ranks.
  Domains(const Model& model, const State& state);
  ~Domains();

  /// Takes the present motion of own particles, sends those that have left the domain to their new rank, and
  /// finds the ghosts anew. longest: of all unbroken bonds, of all ranks. Throws std::runtime_error if
  /// particles were lost.
  void redistribute(const std::vector<Motion>& own, double longest);
  /// What this rank has now; bonds: all of the body, of which broken ones are left out.
  Holding holding(const PerBond<Bond>& bonds) const;
  /// Ghosts get the poses of their particles; rows: of own particles, then of ghosts.
  void send_poses(const std::vector<std::uint32_t>& rows, PoseRow* pose);
  /// Particles get the loads of their ghosts on other ranks, in addition.
  void gather_loads(const std::vector<std::uint32_t>& rows, LoadRow* load);

 private:
  struct Lammps;
  std::unique_ptr<Lammps> lammps_;
};

}  // namespace vbond
