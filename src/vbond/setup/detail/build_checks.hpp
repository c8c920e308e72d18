#pragma once
#include "vbond/case/case.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/setup/build.hpp"

/// What may be wrong with a body that build() has made of a case; mistakes go to problems.
namespace vbond {

/// Two centres closer than 1e-9 of the body's size are one place: no direction could be told from them. some:
/// it is enough to look at pairs of which one of these is the lower number; null: at all.
void check_distinct(const Case& c, const Model& model, const State& state, const PerParticle<char>* some,
                    Problems& problems);

/// Contacts need radii.
void check_contact(const Case& c, const Model& model, Problems& problems);

/// Particles that are not bonded and lie half in one another would fly apart. Bonds that are made later may
/// be meant for them.
void check_overlaps(const Case& c, const Built& built, const BodyPart& body, Problems& problems);

/// With the step as far as it is known before a stage begins; told again then.
void check_durations(const Case& c, const Built& built, Problems& problems);

/// Groups, volumes and times of what is to be written.
void check_output(const Case& c, const Model& model, Problems& problems);

}  // namespace vbond
