#include "vbond/terms/strain/setup_strain.hpp"

namespace vbond {

StrainProgram resolve_strain(const StageResolver& resolver, const StrainSpec& s) {
  StrainProgram resolved{resolver.particles(s.group),
                         resolver.direction(s.direction, "strain", s.place),
                         {},
                         s.increment,
                         resolver.positive_time(s.every, "strain.every", s.place)};
  for (const ParticleId p : resolved.particles) resolved.centre += resolver.model.r_0[p];
  if (!resolved.particles.empty())
    resolved.centre = resolved.centre / static_cast<double>(resolved.particles.size());
  return resolved;
}

}  // namespace vbond
