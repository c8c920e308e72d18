#pragma once
#include <memory>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// The ranks' domains in space, kept by LAMMPS: which particles a rank has. All functions are to be called by
/// all ranks.
class Domains {
 public:
  /// Spreads particles at these positions, which all ranks know, over the ranks. work: what each costs.
  /// margin: a length that is small against domains, and large against rounding.
  Domains(const PerParticle<Vec3d>& all, const PerParticle<double>& work, double margin);
  ~Domains();

  /// Positions and work are now these, which a rank knows of its own particles: they go to the rank in whose
  /// domain they are, of equal work if that can be. Throws std::runtime_error if particles were lost.
  void redistribute(const PerParticle<Vec3d>& all, const PerParticle<double>& work);
  /// What this rank has, in increasing order.
  std::vector<ParticleId> own() const;

 private:
  struct Lammps;
  std::unique_ptr<Lammps> lammps_;
};

}  // namespace vbond
