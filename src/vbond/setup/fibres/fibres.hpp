#pragma once
#include <cstdint>
#include <optional>

#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {

/// Chopped fibres without crossings, in the cell of the case or in a box of their own; chains, with their
/// bonds. Throws CaseError: for what does not fit, with the nearest that does.
SpecimenPoints make_fibres(const SpecimenSpec& spec, const Case& c);

/// How many particles they have, if that is known before they are made; else 0.
double count_points(const FibresSpecimen& s);

}  // namespace vbond
