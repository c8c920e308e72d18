#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "vbond/model/capsules.hpp"
#include "vbond/model/holds.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// The masses by which contacts of a stage damp: of what moves as one with a particle. docs/contacts.md.
class ContactMasses {
 public:
  ContactMasses() = default;
  ContactMasses(const Model& model, const std::vector<Support>& supports) : mass_(model.mass) {
    for (std::uint32_t k = 0; k < supports.size(); ++k) {
      if (!is_free_grip(supports[k])) continue;
      clump_.resize(model.particles());
      double mass = 0.0;
      for (const ParticleId p : supports[k].particles) mass += model.mass[p];
      for (const ParticleId p : supports[k].particles) mass_[p] = mass, clump_[p] = k + 1;
    }
    PerParticle<int> held(supports.empty() ? 0 : model.particles(), 0);  // translations
    for (const Hold& h : holds_of(supports))
      for (std::size_t k = 0; k < 3; ++k) held[h.particle] += h.held[k] ? 1 : 0;
    for (const ParticleId p : held.ids())
      if (held[p] == 3 && mass_.holds(p)) mass_[p] = std::numeric_limits<double>::infinity();
  }

  /// Its own; of a clump's member that of the whole clump; infinite if all three translations are held.
  double of(ParticleId p) const { return mass_[p]; }
  /// 1/m of a place of a capsule: sum of share^2/m, where an image has its share with its particle, and
  /// members of a clump have theirs together.
  double per_mass(const FibrePlace& place) const {
    if (are_one(place.i.particle, place.j.particle)) return 1.0 / of(place.i.particle);
    double per_m = 0.0;
    for_shares(place, [&](const ImageOf& p, double share) { per_m += share * share / of(p.particle); });
    return per_m;
  }

 private:
  bool are_one(ParticleId p, ParticleId q) const {
    return p == q || (!clump_.empty() && clump_[p] != 0 && clump_[p] == clump_[q]);
  }

  PerParticle<double> mass_;
  PerParticle<std::uint32_t> clump_;  // from 1; 0: of none. Empty: there are none
};

}  // namespace vbond
