#pragma once
#include "vbond/physics/top.hpp"
#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {

/// The moments of inertia of particle i of a specimen, from the case or from its file, and their axes.
/// Moments that differ by rounding alone are made equal.
PrincipalInertia inertia_of(const SpecimenSpec& spec, const SpecimenPoints& points, std::size_t i,
                            double mass, double radius);

/// How often the case and the file give it: more than once is a mistake.
int times_inertia_is_given(const SpecimenSpec& spec, const SpecimenPoints& points);

}  // namespace vbond
