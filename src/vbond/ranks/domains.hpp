#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/order.hpp"

namespace vbond {

/// The ranks' domains in space, kept by LAMMPS: which particles a rank has, and the messages between
/// neighbouring domains. All functions are to be called by all ranks.
class Domains {
 public:
  /// Spreads particles at these positions, which all ranks know, over the ranks. work: what each costs.
  Domains(const Order& order, const PerParticle<Vec3d>& all, const PerParticle<double>& work, double reach);
  ~Domains();

  /// Their positions are now these: particles go to the rank in whose domain they are, of equal work if that
  /// can be, and the ghosts are found anew. Throws std::runtime_error if particles were lost.
  void redistribute(const PerParticle<Vec3d>& all, const PerParticle<double>& work, double reach);
  /// What this rank has; ghosts are the particles of other ranks within reach of its domain.
  Holding holding();
  /// Ghosts get what their particles have; rows: of own particles, then of ghosts, as holding() names them.
  void halo(const std::vector<std::uint32_t>& rows, const HaloColumns& columns);
  /// Particles get the loads of their ghosts on other ranks, in addition.
  void reverse_sum(const std::vector<std::uint32_t>& rows, std::span<LoadRow> load);

 private:
  struct Lammps;
  std::unique_ptr<Lammps> lammps_;
};

}  // namespace vbond
