#include <utility>

#include "vbond/setup/stage_resolver.hpp"
#include "vbond/terms/strain/strain_and_contacts.hpp"

namespace vbond {

/// About the group's centroid at the start.
void StrainTerm::resolve(const StageResolver& resolver, StagePart<StrainTerm>& to) {
  if (!resolver.spec.strain) return;
  const StrainSpec& s = *resolver.spec.strain;
  if (feels_sliding(resolver.model.contact))
    resolver.problems.add(s.place, "strain in a body whose contacts have friction or roll",
                          "it moves particles in jumps, along which no contact slides or rolls",
                          "leave contact.tangential and contact.rolling out, or move the ends by supports "
                          "with velocity");
  StrainProgram resolved{resolver.particles(s.group),
                         resolver.direction(s.direction, "strain", s.place),
                         {},
                         s.increment,
                         resolver.positive_time(s.every, "strain.every", s.place)};
  for (const ParticleId p : resolved.particles) resolved.centre += resolver.model.r_0[p];
  if (!resolved.particles.empty())
    resolved.centre = resolved.centre / static_cast<double>(resolved.particles.size());
  to.strain = std::move(resolved);
}

}  // namespace vbond
